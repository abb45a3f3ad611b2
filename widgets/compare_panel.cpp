// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/compare_panel.h"
#include "core/bake/view_caustics.h"
#include "widgets/panel_parts.h"
#include <QComboBox>
#include <QFontDatabase>
#include <QFormLayout>
#include <QLabel>
#include <QProgressBar>
#include <QSpinBox>
#include <QVBoxLayout>

namespace lightloom {

namespace {

struct Figure {
    const char *name, *tip;
    double ErrorMetrics::*value;
    bool isSigned;
};
constexpr std::array<Figure, 6> kFigures{{
    {QT_TR_NOOP("relRMSE"), QT_TR_NOOP("Root of the mean squared difference, over the mean of the reference"),
     &ErrorMetrics::relRmse, false},
    {QT_TR_NOOP("Bias"), QT_TR_NOOP("Mean difference over the mean: + too bright"), &ErrorMetrics::bias, true},
    {QT_TR_NOOP("Mean |error|"), QT_TR_NOOP("Mean absolute difference over the mean"), &ErrorMetrics::mae, false},
    {QT_TR_NOOP("95 % below"), QT_TR_NOOP("95th percentile of the absolute difference over the mean"),
     &ErrorMetrics::p95, false},
    {QT_TR_NOOP("Largest"), QT_TR_NOOP("Largest absolute difference over the mean"), &ErrorMetrics::max, false},
    {QT_TR_NOOP("Per pixel"),
     QT_TR_NOOP("Root mean square of each pixel's own relative error: sees dark corners, which "
                "relRMSE hides"),
     &ErrorMetrics::perPoint, false},
}};

constexpr double kNoisy = 0.25; ///< of relRMSE: below, the reference's noise moves it by 3 % at most

QString percent(double fraction, bool isSigned = false)
{
    const QString number = QString::number(100.0 * fraction, 'f', 2);
    return QStringLiteral("%1%2 %").arg(isSigned && fraction > 0.0 ? QStringLiteral("+") : QString(), number);
}

QString timeText(double seconds)
{
    if (seconds < 100.0) return QObject::tr("%1 s").arg(seconds, 0, 'f', 1);
    return QObject::tr("%1 min").arg(seconds / 60.0, 0, 'f', 1);
}

} // namespace

bool noiseCounts(const ViewError& error) { return error.noise > kNoisy * error.metrics.relRmse; }

ComparePanel::ComparePanel(QAction* reference, QAction* wipe, QWidget* parent)
    : QWidget(parent), state_(textLines()), bar_(thinProgress(tr("Progress of the reference"))), samples_(new QSpinBox),
      size_(new QComboBox), judged_(textLines()), noise_(new QLabel)
{
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(6, 6, 6, 6);
    samples_->setRange(8, 65536);
    samples_->setObjectName(QStringLiteral("compare.samples"));
    samples_->setValue(256);
    samples_->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
    samples_->setKeyboardTracking(false);
    samples_->setAccessibleName(tr("Camera rays per pixel"));
    samples_->setToolTip(tr("Camera rays per pixel: four times as many halve the noise"));
    size_->addItem(tr("As the picture"), 1);
    size_->addItem(tr("Half, each way"), 2);
    size_->addItem(tr("A quarter, each way"), 4);
    size_->setAccessibleName(tr("Size of the reference"));
    size_->setToolTip(tr("A smaller reference gets fine sooner"));
    connect(samples_, &QSpinBox::valueChanged, this, &ComparePanel::qualityEdited);
    connect(size_, &QComboBox::activated, this, &ComparePanel::qualityEdited);

    auto* form = new QFormLayout;
    form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    form->setRowWrapPolicy(QFormLayout::WrapLongRows);
    form->addRow(tr("Rays per pixel"), samples_);
    form->addRow(tr("Size"), size_);
    auto* figures = new QFormLayout;
    figures->setHorizontalSpacing(16);
    const QFont digits = QFontDatabase::systemFont(QFontDatabase::FixedFont);
    for (std::size_t i = 0; i < kFigures.size(); ++i) {
        figures_[i] = new QLabel;
        figures_[i]->setFont(digits);
        figures_[i]->setTextInteractionFlags(Qt::TextSelectableByMouse);
        figures->addRow(tr(kFigures[i].name), figures_[i]);
        for (QWidget* widget : {static_cast<QWidget*>(figures_[i]), figures->labelForField(figures_[i])})
            widget->setToolTip(tr(kFigures[i].tip));
        figures_[i]->setAccessibleName(tr(kFigures[i].name));
    }
    noise_->setFont(digits);
    figures->addRow(tr("Reference noise"), noise_);
    noise_->setToolTip(tr("What the reference's own noise makes of relRMSE, at most"));
    column->addLayout(actionButtons({reference, wipe}));
    column->addWidget(bar_);
    column->addWidget(state_);
    column->addLayout(form);
    auto* title = new QLabel(QStringLiteral("<b>%1</b>").arg(tr("Indirect light against the reference")));
    title->setWordWrap(true);
    title->setContentsMargins(0, 8, 0, 0);
    column->addWidget(title);
    column->addWidget(judged_);
    column->addLayout(figures);
    column->addStretch(1);
    showState(tr("Off"));
    forgetErrors();
}

int ComparePanel::samples() const { return samples_->value(); }
int ComparePanel::shrink() const { return size_->currentData().toInt(); }

void ComparePanel::showState(const QString& line)
{
    setFraction(*bar_, 0.0);
    state_->setText(line);
}

void ComparePanel::show(const ReferencePicture& picture)
{
    if (picture.isRough) {
        setFraction(*bar_, 0.0);
        state_->setText(tr("Rough picture"));
        return;
    }
    const View& view = *picture.view;
    const int wanted = picture.job.samples, done = view.samples;
    const bool isLast = !view.isWhole && done >= wanted; // small lamps by way of mirrors
    setFraction(*bar_, view.isWhole ? 1.0 : static_cast<double>(done) / (wanted + 1));
    QString line = picture.wasStored ? tr("Done, from disk")
                   : view.isWhole    ? tr("Done: %1 rays per pixel").arg(done)
                                     : tr("%1 of %2 rays per pixel").arg(done).arg(wanted);
    if (isLast) {
        line +=
            tr("; photons by way of mirrors, round %1 of %2").arg(view.causticRounds).arg(causticRounds(picture.job));
    }
    if (picture.noise >= 0.0) line += tr(", noise %1 %").arg(100.0 * picture.noise, 0, 'f', 1);
    if (picture.seconds > 0.0) line += tr(", %1").arg(timeText(picture.seconds));
    if (!view.isWhole && !isLast && done > 0)
        line += tr(", about %1 left").arg(timeText(picture.seconds * (wanted - done) / done));
    state_->setText(line);
}

void ComparePanel::show(const ErrorPicture& picture, const QString& judged)
{
    if (!picture.error) {
        forgetErrors();
        judged_->setText(picture.problem);
        return;
    }
    const ErrorMetrics& m = picture.error->metrics;
    judged_->setText(picture.block > 1 ? tr("%1, in blocks of %2 pixels so far").arg(judged).arg(picture.block)
                                       : judged);
    if (noiseCounts(*picture.error))
        judged_->setText(tr("%1; noise of the reference still counts").arg(judged_->text()));
    for (std::size_t i = 0; i < kFigures.size(); ++i)
        figures_[i]->setText(percent(m.*kFigures[i].value, kFigures[i].isSigned));
    noise_->setText(picture.error->noise > 0.0 ? percent(picture.error->noise) : tr("not known yet"));
}

void ComparePanel::forgetErrors()
{
    judged_->setText(tr("Nothing is compared yet."));
    for (QLabel* label : figures_) label->setText(QStringLiteral("-"));
    noise_->setText(QStringLiteral("-"));
}

QString ComparePanel::stateText() const { return state_->text(); }
QString ComparePanel::judgedText() const { return judged_->text(); }
QString ComparePanel::figure(int row) const { return figures_[static_cast<std::size_t>(row)]->text(); }

} // namespace lightloom
