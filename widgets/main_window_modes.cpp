// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to show light: which method's bake, which picture of it, and what is measured and compared then.
#include "widgets/atlas_desk.h"
#include "widgets/bake_panel.h"
#include "widgets/compare_desk.h"
#include "widgets/main_window.h"
#include "widgets/param_panel.h"
#include "widgets/pick_desk.h"
#include "widgets/picture_desk.h"
#include "widgets/snapshot_bar.h"
#include "widgets/sweep_panel.h"
#include "widgets/view_worker.h"
#include "widgets/viewport.h"
#include "widgets/voxel_panel.h"
#include <QAction>

namespace lightloom {

bool MainWindow::showMethod(Method method)
{
    const ViewMode mode = method == Method::irradianceGrid   ? ViewMode::grid
                          : method == Method::voxelLightcuts ? ViewMode::lightcuts
                                                             : ViewMode::octree;
    if (mode == ViewMode::octree && method != Method::lightOctree) return false;
    for (QAction* action : bakeModes_) {
        if (action->data().toInt() == static_cast<int>(mode)) action->trigger();
    }
    return true;
}

void MainWindow::useMethod(Method method)
{
    if (method == method_) return;
    method_ = method;
    paramPanel_->setMethod(method);
    params_ = paramPanel_->params();
    useVoxelShow();
    bakePanel_->setMethod(method);
    sweepPanel_->setMethod(method);
    startBake(false);
}

BakeView MainWindow::asShown(BakeView view) const
{
    if (viewport_ == nullptr) return view;
    if (viewport_->mode() == ViewMode::colours && view.colours) view.snapshot.field = view.colours;
    const bool isMade = viewport_->mode() == ViewMode::photonMap || viewport_->mode() == ViewMode::lightcuts;
    if (isMade && pictureDesk_->field()) view.snapshot.field = pictureDesk_->field();
    return view;
}

void MainWindow::judgeView()
{
    const BakeView* view = snapshots_->shown();
    if (compareDesk_ != nullptr && view != nullptr && view->lookSerial == look_.serial) {
        pictureDesk_->setView(*view);
        atlasDesk_->setView(*view);
        pickDesk_->setView(view->isVoxels() ? asShown(*view) : *view);
        compareDesk_->setView(asShown(*view));
        tellMarks();
        voxelPanel_->setView(*view);
        measure();
    }
}

void MainWindow::measure()
{
    if (cursor_ && snapshots_->shown() != nullptr) {
        worker_->measure(asShown(*snapshots_->shown()), look_.mix, cursor_->position, cursor_->normal);
    } else {
        showMeasurement({});
    }
}

void MainWindow::setMode(ViewMode mode)
{
    if (mode == ViewMode::grid) useMethod(Method::irradianceGrid);
    if (mode == ViewMode::lightcuts) useMethod(Method::voxelLightcuts);
    const bool isOfOctree = mode == ViewMode::octree || mode == ViewMode::colours || mode == ViewMode::photonMap;
    if (isOfOctree) useMethod(Method::lightOctree);
    if (viewport_ == nullptr) return;
    viewport_->setMode(mode);
    pictureDesk_->modeChanged();
    atlasDesk_->modeChanged();
    compareDesk_->showPictureState(pictureDesk_->stateText(), pictureDesk_->cutScale());
    mayShowCuts();
    judgeView();
    compareDesk_->modeChanged();
}

} // namespace lightloom
