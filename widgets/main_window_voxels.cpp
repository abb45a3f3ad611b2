// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to look at lit voxels: all of them in a cut, some at random, those around.
#include "widgets/compare_desk.h"
#include "widgets/main_window.h"
#include "widgets/picture_desk.h"
#include "widgets/snapshot_bar.h"
#include "widgets/voxel_panel.h"
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
    voxelMarks_ = new QActionGroup(this);
    const auto addMarks = [this](const QString& text, const QString& tip, VoxelMarks marks) {
        QAction* action = makeAction(text, {}, tip);
        action->setCheckable(true);
        action->setChecked(marks == VoxelMarks::none);
        voxelMarks_->addAction(action);
        connect(action, &QAction::triggered, this, [this, marks] {
            look_.voxels = marks;
            lookChanged();
        });
    };
    addMarks(tr("&No voxels"), tr("The picture alone"), VoxelMarks::none);
    addMarks(tr("Voxels by &radiosity"), tr("Voxels as discs, coloured by the light that they send on"),
             VoxelMarks::radiosity);
    addMarks(tr("Voxels by &area"), tr("Voxels as discs, coloured by the surface in each"), VoxelMarks::area);
    addMarks(tr("Voxels by nor&mal"), tr("Voxels as discs, coloured by what they face"), VoxelMarks::normal);
    showVoxelLook();
}

void MainWindow::addVoxelMenu(QMenu& view)
{
    QMenu* menu = view.addMenu(tr("&Voxels"));
    menu->addActions(lookups_->actions());
    menu->addSeparator();
    menu->addActions(voxelMarks_->actions());
    menu->addAction(nextVertices_);
}

/// What colours over the picture mean.
void MainWindow::tellMarks()
{
    if (compareDesk_ == nullptr) return;
    const BakeView* view = snapshots_->shown();
    const VoxelDiscs* discs = view != nullptr ? view->discs.get() : nullptr;
    if (discs == nullptr) return compareDesk_->showNote(view && view->vertices ? vertexNote() : QString(), {});
    switch (discs->by) {
    case VoxelMarks::radiosity:
        return compareDesk_->showNote(tr("Radiosity of voxels, lm/m\u00b2"), discs->scale);
    case VoxelMarks::area:
        return compareDesk_->showNote(tr("Surface in a voxel, of a face of it"), discs->scale);
    case VoxelMarks::normal:
    case VoxelMarks::none:
        return compareDesk_->showNote(tr("Normals of voxels: red +x, green +y, blue +z"), {});
    }
}

void MainWindow::showVoxelLook()
{
    for (QAction* action : lookups_->actions())
        action->setChecked(action->data().toInt() == static_cast<int>(params_.voxelLookup));
}

void MainWindow::useVoxelShow()
{
    if (pictureDesk_ != nullptr) pictureDesk_->setShow(voxelShow(params_));
    voxelPanel_->setVisible(method_ == Method::voxelLightcuts);
    voxelPanel_->setDirections(params_.voxelDirections);
    showVoxelLook();
    mayShowCuts();
}

} // namespace lightloom
