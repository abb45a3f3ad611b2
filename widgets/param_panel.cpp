// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/param_panel.h"
#include "core/params/param_text.h"
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QEvent>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

namespace lightloom {

namespace {

QString text(std::string_view s) { return QString::fromUtf8(s.data(), static_cast<qsizetype>(s.size())); }

/// Scrolling a form must not change the number under the cursor: the wheel works on a field that has the focus.
class WheelNeedsFocus final : public QObject {
public:
    using QObject::QObject;
    bool eventFilter(QObject* watched, QEvent* event) override
    {
        const auto* widget = qobject_cast<QWidget*>(watched);
        if (event->type() != QEvent::Wheel || widget == nullptr || widget->hasFocus()) return false;
        event->ignore();
        return true;
    }
};

/// Shows what the value is, without zeros behind it, and groups no digits (they would be typed in again).
class NumberBox final : public QDoubleSpinBox {
public:
    using QDoubleSpinBox::QDoubleSpinBox;
    [[nodiscard]] QString textFromValue(double value) const override { return QString::number(value, 'g', 12); }

protected:
    /// Ctrl+Z takes typing back while there is some; after that it belongs to the window.
    bool event(QEvent* event) override
    {
        if (event->type() == QEvent::ShortcutOverride) {
            const auto* key = static_cast<QKeyEvent*>(event);
            if ((key->matches(QKeySequence::Undo) && !lineEdit()->isUndoAvailable()) ||
                (key->matches(QKeySequence::Redo) && !lineEdit()->isRedoAvailable())) {
                event->ignore();
                return true;
            }
        }
        return QDoubleSpinBox::event(event);
    }
};

QString groupTitle(Stage stage, Method method)
{
    const bool isGrid = method == Method::irradianceGrid, isVoxels = method == Method::voxelLightcuts;
    switch (stage) {
    case Stage::shoot:
        return isVoxels ? QObject::tr("Draws (light anew)") : QObject::tr("Photons (shoots again)");
    case Stage::build:
        if (isVoxels) return QObject::tr("Voxels (all anew)");
        return isGrid ? QObject::tr("Grid (shoots again)") : QObject::tr("Octree (keeps photons)");
    case Stage::fit:
        if (isVoxels) return QObject::tr("Light (keeps voxels)");
        return isGrid ? QObject::tr("Sums (shoots again)") : QObject::tr("Gather (keeps octree)");
    case Stage::show:
        break;
    }
    return QObject::tr("Display (no new bake)");
}

QString rangeText(const ParamSpec& spec)
{
    if (spec.isChoice()) return {};
    const QString unit = spec.unit.empty() ? QString() : " " + text(spec.unit);
    return QObject::tr("\nRange %1 to %2%3. On the command line: --set %4=...")
        .arg(spec.least)
        .arg(spec.most)
        .arg(unit, text(spec.key));
}

} // namespace

ParamPanel::ParamPanel(Method method, QWidget* parent) : QWidget(parent), method_(method), preset_(new QComboBox)
{
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(6, 6, 6, 6);
    auto* presetForm = new QFormLayout;
    preset_->addItem(tr("Custom"));
    for (const std::string_view name : kPresetNames) preset_->addItem(text(name));
    preset_->setAccessibleName(tr("Preset"));
    preset_->setToolTip(tr("Draft: fast and rough. Preview: the method's defaults. Final: slow and fine."));
    presetForm->addRow(tr("Preset"), preset_);
    column->addLayout(presetForm);
    connect(preset_, &QComboBox::activated, this, [this](int index) {
        if (index == 0) return;
        const Result<BakeParams> chosen = preset(preset_->itemText(index).toStdString(), method_);
        if (!chosen) return;
        setParams(*chosen);
        Q_EMIT edited(params_);
    });
    column->addStretch(1);
    addRows();
}

void ParamPanel::setMethod(Method method)
{
    if (method == method_) return;
    params_ = paramsFor(params_, method_, method);
    method_ = method;
    rows_.clear();
    delete form_;
    addRows();
}

void ParamPanel::addRows()
{
    form_ = new QWidget;
    auto* column = new QVBoxLayout(form_);
    column->setContentsMargins(0, 0, 0, 0);
    for (const Stage stage : {Stage::shoot, Stage::build, Stage::fit, Stage::show}) {
        auto* title = new QLabel(QStringLiteral("<b>%1</b>").arg(groupTitle(stage, method_)));
        title->setContentsMargins(0, 8, 0, 0);
        auto* form = new QFormLayout;
        form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
        form->setRowWrapPolicy(QFormLayout::WrapLongRows); // on small screens fields go below their labels
        const std::size_t before = rows_.size();
        for (const ParamSpec& spec : kParams) {
            const bool counts = (spec.methods & (1u << static_cast<unsigned>(method_))) != 0;
            // an octree's are modes of the picture
            const bool isMode = method_ == Method::lightOctree && spec.redo == Stage::show && spec.isChoice();
            if (counts && spec.redo == stage && !isMode) addRow(spec, *form);
        }
        if (rows_.size() == before) {
            delete title;
            delete form;
            continue;
        }
        column->addWidget(title);
        column->addLayout(form);
    }
    auto* all = qobject_cast<QVBoxLayout*>(layout());
    all->insertWidget(all->count() - 1, form_); // before the space that is left
    showValues();
}

void ParamPanel::addRow(const ParamSpec& spec, QFormLayout& form)
{
    Row row{&spec, makeEditor(spec), new QLabel(text(spec.label)), new QToolButton, &form};
    const QString help = text(spec.help) + rangeText(spec);
    row.editor->setObjectName(text(spec.key));
    row.editor->setToolTip(help);
    row.editor->setAccessibleName(text(spec.label));
    row.editor->setAccessibleDescription(text(spec.help));
    row.editor->setMinimumWidth(90);
    row.editor->setFocusPolicy(Qt::StrongFocus);
    row.editor->installEventFilter(new WheelNeedsFocus(row.editor));
    row.label->setToolTip(help);
    row.label->setBuddy(row.editor);
    row.reset->setObjectName(text(spec.key) + QStringLiteral(".reset"));
    row.reset->setText(QStringLiteral("↺"));
    row.reset->setAutoRaise(true);
    row.reset->setToolTip(tr("Back to %1").arg(QString::fromStdString(paramText(defaultParams(method_), spec))));
    row.reset->setAccessibleName(tr("Reset %1").arg(text(spec.label)));
    QSizePolicy keep = row.reset->sizePolicy();
    keep.setRetainSizeWhenHidden(true); // rows must not jump when a value changes
    row.reset->setSizePolicy(keep);
    connect(row.reset, &QToolButton::clicked, this,
            [this, &spec] { set(spec, paramValue(defaultParams(method_), spec)); });
    auto* field = new QHBoxLayout;
    field->addWidget(row.editor, 1);
    field->addWidget(row.reset);
    form.addRow(row.label, field);
    rows_.push_back(row);
}

QWidget* ParamPanel::makeEditor(const ParamSpec& spec)
{
    if (spec.isChoice()) {
        auto* box = new QComboBox;
        for (const std::string_view choice : spec.choices) box->addItem(text(choice));
        connect(box, &QComboBox::activated, this, [this, &spec](int index) { set(spec, index); });
        return box;
    }
    auto* box = new NumberBox;
    const bool isReal = std::holds_alternative<float BakeParams::*>(spec.field);
    box->setDecimals(isReal ? 6 : 0);
    box->setRange(spec.least, spec.most);
    box->setSingleStep(spec.step);
    box->setKeyboardTracking(false); // a half-typed number starts no bake
    if (!spec.unit.empty()) box->setSuffix(" " + text(spec.unit));
    connect(box, &QDoubleSpinBox::valueChanged, this, [this, &spec](double value) { set(spec, value); });
    return box;
}

void ParamPanel::set(const ParamSpec& spec, double value)
{
    if (filling_) return;
    const Result<BakeParams> next = with(params_, spec.key, value);
    if (next && !(*next == params_)) {
        params_ = *next;
        showValues();
        Q_EMIT edited(params_);
    } else {
        showValues();
    }
}

void ParamPanel::setParams(const BakeParams& params)
{
    params_ = params;
    showValues();
}

void ParamPanel::showValues()
{
    filling_ = true;
    const BakeParams defaults = defaultParams(method_);
    for (const Row& row : rows_) {
        const double value = paramValue(params_, *row.spec);
        if (auto* number = qobject_cast<QDoubleSpinBox*>(row.editor)) number->setValue(value);
        if (auto* choice = qobject_cast<QComboBox*>(row.editor)) choice->setCurrentIndex(static_cast<int>(value));
        const bool isChanged = value != paramValue(defaults, *row.spec);
        QFont font = row.label->font();
        font.setBold(isChanged);
        row.label->setFont(font);
        row.editor->setFont(font);
        row.form->setRowVisible(row.label, isOfUse(params_, *row.spec)); // shows all of a row
        row.reset->setVisible(isChanged);
    }
    int index = 0;
    for (std::size_t i = 0; i < kPresetNames.size(); ++i) {
        const Result<BakeParams> named = preset(kPresetNames[i], method_);
        if (named && *named == params_) index = static_cast<int>(i) + 1;
    }
    preset_->setCurrentIndex(index);
    filling_ = false;
}

} // namespace lightloom
