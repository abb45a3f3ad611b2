// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/sweep_panel.h"
#include "core/base/atomic_file.h"
#include "core/compare/sweep_plot.h"
#include "core/compare/sweep_table.h"
#include "widgets/panel_parts.h"
#include "widgets/trade_plot.h"
#include <QComboBox>
#include <QCoreApplication>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QFormLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QPointer>
#include <QProgressBar>
#include <QPushButton>
#include <QSpinBox>
#include <QTableWidget>
#include <QThreadPool>
#include <algorithm>

namespace lightloom {

namespace {

constexpr int kTellMs = 250; ///< between changes of the progress: each composes the window anew

QString text(std::string_view s) { return QString::fromUtf8(s.data(), static_cast<qsizetype>(s.size())); }

/// Parameters that change a bake of the method, and not only how it is shown.
bool canVary(const ParamSpec& spec, Method method)
{
    return (spec.methods & (1u << static_cast<unsigned>(method))) != 0 && spec.redo != Stage::show;
}

/// What its accuracy hangs on first.
const char* firstParam(Method method)
{
    if (method == Method::voxelLightcuts) return "voxel.size";
    return method == Method::irradianceGrid ? "grid.size" : "gather.count";
}

QString nameOf(Method method)
{
    if (method == Method::voxelLightcuts) return QObject::tr("voxels");
    return method == Method::irradianceGrid ? QObject::tr("the irradiance grid") : QObject::tr("the light octree");
}

/// A few values around the method's default that the parameter can take.
QString suggestion(const ParamSpec& spec, Method method)
{
    if (spec.isChoice()) {
        QStringList all;
        for (const std::string_view choice : spec.choices) all += text(choice);
        return all.join(',');
    }
    const double middle = paramValue(defaultParams(method), spec);
    const bool isWhole = !std::holds_alternative<float BakeParams::*>(spec.field);
    std::vector<double> values;
    if (middle == 0.0 || spec.most <= 20.0) {
        for (const double steps : {-1.0, 0.0, 1.0}) values.push_back(middle + steps * spec.step);
    } else {
        for (const double factor : {0.5, 1.0, 2.0})
            values.push_back(isWhole ? std::round(middle * factor) : middle * factor);
    }
    QStringList all;
    for (const double v : values) {
        if (v >= spec.least && v <= spec.most) all += QString::number(v, 'g', 12);
    }
    return all.join(',');
}

QString percent(double fraction) { return QString::number(100.0 * fraction, 'f', 1) + QStringLiteral(" %"); }

QString bakes(std::size_t count) { return count == 1 ? QObject::tr("1 bake") : QObject::tr("%1 bakes").arg(count); }

} // namespace

SweepPanel::SweepPanel(QWidget* parent)
    : QWidget(parent), points_(new QSpinBox), noise_(new QDoubleSpinBox), run_(new QPushButton(tr("Measure"))),
      cancel_(new QPushButton(tr("Stop"))), saveTable_(new QPushButton(tr("Save table..."))),
      savePlot_(new QPushButton(tr("Save plot..."))), bar_(thinProgress(tr("Progress of measuring"))),
      state_(textLines()), plot_(new TradePlot), table_(new QTableWidget)
{
    edits_ = {makeAxis(0), makeAxis(1)};
    fillAxes();
    build();
    connect(run_, &QPushButton::clicked, this, &SweepPanel::run);
    connect(cancel_, &QPushButton::clicked, this, [this] { worker_.cancel(); });
    connect(saveTable_, &QPushButton::clicked, this, [this] { save(false); });
    connect(savePlot_, &QPushButton::clicked, this, [this] { save(true); });
    connect(plot_, &TradePlot::clicked, this, &SweepPanel::choose);
    // Return in the table, a double click, a click: whoever touches a row wants it
    connect(table_, &QTableWidget::cellActivated, this, [this](int row) { choose(static_cast<std::size_t>(row)); });
    connect(table_, &QTableWidget::cellClicked, this, [this](int row) { choose(static_cast<std::size_t>(row)); });
    connect(&worker_, &SweepWorker::progressed, this, &SweepPanel::take, Qt::QueuedConnection);
    connect(&worker_, &SweepWorker::rowDone, this, &SweepPanel::takeRow, Qt::QueuedConnection);
    connect(&worker_, &SweepWorker::finished, this, &SweepPanel::end, Qt::QueuedConnection);
    showRows();
    tellPlan();
}

SweepPanel::AxisEdit SweepPanel::makeAxis(int number)
{
    AxisEdit edit{new QComboBox, new QLineEdit};
    edit.param->setObjectName(QStringLiteral("sweep.param%1").arg(number));
    edit.param->setAccessibleName(number == 0 ? tr("Parameter to vary") : tr("Second parameter to vary"));
    edit.param->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    edit.values->setObjectName(QStringLiteral("sweep.values%1").arg(number));
    edit.values->setAccessibleName(tr("Its values"));
    edit.values->setToolTip(tr("Values: 50,100,200 or a range 4..7:1 or a geometric one 100000..800000*2"));
    connect(edit.param, &QComboBox::currentIndexChanged, this, [this, edit] {
        suggest(edit);
        tellPlan();
    });
    connect(edit.values, &QLineEdit::textEdited, this, &SweepPanel::tellPlan);
    return edit;
}

void SweepPanel::suggest(const AxisEdit& edit)
{
    const ParamSpec* spec = findParam(edit.param->currentData().toString().toStdString());
    edit.values->setEnabled(spec != nullptr);
    edit.values->setText(spec != nullptr ? suggestion(*spec, method_) : QString());
}

void SweepPanel::fillAxes()
{
    for (std::size_t i = 0; i < edits_.size(); ++i) {
        const AxisEdit& edit = edits_[i];
        const std::optional<Measured::Choice>& choice = shown().choices[i];
        const QSignalBlocker quiet(edit.param);
        edit.param->clear();
        if (i > 0) edit.param->addItem(tr("nothing else"), QString());
        for (const ParamSpec& spec : kParams) {
            if (canVary(spec, method_)) edit.param->addItem(text(spec.label), text(spec.key));
        }
        const QString first = i == 0 ? QString::fromLatin1(firstParam(method_)) : QString();
        edit.param->setCurrentIndex(std::max(0, edit.param->findData(choice ? choice->param : first)));
        suggest(edit);
        if (choice) edit.values->setText(choice->values);
    }
}

void SweepPanel::build()
{
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(6, 6, 6, 6);
    auto* form = new QFormLayout;
    form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    form->setRowWrapPolicy(QFormLayout::WrapLongRows);
    for (const AxisEdit& edit : edits_) {
        form->addRow(&edit == &edits_[0] ? tr("Vary") : tr("and"), edit.param);
        form->addRow(tr("Values"), edit.values);
    }
    points_->setRange(50, 100'000);
    points_->setValue(static_cast<int>(kJudgePoints));
    points_->setObjectName(QStringLiteral("sweep.points"));
    points_->setToolTip(tr("Points on the surfaces at which bakes are held against the reference"));
    noise_->setRange(0.1, 20.0);
    noise_->setValue(2.0);
    noise_->setSuffix(tr(" %"));
    noise_->setObjectName(QStringLiteral("sweep.noise"));
    noise_->setToolTip(tr("Noise of the reference at each point, of the mean; half as much takes four times as long"));
    form->addRow(tr("Points"), points_);
    form->addRow(tr("Reference noise"), noise_);
    column->addLayout(form);
    auto* buttons = new QGridLayout;
    run_->setObjectName(QStringLiteral("sweep.run"));
    cancel_->setObjectName(QStringLiteral("sweep.cancel"));
    buttons->addWidget(run_, 0, 0);
    buttons->addWidget(cancel_, 0, 1);
    buttons->addWidget(saveTable_, 1, 0);
    buttons->addWidget(savePlot_, 1, 1);
    table_->setAccessibleName(tr("Bakes, their cost and error"));
    table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    table_->setSelectionMode(QAbstractItemView::SingleSelection);
    table_->verticalHeader()->hide();
    table_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
    table_->horizontalHeader()->setHighlightSections(false);
    table_->setMinimumHeight(120);
    table_->setToolTip(tr("Click a row, or press Return on it, to bake with its parameters. *: beaten by no other"));
    column->addLayout(buttons);
    column->addWidget(bar_);
    column->addWidget(state_);
    column->addWidget(plot_, 3);
    column->addWidget(table_, 2);
}

void SweepPanel::setScene(std::shared_ptr<const Scene> scene, const QString& file)
{
    worker_.cancel();
    serial_ = 0; // what still comes is of the old one
    isRunning_ = false;
    scene_ = std::move(scene);
    file_ = file;
    for (auto& [method, measured] : measured_) {
        measured.rows.clear();
        measured.axes.clear();
    }
    showRows();
    tellPlan();
}

void SweepPanel::setMethod(Method method)
{
    if (method == method_) return;
    for (std::size_t i = 0; i < edits_.size(); ++i)
        measured_[method_].choices[i] = {edits_[i].param->currentData().toString(), edits_[i].values->text()};
    method_ = method;
    measured_.try_emplace(method);
    fillAxes();
    showRows();
    tellPlan();
}

void SweepPanel::setBase(const BakeParams& params)
{
    base_ = params;
    if (!isRunning_ && rows().empty()) tellPlan();
}

void SweepPanel::holdFor(const QString& reason)
{
    if (reason == held_) return;
    held_ = reason;
    worker_.setHeld(!held_.isEmpty());
    if (isRunning_ && !held_.isEmpty()) state_->setText(held_);
}

Result<SweepPlan> SweepPanel::plan() const
{
    SweepPlan plan{scene_, method_, Isa::automatic, base_, {}, QCoreApplication::applicationVersion().toStdString()};
    for (const AxisEdit& edit : edits_) {
        const QString key = edit.param->currentData().toString();
        if (key.isEmpty()) continue;
        Result<SweepAxis> axis = parseSweepAxis((key + '=' + edit.values->text().remove(' ')).toStdString(), method_);
        if (!axis) return axis.error();
        plan.axes.push_back(*std::move(axis));
    }
    const Result<std::vector<BakeParams>> rows = sweepRows(plan.base, plan.axes);
    if (!rows) return rows.error();
    return plan;
}

void SweepPanel::tellPlan()
{
    const Result<SweepPlan> planned = plan();
    run_->setEnabled(planned && scene_ && !isRunning_);
    cancel_->setEnabled(isRunning_);
    if (isRunning_) {
        if (running_ != method_) state_->setText(tr("Measures %1").arg(nameOf(running_)));
        return;
    }
    setFraction(*bar_, 0.0);
    if (!planned) {
        state_->setText(QString::fromStdString(planned.error().message));
    } else {
        const Result<std::vector<BakeParams>> rows = sweepRows(planned->base, planned->axes);
        state_->setText(tr("%1, each of two seeds, lamps at 100 %").arg(bakes(rows->size())));
    }
}

void SweepPanel::run()
{
    const Result<SweepPlan> planned = plan();
    if (!planned || !scene_) return;
    running_ = method_;
    Measured& measured = measured_[running_];
    measured.rows.clear();
    measured.axes = planned->axes;
    measured.wanted.clear();
    const Result<std::vector<BakeParams>> rows = sweepRows(planned->base, measured.axes); // fine: `plan` has tried it
    for (const BakeParams& row : *rows) measured.wanted.push_back(axesText(measured.axes, row));
    showRows();
    isRunning_ = true;
    told_.invalidate();
    serial_ = worker_.start(
        {*planned, file_, static_cast<std::uint64_t>(points_->value()), static_cast<float>(noise_->value() / 100.0)});
    state_->setText(held_.isEmpty() ? tr("Preparing") : held_);
    tellPlan();
}

void SweepPanel::take(const SweepProgress& progress)
{
    if (progress.serial != serial_ || !isRunning_ || !held_.isEmpty()) return;
    if (told_.isValid() && told_.elapsed() < kTellMs) return;
    told_.start();
    setFraction(*bar_, progress.fraction);
    if (running_ != method_) return; // the window is about another one
    QString line = progress.isJudge ? tr("Tracing the reference, %1 %").arg(100.0 * progress.fraction, 0, 'f', 0)
                                    : tr("%1 of %2 bakes, %3 %")
                                          .arg(rows().size())
                                          .arg(shown().wanted.size())
                                          .arg(100.0 * progress.fraction, 0, 'f', 0);
    if (progress.remainingSeconds >= 0.0) line += tr(", about %1 s left").arg(progress.remainingSeconds, 0, 'f', 0);
    state_->setText(line);
}

void SweepPanel::takeRow(quint64 serial, const SweepRow& row)
{
    if (serial != serial_) return;
    Measured& measured = measured_[running_];
    measured.rows.push_back(row);
    const auto place = [&](const SweepRow& r) {
        return std::ranges::find(measured.wanted, axesText(measured.axes, r.params)) - measured.wanted.begin();
    };
    std::ranges::stable_sort(measured.rows, {}, place);
    if (running_ == method_) showRows();
}

void SweepPanel::end(quint64 serial, const QString& error, bool isCancelled)
{
    if (serial != serial_) return;
    isRunning_ = false;
    tellPlan();
    const Measured& measured = measured_[running_];
    if (!error.isEmpty()) {
        state_->setText(error);
    } else if (isCancelled) {
        state_->setText(tr("Stopped after %1 of %2 bakes").arg(measured.rows.size()).arg(measured.wanted.size()));
    } else {
        setFraction(*bar_, 1.0);
        state_->setText(
            tr("%1 measured; noise of the reference %2 %")
                .arg(bakes(measured.rows.size()))
                .arg(measured.rows.empty() ? 0.0 : 100.0 * measured.rows.front().referenceNoise, 0, 'f', 2));
    }
    Q_EMIT ended();
}

void SweepPanel::choose(std::size_t row)
{
    if (row >= rows().size()) return;
    plot_->choose(row);
    table_->selectRow(static_cast<int>(row));
    Q_EMIT chosen(rows()[row].params);
}

void SweepPanel::showRows()
{
    saveTable_->setEnabled(!rows().empty());
    savePlot_->setEnabled(!rows().empty());
    plot_->choose({});
    LogPlot plot = sweepPlot(rows(), method_, sceneName().toStdString());
    plot.xLabel = tr("CPU-seconds").toStdString();
    plot.yLabel = tr("relRMSE of the indirect light, %").toStdString();
    plot_->show(std::move(plot));
    QStringList titles{QStringLiteral("*")};
    for (const SweepAxis& axis : shown().axes) titles += text(axis.param->key);
    titles += {tr("CPU-s"), tr("relRMSE"), tr("noise"), tr("systematic")};
    table_->clear();
    table_->setColumnCount(static_cast<int>(titles.size()));
    table_->setRowCount(static_cast<int>(rows().size()));
    table_->setHorizontalHeaderLabels(titles);
    const std::vector<bool> isFront = sweepFront(rows());
    for (std::size_t r = 0; r < rows().size(); ++r) {
        const SweepRow& row = rows()[r];
        QStringList cells{isFront[r] ? QStringLiteral("*") : QString()};
        for (const SweepAxis& axis : shown().axes) cells += QString::fromStdString(paramText(row.params, *axis.param));
        cells += {QString::number(row.cpuSeconds(), 'f', 2), percent(row.error.relRmse), percent(row.split.noise),
                  percent(row.split.systematic)};
        for (int c = 0; c < cells.size(); ++c) {
            auto* item = new QTableWidgetItem(cells[c]);
            item->setTextAlignment(Qt::AlignRight | Qt::AlignVCenter);
            table_->setItem(static_cast<int>(r), c, item);
        }
    }
    table_->resizeColumnsToContents();
}

QString SweepPanel::sceneName() const { return QFileInfo(file_).completeBaseName(); }

void SweepPanel::save(bool asPlot)
{
    const QString name =
        QFileInfo(file_).absolutePath() + '/' + sceneName() + (asPlot ? tr("_sweep.svg") : tr("_sweep.csv"));
    auto* dialog = new QFileDialog(this, asPlot ? tr("Save the plot") : tr("Save the table"), name,
                                   asPlot ? tr("SVG pictures (*.svg)") : tr("Tables (*.csv)"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setAcceptMode(QFileDialog::AcceptSave);
    dialog->setDefaultSuffix(asPlot ? QStringLiteral("svg") : QStringLiteral("csv"));
    connect(dialog, &QFileDialog::fileSelected, this, [this, asPlot](const QString& file) { write(file, asPlot); });
    dialog->open();
}

void SweepPanel::write(const QString& file, bool asPlot)
{
    const std::optional<std::size_t> wanted =
        rows().size() < shown().wanted.size() ? std::optional(shown().wanted.size()) : std::nullopt;
    const std::string content =
        asPlot ? svgPlot(sweepPlot(rows(), method_, sceneName().toStdString())) : sweepText(rows(), method_, wanted);
    // the disk may take its time, and the panel may be gone when it has
    QThreadPool::globalInstance()->start([panel = QPointer(this), file, content] {
        const Result<Done> written = writeFile(file.toStdString(), content);
        const QString line = written ? tr("%1 is written").arg(QFileInfo(file).fileName())
                                     : QString::fromStdString(written.error().message);
        const auto tell = [panel, line] {
            if (panel) panel->state_->setText(line);
        };
        QMetaObject::invokeMethod(qApp, tell, Qt::QueuedConnection);
    });
}

QString SweepPanel::stateText() const { return state_->text(); }

} // namespace lightloom
