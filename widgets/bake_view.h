// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/bake/gpu_layout.h"
#include "core/ivg/grid_gpu.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/trace/light_reach.h"
#include "widgets/grid_vertices.h"
#include "widgets/voxel_discs.h"
#include <QMetaType>
#include <QStringList>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lightloom {

/// How a bake's light is looked at. No bake is needed to change it.
struct Look {
    Mix mix;
    GridShow grid; ///< of irradiance grids
    GridPacking packing = GridPacking::exact;
    VertexMarks vertices = VertexMarks::none;
    VoxelMarks voxels = VoxelMarks::none;
    std::uint64_t serial = 0; ///< the newest is what the window wants
};

/// A refinement of a bake, ready for the viewport: made on a worker, never changed afterwards, cheap to copy.
struct BakeView {
    Snapshot snapshot;                             ///< its field is as the look numbered `lookSerial` has it
    std::shared_ptr<const GpuOctree> gpu;          ///< also of voxels; null: neither, or its layout was refused, see
                                                   ///< `problem`
    std::shared_ptr<const GpuGrid> gpuGrid;        ///< likewise, of an irradiance grid
    std::shared_ptr<const IndirectField> colours;  ///< an octree as a colour octree
    std::shared_ptr<const GpuOctree> gpuOfColours; ///< the same for the viewport; as `gpu`
    std::shared_ptr<const GridVertices> vertices;  ///< of a grid, where the look asks for them
    std::shared_ptr<const VoxelDiscs> discs;       ///< likewise, of voxels
    QString problem;                               ///< why there is nothing to show; empty: there is
    std::shared_ptr<const PhotonMapField> photons; ///< that it was baked from, under the same mix; null: not known
    BakeParams params;                             ///< that it was baked with, and is looked at
    std::uint64_t lookSerial = 0;
    std::shared_ptr<const RayScene> rays;                         ///< of the same scene, for measuring direct light
    std::shared_ptr<const LightSampler> lights;                   ///< of the same scene
    std::shared_ptr<const LightReach> reach;                      ///< likewise
    std::shared_ptr<const std::vector<SurfacePoint>> noisePoints; ///< where noise is asked for; null: nowhere
    QStringList advice;               ///< what of the scene is too fine for voxels, a sentence each
    std::optional<double> noise;      ///< what the bake itself states, a fraction of the mean, under its mix
    std::uint64_t photonsPerLamp = 0; ///< of a grid, so far; 0: not known
    double cpuSeconds = 0; ///< of all threads, until this was published; what was kept counts as it cost then
    std::uint64_t leaves = 0, entries = 0; ///< of an octree, or of voxels

    [[nodiscard]] bool isGrid() const { return isBy("irradiance-grid"); }
    [[nodiscard]] bool isVoxels() const { return isBy("voxel-lightcuts"); }
    [[nodiscard]] bool isBy(std::string_view method) const
    {
        return snapshot.field && snapshot.field->method() == method;
    }
    [[nodiscard]] std::size_t textureBytes() const
    {
        return (gpu ? gpu->memoryBytes() : 0) + (gpuGrid ? gpuGrid->memoryBytes() : 0);
    }
};

/// Light under the cursor.
struct Measurement {
    bool isOnSurface = false;
    glm::vec3 position{0.0f};               ///< scene space
    double directLux = 0, indirectLux = -1; ///< luminance of the illuminance; negative: not known there
};

enum class GridText { full, brief }; ///< brief: of a finer grid inside no more than that there is one
/// "32 x 20 x 32 cells", "32 x 20 x 32 cells, 40 x 40 x 24 finer ones inside".
[[nodiscard]] QString gridSizeText(const Snapshot& snapshot, GridText how = GridText::full);
/// A refinement in a word or two, by what tells it from others: "rough", "d5"; of a grid its cells, photons a lamp and,
/// where it is not the usual one, its form: "N 32, 400k", "N 48 + 96, 2M, flux"; of voxels "N 64".
[[nodiscard]] QString shortName(const BakeView& view);
/// The same in words: "Light octree, depth 5", "Lightcuts, N 64", "Irradiance grid, N 32, 400,000 photons a lamp,
/// joined, tricubic".
[[nodiscard]] QString fullName(const BakeView& view);

/// `view` looked at in another way. Any thread; a few milliseconds to some hundred for the largest bakes.
[[nodiscard]] BakeView withLook(BakeView view, const Look& look);

} // namespace lightloom

Q_DECLARE_METATYPE(lightloom::BakeView)
Q_DECLARE_METATYPE(lightloom::Measurement)
