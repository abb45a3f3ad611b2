// SPDX-License-Identifier: GPL-3.0-or-later
// What the window holds its picture against: commands and places of the reference, the errors and the wipe. What they
// do stands in compare_desk.cpp.
#include "core/compare/false_colour.h"
#include "widgets/atlas_desk.h"
#include "widgets/compare_desk.h"
#include "widgets/compare_panel.h"
#include "widgets/legend_strip.h"
#include "widgets/main_window.h"
#include "widgets/message_bar.h"
#include "widgets/pick_desk.h"
#include "widgets/picture_desk.h"
#include "widgets/sweep_panel.h"
#include "widgets/viewport.h"
#include "widgets/wipe_handle.h"
#include <QAction>
#include <QActionGroup>
#include <QLabel>
#include <QMenu>
#include <QToolButton>

namespace lightloom {

void MainWindow::addShownAction(const QString& text, const QKeySequence& keys, const QString& tip,
                                std::optional<ErrorKind> kind)
{
    QAction* action = makeAction(text, keys, tip);
    action->setCheckable(true);
    action->setChecked(!kind);
    shown_->addAction(action);
    connect(action, &QAction::triggered, this, [this, kind] {
        if (compareDesk_ == nullptr) return;
        showCuts(false);
        showErrors(kind);
    });
}

void MainWindow::showErrors(std::optional<ErrorKind> kind)
{
    compareDesk_->showErrors(kind);
    pictureDesk_->coverChanged();
}

void MainWindow::showCuts(bool on)
{
    compareDesk_->showCuts(on);
    pictureDesk_->showCuts(on);
}

/// They are of lightcuts: there is light again where these are no longer looked at.
void MainWindow::mayShowCuts()
{
    if (pictureDesk_ == nullptr) return;
    cuts_->setEnabled(pictureDesk_->hasCuts());
    if (cuts_->isChecked() && !cuts_->isEnabled()) shown_->actions().first()->trigger();
}

void MainWindow::makeCompareActions()
{
    shown_ = new QActionGroup(this);
    addShownAction(tr("&Light"), Qt::CTRL | Qt::Key_1, tr("Show light"), {});
    addShownAction(tr("&Error, %"), Qt::CTRL | Qt::Key_2,
                   tr("Show how far the indirect light is off the reference, in per cent of its mean"),
                   ErrorKind::relative);
    addShownAction(tr("Error, l&ux"), Qt::CTRL | Qt::Key_3,
                   tr("Show how far the indirect illuminance is off the reference, in lux"), ErrorKind::absolute);
    addShownAction(tr("&Signed error"), Qt::CTRL | Qt::Key_4, tr("Show what is too dark and what too bright"),
                   ErrorKind::difference);
    shown_->actions().last()->setIconText(tr("Error, ±")); // the toolbar is short
    cuts_ = makeAction(tr("&Cut sizes"), Qt::CTRL | Qt::Key_5,
                       tr("Show how many clusters the lightcut of each pixel took, while lightcuts are shown"));
    cuts_->setCheckable(true);
    cuts_->setEnabled(false);
    shown_->addAction(cuts_);
    connect(cuts_, &QAction::triggered, this, [this] {
        showErrors({});
        showCuts(true);
    });
    reference_ = makeAction(tr("&Trace reference"), QKeySequence(Qt::Key_R),
                            tr("Trace a picture of this view by paths, whenever no bake runs; again to stop"));
    reference_->setCheckable(true);
    wipe_ = makeAction(tr("&Wipe"), QKeySequence(Qt::Key_C),
                       tr("Reference on the left, bake on the right of an edge that can be moved"));
    wipe_->setCheckable(true);
    pick_ = makeAction(tr("&Pick a cell"), QKeySequence(Qt::Key_P),
                       tr("Click a surface to see what octree, grid or voxels keep there; again to put it away"));
    pick_->setCheckable(true);
}

QWidget* MainWindow::makeComparePanel()
{
    comparePanel_ = new ComparePanel(reference_, wipe_);
    return comparePanel_;
}

QWidget* MainWindow::makeSweepPanel()
{
    sweepPanel_ = new SweepPanel;
    connect(sweepPanel_, &SweepPanel::chosen, this, &MainWindow::setParams);
    return sweepPanel_;
}

QWidget* MainWindow::makeShownButton()
{
    auto* button = new QToolButton;
    auto* menu = new QMenu(button);
    menu->addActions(shown_->actions());
    button->setMenu(menu);
    button->setPopupMode(QToolButton::InstantPopup);
    button->setText(shown_->checkedAction()->iconText());
    button->setToolTip(tr("What the picture shows: light, how far it is off the reference, or what lightcuts took"));
    button->setAccessibleName(tr("Shown"));
    connect(shown_, &QActionGroup::triggered, button, [button](QAction* a) { button->setText(a->iconText()); });
    return button;
}

void MainWindow::connectCompare()
{
    if (viewport_ == nullptr) {
        for (QAction* action : shown_->actions()) action->setEnabled(false);
        reference_->setEnabled(false);
        wipe_->setEnabled(false);
        pick_->setEnabled(false);
        return;
    }
    auto* handle = new WipeHandle(viewport_);
    compareDesk_ = new CompareDesk({viewport_, comparePanel_, handle, legend_, reference_, wipe_}, this);
    connect(compareDesk_, &CompareDesk::tracing, this, &MainWindow::tellBusy);
    pickDesk_ = new PickDesk(viewport_, worker_, pick_, this);
    atlasDesk_ = new AtlasDesk(viewport_, this);
    connect(atlasDesk_, &AtlasDesk::began, this,
            [this] { statusStage_->setText(tr("Unwrapping the scene; the octree is shown meanwhile")); });
    connect(atlasDesk_, &AtlasDesk::made, this, [this](const QString& about) { statusStage_->setText(about); });
    connect(atlasDesk_, &AtlasDesk::failed, this, [this](const QString& problem) { messages_->show(problem); });
    pictureDesk_ = new PictureDesk(viewport_, this);
    connect(pictureDesk_, &PictureDesk::stateChanged, this,
            [this] { compareDesk_->showPictureState(pictureDesk_->stateText(), pictureDesk_->cutScale()); });
    connect(wipe_, &QAction::toggled, pictureDesk_, &PictureDesk::coverChanged); // after the desk's own, which sets it
    connect(pictureDesk_, &PictureDesk::fieldChanged, this, &MainWindow::judgeView);
}

} // namespace lightloom
