// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/scene_dock.h"
#include "widgets/lamp_editor.h"
#include "widgets/panel_parts.h"
#include <QCheckBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QLocale>
#include <QScrollArea>
#include <QSlider>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

namespace lightloom {

namespace {
constexpr int kMostPercent = 200, kMostRows = 6;

/// Gives way where its text is longer than the dock is wide.
class ElidingCheckBox final : public QCheckBox {
public:
    explicit ElidingCheckBox(const QString& full) : QCheckBox(full), full_(full)
    {
        setAccessibleName(full);
        setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
    }

protected:
    void resizeEvent(QResizeEvent* event) override
    {
        const int room = width() - (QCheckBox::sizeHint().width() - fontMetrics().horizontalAdvance(text()));
        setText(fontMetrics().elidedText(full_, Qt::ElideRight, room));
        QCheckBox::resizeEvent(event);
    }

private:
    QString full_;
};

QLabel* title(const QString& text)
{
    auto* label = new QLabel(QStringLiteral("<b>%1</b>").arg(text));
    label->setContentsMargins(0, 6, 0, 0);
    return label;
}
} // namespace

SceneDock::SceneDock(QWidget* parent)
    : QWidget(parent), cameras_(new QListWidget), column_(new QVBoxLayout(this)), about_(new QLabel),
      editor_(new LampEditor), editorArea_(new QScrollArea)
{
    cameras_->setAccessibleName(tr("Cameras"));
    cameras_->setToolTip(tr("Click to look through a camera of the scene."));
    cameras_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff); // long names end in an ellipsis
    about_->setWordWrap(true);
    column_->setContentsMargins(6, 6, 6, 6);
    column_->addWidget(about_);
    column_->addWidget(title(tr("Cameras")));
    column_->addWidget(cameras_);
    column_->addWidget(title(tr("Lamps")));
    editorArea_->setWidgetResizable(true);
    editorArea_->setFrameShape(QFrame::NoFrame);
    editorArea_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    editorArea_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Maximum);
    editorArea_->setWidget(editor_);
    editorArea_->hide();
    column_->addWidget(editorArea_);
    setScene(nullptr);
    const auto choose = [this](QListWidgetItem* item) { Q_EMIT cameraChosen(cameras_->row(item)); };
    connect(cameras_, &QListWidget::itemClicked, this, choose);
    connect(cameras_, &QListWidget::itemActivated, this, choose);
}

void SceneDock::setScene(const std::shared_ptr<const Scene>& scene)
{
    cameras_->clear();
    lamps_.clear();
    delete lampBox_;
    auto* area = new QScrollArea;
    area->setWidgetResizable(true);
    area->setFrameShape(QFrame::NoFrame);
    area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    area->setMinimumWidth(fontMetrics().horizontalAdvance(QStringLiteral("Pendant lamp 200 % ...")));
    area->setMinimumHeight(3 * fontMetrics().height()); // a lamp's row; small screens need the rest
    auto* inside = new QWidget;
    auto* rows = new QVBoxLayout(inside);
    rows->setContentsMargins(0, 0, 6, 0);
    if (scene) {
        std::size_t triangles = 0;
        for (const Instance& i : scene->instances) {
            triangles += scene->meshes[static_cast<std::size_t>(i.mesh)].triangles.size();
        }
        about_->setText(tr("<b>%1</b><br>%2 triangles in %3 objects")
                            .arg(breakable(QString::fromStdString(scene->name)).toHtmlEscaped(),
                                 QLocale().toString(static_cast<qulonglong>(triangles)))
                            .arg(scene->instances.size()));
        for (const Camera& camera : scene->cameras) cameras_->addItem(QString::fromStdString(camera.name));
        for (int i = 0; i < cameras_->count(); ++i) cameras_->item(i)->setToolTip(cameras_->item(i)->text());
        for (const LightGroup& group : scene->groups) addLamp(group, *rows);
        if (scene->groups.empty()) rows->addWidget(new QLabel(tr("This scene has no lamps.")));
    } else {
        about_->setText(tr("No scene is open."));
    }
    const int shown = std::clamp(cameras_->count(), 1, kMostRows);
    cameras_->setFixedHeight(shown * std::max(cameras_->sizeHintForRow(0), fontMetrics().height()) + 6);
    rows->addStretch(1);
    area->setWidget(inside);
    lampBox_ = area;
    column_->insertWidget(column_->indexOf(editorArea_), area, 1);
}

void SceneDock::showLamp(const std::shared_ptr<const Scene>& scene, int group, int light)
{
    for (std::size_t i = 0; i < lamps_.size(); ++i) lamps_[i].edit->setChecked(static_cast<int>(i) == group);
    editor_->setLamp(scene, group, light);
    editorArea_->setVisible(scene && group >= 0);
    shareHeight(); // rows came or went
    if (!scene || group < 0) return;
    const QWidget* row = lamps_[static_cast<std::size_t>(group)].edit; // in sight, once there is a layout
    QTimer::singleShot(0, row, [this, row] { lampBox_->ensureWidgetVisible(const_cast<QWidget*>(row), 0, 40); });
}

/// The form of a lamp is worth more than the rest of a long list of lamps.
void SceneDock::shareHeight()
{
    const int wanted = editor_->sizeHint().height(), least = 2 * fontMetrics().height();
    editorArea_->setMinimumHeight(std::max(least, std::min(wanted, height() / 2)));
    editorArea_->updateGeometry();
}

void SceneDock::resizeEvent(QResizeEvent* event)
{
    QWidget::resizeEvent(event);
    shareHeight();
}

void SceneDock::addLamp(const LightGroup& group, QVBoxLayout& column)
{
    const QString name = QString::fromStdString(group.label.empty() ? group.id : group.label);
    Lamp lamp{new ElidingCheckBox(name), new QSlider(Qt::Horizontal), new QLabel, new QToolButton};
    lamp.on->setChecked(true);
    lamp.on->setObjectName("lamp." + QString::fromStdString(group.id));
    lamp.on->setToolTip(tr("%1: on or off (light group %2)").arg(name, QString::fromStdString(group.id)));
    lamp.gain->setObjectName("gain." + QString::fromStdString(group.id));
    lamp.gain->setRange(0, kMostPercent);
    lamp.gain->setPageStep(10);
    lamp.gain->setMinimumWidth(50);
    lamp.gain->setValue(100);
    lamp.gain->setAccessibleName(tr("Brightness of %1 in percent").arg(name));
    lamp.gain->setToolTip(tr("Dims without a new bake. 100 % is the lamp as the file has it."));
    lamp.value->setMinimumWidth(lamp.value->fontMetrics().horizontalAdvance(QStringLiteral("200 % ")));
    lamp.value->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    lamp.value->setText(QStringLiteral("100 %"));
    auto* row = new QHBoxLayout;
    row->setContentsMargins(18, 0, 0, 4);
    row->addWidget(lamp.gain, 1);
    row->addWidget(lamp.value);
    lamp.edit->setText(tr("Edit"));
    lamp.edit->setCheckable(true);
    lamp.edit->setAutoRaise(true);
    lamp.edit->setObjectName("edit." + QString::fromStdString(group.id));
    lamp.edit->setAccessibleName(tr("Edit %1").arg(name));
    lamp.edit->setToolTip(tr("Place, direction, intensity and colour of %1; handles in the picture").arg(name));
    auto* head = new QHBoxLayout;
    head->addWidget(lamp.on, 1);
    head->addWidget(lamp.edit);
    column.addLayout(head);
    column.addLayout(row);
    QLabel* value = lamp.value;
    QSlider* gain = lamp.gain;
    const int index = static_cast<int>(lamps_.size());
    connect(gain, &QSlider::valueChanged, this, [this, value, index](int percent) {
        value->setText(QStringLiteral("%1 %").arg(percent));
        if (!filling_) Q_EMIT lampEdited(index, true);
    });
    connect(lamp.on, &QCheckBox::toggled, this, [this, gain, index](bool on) {
        gain->setEnabled(on);
        if (!filling_) Q_EMIT lampEdited(index, false);
    });
    connect(lamp.edit, &QToolButton::clicked, this,
            [this, index](bool isChosen) { Q_EMIT lampChosen(isChosen ? index : -1); });
    lamps_.push_back(lamp);
}

std::vector<LampSetting> SceneDock::lampSettings() const
{
    std::vector<LampSetting> settings;
    for (const Lamp& lamp : lamps_) settings.push_back({lamp.on->isChecked(), lamp.gain->value()});
    return settings;
}

void SceneDock::setLampSettings(const std::vector<LampSetting>& settings)
{
    filling_ = true;
    for (std::size_t i = 0; i < std::min(lamps_.size(), settings.size()); ++i) {
        lamps_[i].gain->setValue(settings[i].percent);
        lamps_[i].on->setChecked(settings[i].isOn);
    }
    filling_ = false;
}

QString SceneDock::lampName(int lamp) const { return lamps_[static_cast<std::size_t>(lamp)].on->accessibleName(); }

Mix SceneDock::mix() const
{
    Mix mix;
    for (const Lamp& lamp : lamps_) {
        mix.emplace_back(lamp.on->isChecked() ? static_cast<float>(lamp.gain->value()) / 100.0f : 0.0f);
    }
    return mix;
}

} // namespace lightloom
