// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to look at lit voxels: all of them in a cut, some at random, those around.
#include "widgets/main_window.h"
#include "widgets/picture_desk.h"
#include <QAction>
#include <QActionGroup>
#include <QMenu>

namespace lightloom {

void MainWindow::makeVoxelActions()
{
    lookups_ = new QActionGroup(this);
    const auto add = [this](const QString& text, const QString& tip, VoxelLookup lookup) {
        QAction* action = makeAction(text, {}, tip);
        action->setCheckable(true);
        action->setData(static_cast<int>(lookup));
        lookups_->addAction(action);
        connect(action, &QAction::triggered, this, [this, lookup] {
            BakeParams params = params_;
            params.voxelLookup = lookup;
            setParams(params);
        });
    };
    add(tr("&Lightcuts"), tr("A picture from all voxels as lights, gathered where the camera looks"),
        VoxelLookup::lightcuts);
    add(tr("&Sample voxels"), tr("A picture from some voxels at random, with a shadow ray to each"),
        VoxelLookup::samples);
    add(tr("&Field"), tr("The voxels' own light, interpolated, at frame rate"), VoxelLookup::field);
    showVoxelLook();
}

void MainWindow::addVoxelMenu(QMenu& view) { view.addMenu(tr("&Voxels"))->addActions(lookups_->actions()); }

void MainWindow::showVoxelLook()
{
    for (QAction* action : lookups_->actions())
        action->setChecked(action->data().toInt() == static_cast<int>(params_.voxelLookup));
}

void MainWindow::useVoxelShow()
{
    if (pictureDesk_ != nullptr) pictureDesk_->setShow(voxelShow(params_));
    showVoxelLook();
    mayShowCuts();
}

} // namespace lightloom
