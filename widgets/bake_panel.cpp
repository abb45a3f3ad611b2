// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/bake_panel.h"
#include "core/base/units.h"
#include "widgets/panel_parts.h"
#include <QHBoxLayout>
#include <QLabel>
#include <QLocale>
#include <QProgressBar>
#include <QVBoxLayout>
#include <cmath>

namespace lightloom {

namespace {

QString stageWord(Stage stage, Method method)
{
    const bool isGrid = method == Method::irradianceGrid, isVoxels = method == Method::voxelLightcuts;
    switch (stage) {
    case Stage::shoot:
        return QObject::tr("Shooting photons");
    case Stage::build:
        if (isVoxels) return QObject::tr("Finding who sees whom");
        return isGrid ? QObject::tr("Placing the grid") : QObject::tr("Building the octree");
    case Stage::fit:
        if (isVoxels) return QObject::tr("Bouncing light");
        return isGrid ? QObject::tr("Summing light") : QObject::tr("Gathering light");
    case Stage::show:
        break;
    }
    return QObject::tr("Finishing");
}

QString count(std::uint64_t n) { return QLocale().toString(static_cast<qulonglong>(n)); }

QString seconds(double ms)
{
    return ms < 1000.0 ? QObject::tr("%1 ms").arg(ms, 0, 'f', 0) : QObject::tr("%1 s").arg(ms / 1000.0, 0, 'f', 2);
}

/// Shares of the luminous flux, so that a coloured lamp counts as the eye counts it.
QString audit(const Ledger& ledger)
{
    const auto flux = [](const glm::dvec3& v) {
        return glm::dot(v, glm::dvec3(double{kLumaR}, double{kLumaG}, double{kLumaB}));
    };
    const double emitted = flux(ledger.emitted);
    if (!(emitted > 0.0)) return {};
    const auto share = [&](const glm::dvec3& v, int decimals) {
        return QString::number(100.0 * flux(v) / emitted, 'f', decimals);
    };
    const double missing = 100.0 * std::abs(flux(ledger.missing())) / emitted;
    return QObject::tr("Light: %1 lm emitted, %2 % absorbed, %3 % escaped, %4 % cut off, %5 missing")
        .arg(QLocale().toString(emitted, 'f', emitted < 100.0 ? 2 : 0), share(ledger.absorbed, 1),
             share(ledger.escaped, 1), share(ledger.terminated, 2),
             missing < 1e-6 ? QObject::tr("nothing") : QObject::tr("%1 %").arg(missing));
}

} // namespace

BakePanel::BakePanel(QAction* start, QAction* pause, QAction* cancel, QWidget* parent)
    : QWidget(parent), stage_(textLines()), depths_(textLines()), noise_(textLines()), light_(textLines()),
      counters_(textLines()), bar_(thinProgress(tr("Progress of the bake")))
{
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(6, 6, 6, 0);
    column->addLayout(actionButtons({start, pause, cancel}));
    column->addWidget(bar_);
    column->addWidget(stage_);
    column->addWidget(depths_);
    column->addWidget(noise_);
    column->addWidget(light_);
    column->addWidget(counters_);
    depths_->setObjectName("depths"); // tests read it
    depths_->setToolTip(tr("Time since the bake began, and what it has cost of all threads together; what was kept "
                           "counts with what it cost then."));
    noise_->setToolTip(
        tr("What the bake knows of its own error: how much another seed would change it. Blur, which all "
           "seeds have alike, is not in it."));
    light_->setToolTip(tr("Where the photons' light went. Missing: emitted less all the rest; more than rounding would "
                          "be a mistake of the program."));
    clear();
}

void BakePanel::clear()
{
    times_.clear();
    bar_->setValue(0);
    stage_->setText(tr("Nothing to bake yet."));
    for (QLabel* label : {depths_, noise_, light_, counters_}) label->clear();
    for (QLabel* label : {light_, counters_}) label->setEnabled(true);
}

void BakePanel::setMethod(Method method) { method_ = method; }

void BakePanel::begin()
{
    times_.clear();
    bar_->setValue(0);
    stage_->setText(tr("Preparing"));
    // what the bake before did stays, so that the form below does not jump; it says that it is old
    if (light_->isEnabled() && !light_->text().isEmpty()) light_->setText(tr("Bake before: %1").arg(light_->text()));
    for (QLabel* label : {light_, counters_}) label->setEnabled(false);
}

void BakePanel::forgetDepths() { times_.clear(); }

void BakePanel::show(const Progress& progress)
{
    setFraction(*bar_, progress.fraction);
    QString line = tr("%1, %2 %").arg(stageWord(progress.stage, method_)).arg(progress.fraction * 100.0, 0, 'f', 0);
    if (progress.remainingSeconds >= 0.0) line += tr(", about %1 s left").arg(progress.remainingSeconds, 0, 'f', 1);
    stage_->setText(line);
}

void BakePanel::add(const BakeView& view)
{
    if (!times_.isEmpty()) times_ += QStringLiteral("<br>");
    const QString cost = tr("%1, %2 CPU-s").arg(seconds(view.snapshot.elapsedMs)).arg(view.cpuSeconds, 0, 'f', 2);
    if (view.isGrid() && view.snapshot.isRough) {
        // in the middle of shooting: processor time is told when that is done, cells are those of the last line
        times_ += tr("%1: %2").arg(shortName(view), seconds(view.snapshot.elapsedMs));
    } else if (view.isGrid()) {
        times_ += tr("%1: %2, %3").arg(shortName(view), cost, gridSizeText(view.snapshot));
    } else if (view.isVoxels()) {
        times_ +=
            tr("%1: %2, %3 voxels, %4 entries").arg(shortName(view), cost, count(view.leaves), count(view.entries));
    } else {
        const QString what = view.snapshot.isRough ? tr("Rough") : tr("Depth %1").arg(view.snapshot.level);
        times_ += tr("%1: %2, %3 entries").arg(what, cost, count(view.entries));
    }
    depths_->setText(times_);
}

void BakePanel::showNoise(const BakeView& view)
{
    if (view.isVoxels()) {
        const bool isFine = view.advice.isEmpty();
        noise_->setText(!isFine                 ? view.advice.join(QStringLiteral("<br>"))
                        : view.snapshot.isFinal ? tr("Nothing lit was found to be too fine for these voxels")
                                                : QString());
        return;
    }
    noise_->setText(view.noise ? tr("Noise: %1 % of the mean, stated by the bake").arg(100.0 * *view.noise, 0, 'f', 1)
                               : tr("Noise: not known"));
}

void BakePanel::end(const QString& outcome, const WorkCounters& c)
{
    stage_->setText(outcome);
    for (QLabel* label : {light_, counters_}) label->setEnabled(true);
    light_->setText(audit(c.ledger));
    if (method_ == Method::voxelLightcuts) {
        counters_->setText(tr("Voxels: %1 with %2 entries<br>Bounces: %3<br>Lamps: %4 on, light of %5 kept, %6 off")
                               .arg(count(c.voxels), count(c.entries), count(c.bounces))
                               .arg(c.groupsBaked)
                               .arg(c.groupsReused)
                               .arg(c.groupsOff));
        return;
    }
    QString text = tr("Photons: %1 shot, %2 stored, %3 kept from before<br>Rays: %4 traced")
                       .arg(count(c.photonsShot), count(c.photonsStored), count(c.photonsReused), count(c.raysTraced));
    text += tr("<br>Lamps: %1 on, photons of %2 kept, %3 off").arg(c.groupsBaked).arg(c.groupsReused).arg(c.groupsOff);
    if (c.pathsCutOff > 0) text += tr("<br>%1 paths were cut off at the longest allowed").arg(count(c.pathsCutOff));
    if (method_ == Method::irradianceGrid) {
        text += tr("<br>Grid: %1 vertices in the open, %2 deposits").arg(count(c.vertices), count(c.deposits));
    }
    if (c.degenerateEntries > 0) text += tr("<br>%1 entries had no area to gather on").arg(count(c.degenerateEntries));
    counters_->setText(text);
}

QString BakePanel::lightText() const { return light_->text(); }
QString BakePanel::countersText() const { return counters_->text(); }
QString BakePanel::noiseText() const { return noise_->text(); }
QString BakePanel::stageText() const { return stage_->text(); }
double BakePanel::fraction() const { return static_cast<double>(bar_->value()) / bar_->maximum(); }

} // namespace lightloom
