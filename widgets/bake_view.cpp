// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/bake_view.h"
#include "core/compare/field_noise.h"
#include "core/octree/detail_union.h"
#include "core/voxel/voxel_cuts.h"
#include <QLocale>
#include <QObject>
#include <algorithm>
#include <cmath>

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

/// Drawn as a colour octree of the same leaves.
void addVoxels(const VoxelField& field, const Look& look, BakeView& view)
{
    view.discs = voxelDiscs(field, look.voxels);
    Result<GpuOctree> gpu = makeGpuOctree(field.octree());
    if (!gpu) {
        view.problem = QString::fromStdString(gpu.error().message);
        return;
    }
    view.leaves = gpu->leafCount;
    view.entries = gpu->entryCount;
    view.gpu = std::make_shared<const GpuOctree>(std::move(*gpu));
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

/// "N 32", with a finer grid inside also how many of its cells would lie along there: "N 32 + 64".
QString cellsName(const IrradianceGrid& grid)
{
    const GridLattice& lattice = grid.geometry().lattice;
    const int n = longestSide(lattice.cells);
    if (!grid.inside().grid) return QObject::tr("N %1").arg(n);
    const float finer = lattice.cellSize.x / grid.inside().grid->geometry().lattice.cellSize.x;
    return QObject::tr("N %1 + %2").arg(n).arg(std::lround(static_cast<float>(n) * finer));
}

/// "65k", "2M", "1.5M".
QString countName(std::uint64_t count)
{
    const auto n = static_cast<double>(count);
    if (n < 1e3) return QString::number(count);
    return n < 1e6 ? QObject::tr("%1k").arg(n / 1e3, 0, 'f', 0) : QObject::tr("%1M").arg(n / 1e6, 0, 'g', 3);
}

QString remapName(GridRemap remap)
{
    return QString::fromLatin1(kGridRemapNames[static_cast<std::size_t>(remap)].data());
}

} // namespace

QString gridSizeText(const Snapshot& snapshot, GridText how)
{
    const IrradianceGrid* grid = gridOf(snapshot);
    if (grid == nullptr) return {};
    const auto sides = [](const IrradianceGrid& one) {
        const glm::ivec3 cells = one.geometry().lattice.cells;
        return QObject::tr("%1 x %2 x %3").arg(cells.x).arg(cells.y).arg(cells.z);
    };
    const QString text = QObject::tr("%1 cells").arg(sides(*grid));
    if (!grid->inside().grid) return text;
    if (how == GridText::brief) return QObject::tr("%1 + finer").arg(text);
    return QObject::tr("%1, %2 finer ones inside").arg(text, sides(*grid->inside().grid));
}

QString shortName(const BakeView& view)
{
    if (view.isVoxels()) return QObject::tr("N %1").arg(view.snapshot.level);
    const IrradianceGrid* grid = gridOf(view.snapshot);
    if (grid == nullptr)
        return view.snapshot.isRough ? QObject::tr("rough") : QObject::tr("d%1").arg(view.snapshot.level);
    QString name = cellsName(*grid);
    if (view.photonsPerLamp > 0) name = QObject::tr("%1, %2").arg(name, countName(view.photonsPerLamp));
    if (grid->show().remap != GridRemap::joined) name = QObject::tr("%1, %2").arg(name, remapName(grid->show().remap));
    return name;
}

namespace {

QString voxelName(const Snapshot& snapshot)
{
    const auto* cuts = dynamic_cast<const VoxelCuts*>(snapshot.field.get());
    if (!cuts) return QObject::tr("Voxels, N %1").arg(snapshot.level);
    if (cuts->show().lookup == VoxelLookup::lightcuts) return QObject::tr("Lightcuts, N %1").arg(snapshot.level);
    return QObject::tr("%L1 of the voxels, N %2").arg(cuts->show().samples).arg(snapshot.level);
}

} // namespace

QString fullName(const BakeView& view)
{
    if (view.isVoxels()) return voxelName(view.snapshot);
    const IrradianceGrid* grid = gridOf(view.snapshot);
    if (grid == nullptr) {
        return view.snapshot.isRough ? QObject::tr("Light octree, rough")
                                     : QObject::tr("Light octree, depth %1").arg(view.snapshot.level);
    }
    QString name = QObject::tr("Irradiance grid, %1").arg(cellsName(*grid));
    if (view.photonsPerLamp > 0) {
        const QString photons = QLocale().toString(static_cast<qulonglong>(view.photonsPerLamp));
        name = view.snapshot.isRough ? QObject::tr("%1, the first %2 photons a lamp").arg(name, photons)
                                     : QObject::tr("%1, %2 photons a lamp").arg(name, photons);
    }
    name = QObject::tr("%1, %2").arg(name, remapName(grid->show().remap));
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

namespace {

/// Voxels under this mix already: another field would begin pictures by lightcuts anew.
bool isUnder(const Mix& mix, const IndirectField& field)
{
    const auto* voxels = dynamic_cast<const VoxelField*>(&field);
    if (!voxels) return false;
    for (int g = 0; g < static_cast<int>(voxels->layers().size()); ++g)
        if (gainOf(voxels->mix(), g) != gainOf(mix, g)) return false;
    return true;
}

} // namespace

BakeView withLook(BakeView view, const Look& look)
{
    view.lookSerial = look.serial;
    if (!isUnder(look.mix, *view.snapshot.field)) view.snapshot.field = view.snapshot.field->withMix(look.mix);
    if (view.photons) view.photons = std::static_pointer_cast<const PhotonMapField>(view.photons->withMix(look.mix));
    view.gpu.reset();
    view.gpuGrid.reset();
    view.vertices.reset();
    view.discs.reset();
    view.gpuOfColours.reset();
    view.problem.clear();
    if (const auto octree = std::dynamic_pointer_cast<const LightOctree>(view.snapshot.field)) {
        addOctree(octree, view);
    } else if (const auto grid = std::dynamic_pointer_cast<const IrradianceGrid>(view.snapshot.field)) {
        addGrid(grid, look, view);
    } else if (const auto* voxels = dynamic_cast<const VoxelField*>(view.snapshot.field.get())) {
        addVoxels(*voxels, look, view);
    } else {
        view.problem = QStringLiteral("This viewport cannot show the method %1.")
                           .arg(QString::fromStdString(std::string(view.snapshot.field->method())));
    }
    view.noise = view.noisePoints ? statedNoise(*view.snapshot.field, *view.noisePoints) : std::nullopt;
    return view;
}

} // namespace lightloom
