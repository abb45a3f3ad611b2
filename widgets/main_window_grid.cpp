// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to look at irradiance grids: the filter between vertices, what is kept of their vectors.
#include "widgets/main_window.h"
#include <QAction>
#include <QActionGroup>
#include <QMenu>

namespace lightloom {

namespace {

/// A form as a command holds it.
int formNumber(GridRemap remap, GridPacking packing) { return 2 * static_cast<int>(remap) + static_cast<int>(packing); }

} // namespace

void MainWindow::makeGridActions()
{
    filters_ = new QActionGroup(this);
    const auto addFilter = [this](const QString& text, const QString& tip, GridFilter filter) {
        QAction* action = makeAction(text, {}, tip);
        action->setCheckable(true);
        action->setData(static_cast<int>(filter));
        filters_->addAction(action);
        connect(action, &QAction::triggered, this, [this, filter] { useFilter(filter); });
    };
    addFilter(tr("&Trilinear"), tr("Between eight vertices; keeps walls apart"), GridFilter::trilinear);
    addFilter(tr("Tri&cubic"), tr("B-spline over 64 vertices: smoothest, but light comes through thin walls"),
              GridFilter::bspline);
    addFilter(tr("Catmull-&Rom"), tr("Through 64 vertices: smooth and sharper, may ring; slow"),
              GridFilter::catmullRom);
    swapFilters_ = makeAction(tr("&Swap filters"), QKeySequence(Qt::Key_T), tr("A grid trilinear or tricubic"));
    connect(swapFilters_, &QAction::triggered, this, [this] {
        const bool isTrilinear = look_.grid.filter == GridFilter::trilinear;
        useFilter(isTrilinear ? GridFilter::bspline : GridFilter::trilinear);
    });
    forms_ = new QActionGroup(this);
    const auto addForm = [this](const QString& text, const QString& tip, GridRemap remap, GridPacking packing) {
        QAction* action = makeAction(text, {}, tip);
        action->setCheckable(true);
        action->setData(formNumber(remap, packing));
        forms_->addAction(action);
        connect(action, &QAction::triggered, this, [this, remap, packing] { useForm(remap, packing); });
    };
    addForm(tr("&Joined"), tr("Flux on the axes, harmonics between them"), GridRemap::joined, GridPacking::exact);
    addForm(tr("&Flux"), tr("Flux of six directions alone"), GridRemap::flux, GridPacking::exact);
    addForm(tr("&Harmonics"), tr("Second-order harmonics alone"), GridRemap::harmonic, GridPacking::exact);
    addForm(tr("As &printed"), tr("The remap of the 2009 paper, 54 numbers a vertex; too dark"), GridRemap::paper,
            GridPacking::exact);
    addForm(tr("As printed, co&mpressed"), tr("The paper's 12 textures: a colour and one direction for each side"),
            GridRemap::paper, GridPacking::compressed);
    vertices_ = new QActionGroup(this);
    const auto addMarks = [this](const QString& text, const QString& tip, VertexMarks marks) {
        QAction* action = makeAction(text, {}, tip);
        action->setCheckable(true);
        action->setChecked(marks == VertexMarks::none);
        vertices_->addAction(action);
        connect(action, &QAction::triggered, this, [this, marks] { markVertices(marks); });
    };
    addMarks(tr("&No vertices"), tr("The picture alone"), VertexMarks::none);
    addMarks(tr("Vertices by &openness"), tr("Mark the grid's vertices by what walls leave open around them"),
             VertexMarks::openness);
    addMarks(tr("Vertices by nois&e"), tr("Mark the grid's vertices by the noise of their light"), VertexMarks::noise);
    nextVertices_ = makeAction(tr("Mark &vertices"), QKeySequence(Qt::Key_V),
                               tr("A grid's vertices by openness, by noise, not at all; voxels likewise"));
    connect(nextVertices_, &QAction::triggered, this, [this] {
        const QActionGroup* marks = method_ == Method::voxelLightcuts ? voxelMarks_ : vertices_;
        const auto all = marks->actions();
        all[(all.indexOf(marks->checkedAction()) + 1) % all.size()]->trigger();
    });
    showGridLook();
}

void MainWindow::markVertices(VertexMarks marks)
{
    look_.vertices = marks;
    lookChanged();
}

QString MainWindow::vertexNote() const
{
    if (look_.vertices == VertexMarks::openness)
        return tr("Vertices: green open, yellow in part,\norange too little, red in walls");
    return tr("Noise of vertices: from 0 (dark)\nto %1 % and more (pale)").arg(100.0f * kMostVertexNoise);
}

void MainWindow::addGridMenu(QMenu& view)
{
    QMenu* menu = view.addMenu(tr("Irradiance &grid"));
    menu->addActions(filters_->actions());
    menu->addAction(swapFilters_);
    menu->addSeparator();
    menu->addActions(forms_->actions());
    menu->addSeparator();
    menu->addActions(vertices_->actions());
    menu->addAction(nextVertices_);
}

void MainWindow::useFilter(GridFilter filter)
{
    BakeParams params = params_;
    params.gridFilter = filter;
    setParams(params);
}

void MainWindow::useForm(GridRemap remap, GridPacking packing)
{
    const bool isOther = packing != look_.packing;
    look_.packing = packing;
    BakeParams params = params_;
    params.gridRemap = remap;
    if (!(params == params_)) return setParams(params);
    if (isOther) lookChanged();
}

void MainWindow::showGridLook()
{
    for (QAction* action : filters_->actions())
        action->setChecked(action->data().toInt() == static_cast<int>(look_.grid.filter));
    for (QAction* action : forms_->actions())
        action->setChecked(action->data().toInt() == formNumber(look_.grid.remap, look_.packing));
}

} // namespace lightloom
