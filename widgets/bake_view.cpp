// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/bake_view.h"
#include "core/compare/field_noise.h"
#include "core/octree/detail_union.h"
#include <QObject>
#include <algorithm>

namespace lightloom {

namespace {

struct Textures {
    Result<GpuOctree> lights, colours;
    QString remark; ///< if the deepest leaves were left out
};

/// The octree as textures; without its deepest leaves where these are too many.
Textures texturesOf(std::shared_ptr<const LightOctree> octree)
{
    const std::size_t all = octree->deeper().size();
    while (true) {
        Result<GpuOctree> lights = makeGpuOctree(*octree);
        Result<GpuOctree> colours = lights ? makeGpuOctree(*octree->showing(OctreeShow::colour)) : lights;
        const std::size_t levels = octree->deeper().size();
        if (colours || levels == 0) {
            QString remark;
            if (levels < all)
                remark = QStringLiteral("Leaves deeper than %1 are too many for the viewport, which shows those above.")
                             .arg(octree->geometry().depth + static_cast<int>(levels));
            return {std::move(lights), std::move(colours), remark};
        }
        octree = octree->withDetail(levels - 1);
    }
}

void addOctree(const std::shared_ptr<const LightOctree>& octree, BakeView& view)
{
    view.colours = octree->showing(OctreeShow::colour);
    Textures textures = texturesOf(octree);
    Result<GpuOctree>& gpu = textures.lights;
    Result<GpuOctree>& gpuOfColours = textures.colours;
    if (!gpuOfColours) {
        view.problem = QString::fromStdString(gpuOfColours.error().message);
        return;
    }
    view.leaves = gpu->leafCount;
    view.entries = gpu->entryCount;
    view.gpu = std::make_shared<const GpuOctree>(std::move(*gpu));
    view.gpuOfColours = std::make_shared<const GpuOctree>(std::move(*gpuOfColours));
    view.problem = std::move(textures.remark);
}

void addGrid(std::shared_ptr<const IrradianceGrid> grid, const Look& look, BakeView& view)
{
    if (!(grid->show() == look.grid)) view.snapshot.field = grid = grid->withShow(look.grid);
    view.params.gridRemap = look.grid.remap;
    view.params.gridFilter = look.grid.filter;
    view.params.gridOffset = look.grid.offset;
    view.vertices = gridVertices(*grid, look.mix, look.vertices);
    Result<GpuGrid> gpu = makeGpuGrid(*grid, look.packing);
    if (gpu) {
        view.gpuGrid = std::make_shared<const GpuGrid>(std::move(*gpu));
        if (grid->inside().grid)
            view.problem = QStringLiteral("The picture shows the outer grid alone; figures, comparison and export know "
                                          "the finer one inside.");
    } else {
        view.problem = QString::fromStdString(gpu.error().message);
    }
}

} // namespace

namespace {

/// Null: it is none.
const IrradianceGrid* gridOf(const Snapshot& snapshot)
{
    return dynamic_cast<const IrradianceGrid*>(snapshot.field.get());
}

int longestSide(glm::ivec3 cells) { return std::max({cells.x, cells.y, cells.z}); }

} // namespace

QString gridSizeText(const Snapshot& snapshot)
{
    const IrradianceGrid* grid = gridOf(snapshot);
    if (grid == nullptr) return {};
    const glm::ivec3 cells = grid->geometry().lattice.cells;
    return QObject::tr("%1 x %2 x %3 cells").arg(cells.x).arg(cells.y).arg(cells.z);
}

QString shortName(const Snapshot& snapshot)
{
    if (snapshot.isRough) return QObject::tr("rough");
    if (const IrradianceGrid* grid = gridOf(snapshot))
        return QObject::tr("N %1").arg(longestSide(grid->geometry().lattice.cells));
    return QObject::tr("d%1").arg(snapshot.level);
}

QString fullName(const Snapshot& snapshot)
{
    const IrradianceGrid* grid = gridOf(snapshot);
    if (snapshot.isRough)
        return grid != nullptr ? QObject::tr("Irradiance grid, rough") : QObject::tr("Light octree, rough");
    if (grid == nullptr) return QObject::tr("Light octree, depth %1").arg(snapshot.level);
    const QString name = QObject::tr("Irradiance grid, N %1").arg(longestSide(grid->geometry().lattice.cells));
    switch (grid->show().filter) {
    case GridFilter::bspline:
        return QObject::tr("%1, tricubic").arg(name);
    case GridFilter::catmullRom:
        return QObject::tr("%1, Catmull-Rom").arg(name);
    case GridFilter::trilinear:
        break;
    }
    return name;
}

BakeView withLook(BakeView view, const Look& look)
{
    view.lookSerial = look.serial;
    view.snapshot.field = view.snapshot.field->withMix(look.mix);
    if (view.photons) view.photons = std::static_pointer_cast<const PhotonMapField>(view.photons->withMix(look.mix));
    view.gpu.reset();
    view.gpuGrid.reset();
    view.vertices.reset();
    view.gpuOfColours.reset();
    view.problem.clear();
    if (const auto octree = std::dynamic_pointer_cast<const LightOctree>(view.snapshot.field)) {
        addOctree(octree, view);
    } else if (const auto grid = std::dynamic_pointer_cast<const IrradianceGrid>(view.snapshot.field)) {
        addGrid(grid, look, view);
    } else {
        view.problem = QStringLiteral("This viewport cannot show the method %1.")
                           .arg(QString::fromStdString(std::string(view.snapshot.field->method())));
    }
    view.noise = view.noisePoints ? statedNoise(*view.snapshot.field, *view.noisePoints) : std::nullopt;
    return view;
}

} // namespace lightloom
