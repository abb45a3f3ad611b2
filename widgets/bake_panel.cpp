// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/bake_panel.h"
#include <QAction>
#include <QHBoxLayout>
#include <QLabel>
#include <QLocale>
#include <QProgressBar>
#include <QToolButton>
#include <QVBoxLayout>

namespace lightloom {

namespace {

QString stageWord(Stage stage)
{
    switch (stage) {
    case Stage::shoot:
        return QObject::tr("Shooting photons");
    case Stage::build:
        return QObject::tr("Building the octree");
    case Stage::fit:
        return QObject::tr("Gathering light");
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

} // namespace

BakePanel::BakePanel(QAction* start, QAction* pause, QAction* cancel, QWidget* parent)
    : QWidget(parent), stage_(new QLabel), depths_(new QLabel), counters_(new QLabel), bar_(new QProgressBar)
{
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(6, 6, 6, 0);
    auto* buttons = new QHBoxLayout;
    for (QAction* action : {start, pause, cancel}) {
        auto* button = new QToolButton;
        button->setDefaultAction(action);
        button->setToolButtonStyle(Qt::ToolButtonTextOnly);
        button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
        buttons->addWidget(button);
    }
    bar_->setRange(0, 1000);
    bar_->setTextVisible(false);
    bar_->setMaximumHeight(10);
    bar_->setAccessibleName(tr("Progress of the bake"));
    for (QLabel* label : {stage_, depths_, counters_}) {
        label->setWordWrap(true);
        label->setTextInteractionFlags(Qt::TextSelectableByMouse);
    }
    column->addLayout(buttons);
    column->addWidget(bar_);
    column->addWidget(stage_);
    column->addWidget(depths_);
    column->addWidget(counters_);
    clear();
}

void BakePanel::clear()
{
    times_.clear();
    bar_->setValue(0);
    stage_->setText(tr("Nothing to bake yet."));
    depths_->clear();
    counters_->clear();
}

void BakePanel::begin()
{
    times_.clear();
    bar_->setValue(0);
    stage_->setText(tr("Preparing"));
}

void BakePanel::show(const Progress& progress)
{
    bar_->setValue(static_cast<int>(progress.fraction * 1000.0));
    QString line = tr("%1, %2 %").arg(stageWord(progress.stage)).arg(progress.fraction * 100.0, 0, 'f', 0);
    if (progress.remainingSeconds >= 0.0) line += tr(", about %1 s left").arg(progress.remainingSeconds, 0, 'f', 1);
    stage_->setText(line);
}

void BakePanel::show(const BakeView& view)
{
    if (!times_.isEmpty()) times_ += QStringLiteral("<br>");
    times_ += (view.snapshot.isRough ? tr("Rough picture after %1: %2 leaves, %3 entries")
                                     : tr("Depth %1 after %2: %3 leaves, %4 entries").arg(view.snapshot.level))
                  .arg(seconds(view.snapshot.elapsedMs), count(view.leaves), count(view.entries));
    depths_->setText(times_);
}

void BakePanel::end(const QString& outcome, const WorkCounters& c)
{
    stage_->setText(outcome);
    QString text = tr("Photons: %1 shot, %2 stored, %3 kept from before<br>Rays: %4 traced")
                       .arg(count(c.photonsShot), count(c.photonsStored), count(c.photonsReused), count(c.raysTraced));
    text += tr("<br>Lamps: %1 baked, %2 kept, %3 off").arg(c.groupsBaked).arg(c.groupsReused).arg(c.groupsOff);
    if (c.pathsCutOff > 0) text += tr("<br>%1 paths were cut off at the longest allowed").arg(count(c.pathsCutOff));
    if (c.degenerateEntries > 0) text += tr("<br>%1 entries had no area to gather on").arg(count(c.degenerateEntries));
    counters_->setText(text);
}

QString BakePanel::stageText() const { return stage_->text(); }
double BakePanel::fraction() const { return bar_->value() / 1000.0; }

} // namespace lightloom
