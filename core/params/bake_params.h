// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/params/grid_choices.h"
#include "core/params/voxel_choices.h"
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>

namespace lightloom {

enum class Method { lightOctree, irradianceGrid, voxelLightcuts, photonMap, direct, reference };

/// Kernel of the octree's photon gather.
enum class GatherKernel { sphere, ellipsoid };
/// What photons' flux is divided by: the surface really under the kernel, or the disc of the kernel's radius, as the
/// 2007 paper prints it.
enum class GatherArea { surface, disc };
/// What is fitted to the photons under a kernel: a constant (their mean density), or a plane (its value at the point).
enum class GatherFit { plane, mean };
/// A thing that can be left out.
enum class Switch { off, on };
/// How photons become virtual directional lights: as printed in the 2007 paper, or corrected (docs/methods).
enum class VdlForm { corrected, paper };
/// What a light octree shows of its entries: virtual lights, or their sum without directions (the paper's comparison).
enum class OctreeShow { lights, colour };
/// Which numbers an octree is looked up in: the bake's own, or the packed ones that pixels are drawn from.
enum class OctreeValues { exact, packed };
/// How a photon map answers: density estimation on the spot, or Christensen's cache.
enum class PhotonLookup { direct, christensen };

/// Everything a bake depends on besides the scene and its lamps. Same scene, parameters and build: same bytes.
/// Meaning, unit, range and cost of each member stand in `kParams`.
struct BakeParams {
    std::uint64_t seed = 1;
    int photonCount = 400'000;
    int pathDepth = 1024;
    int gatherCount = 500;
    float gatherRadius = 0.0f;
    GatherKernel gatherKernel = GatherKernel::sphere;
    GatherArea gatherArea = GatherArea::surface;
    GatherFit gatherFit = GatherFit::plane;
    Switch gatherAdapt = Switch::on;
    Switch gatherFilter = Switch::on;
    Switch gatherScreens = Switch::on;
    int octreeDepth = 6;
    int octreeFirstDepth = 4;
    int octreeDetail = 2;
    float gridShift = 0.0f;
    int gridSize = 32;
    int gridSizeX = 0;
    int gridSizeY = 0;
    int gridSizeZ = 0;
    GridEstimator gridEstimator = GridEstimator::crossings;
    Switch gridFit = Switch::on;
    Switch gridSmooth = Switch::on;
    GridRemap gridRemap = GridRemap::joined;
    GridFilter gridFilter = GridFilter::trilinear;
    float gridOffset = 0.5f;
    float gridNoise = 0.0f;
    int gridPathMemory = 512;
    GridNest gridNest = GridNest::off;
    int gridNestFine = 2;
    float gridNestLowX = 0.0f, gridNestLowY = 0.0f, gridNestLowZ = 0.0f;
    float gridNestHighX = 0.0f, gridNestHighY = 0.0f, gridNestHighZ = 0.0f;
    int voxelSize = 64;
    int voxelSamples = 4;
    int voxelDirections = 512;
    VoxelLines voxelLines = VoxelLines::covered;
    float voxelGain = 0.005f;
    VoxelBounces voxelBounces = VoxelBounces::halving;
    VoxelSmooth voxelSmooth = VoxelSmooth::bounced;
    float voxelSlivers = 0.05f;
    int voxelPhotons = 400'000;
    int voxelPartnerMemory = 512;
    int voxelRays = 32;
    VoxelLookup voxelLookup = VoxelLookup::lightcuts;
    float voxelThreshold = 0.02f;
    int voxelCut = 2000;
    int voxelNear = 64;
    int voxelLights = 256;
    int voxelLamps = 0;
    int vdlCount = 4;
    float vdlTolerance = 0.0f;
    VdlForm vdlForm = VdlForm::corrected;
    OctreeShow octreeShow = OctreeShow::lights;
    OctreeValues octreeValues = OctreeValues::exact;
    PhotonLookup photonLookup = PhotonLookup::direct;
    int directSamples = 64;
    int probeRays = 256;
    int referenceSamples = 1024;
    float referenceStderr = 0.0f;
    int pixelSamples = 16;
    bool operator==(const BakeParams&) const = default;
};

/// Stages of a bake in order. A parameter names the earliest one it changes; all before it are kept.
enum class Stage { shoot, build, fit, show };

/// Bits of `ParamSpec::methods`.
enum MethodBit : unsigned {
    kForOctree = 1u << static_cast<unsigned>(Method::lightOctree),
    kForGrid = 1u << static_cast<unsigned>(Method::irradianceGrid),
    kForVoxels = 1u << static_cast<unsigned>(Method::voxelLightcuts),
    kForPhotonMap = 1u << static_cast<unsigned>(Method::photonMap),
    kForDirect = 1u << static_cast<unsigned>(Method::direct),
    kForReference = 1u << static_cast<unsigned>(Method::reference),
    kForGathers = kForOctree | kForPhotonMap,
    kForPhotons = kForGathers | kForGrid,
    kForLattices = kForOctree | kForGrid | kForVoxels,
    kForBakes = kForPhotons | kForVoxels,
    kForAll = kForBakes | kForDirect | kForReference
};

/// One parameter: the only description of it. Command line, panels, files and the manual loop over `kParams`.
struct ParamSpec {
    using Field =
        std::variant<int BakeParams::*, float BakeParams::*, std::uint64_t BakeParams::*, GatherKernel BakeParams::*,
                     GatherArea BakeParams::*, GatherFit BakeParams::*, Switch BakeParams::*, VdlForm BakeParams::*,
                     OctreeShow BakeParams::*, OctreeValues BakeParams::*, PhotonLookup BakeParams::*,
                     GridEstimator BakeParams::*, GridRemap BakeParams::*, GridFilter BakeParams::*,
                     GridNest BakeParams::*, VoxelLookup BakeParams::*, VoxelLines BakeParams::*,
                     VoxelBounces BakeParams::*, VoxelSmooth BakeParams::*>;
    std::string_view key;   ///< for ever: files hold it
    std::string_view label; ///< in the window
    std::string_view unit;  ///< "" for a pure number
    double least, most;     ///< inclusive; what the method survives, not what is wise
    double step;            ///< of a spin box
    unsigned methods;       ///< `MethodBit`s that read it
    Stage redo;             ///< earliest stage that a change of the value makes run again
    Field field;
    std::span<const std::string_view> choices; ///< names of an enum's values in order; empty for numbers
    std::string_view help;                     ///< what grows, what it costs
    [[nodiscard]] constexpr bool isChoice() const { return !choices.empty(); }
};

inline constexpr std::array<std::string_view, 2> kKernelNames{"sphere", "ellipsoid"};
inline constexpr std::array<std::string_view, 2> kAreaNames{"surface", "disc"};
inline constexpr std::array<std::string_view, 2> kFitNames{"plane", "mean"};
inline constexpr std::array<std::string_view, 2> kSwitchNames{"off", "on"};
inline constexpr std::array<std::string_view, 2> kVdlFormNames{"corrected", "paper"};
inline constexpr std::array<std::string_view, 2> kOctreeShowNames{"lights", "colour"};
inline constexpr std::array<std::string_view, 2> kOctreeValuesNames{"exact", "packed"};
inline constexpr std::array<std::string_view, 2> kPhotonLookupNames{"direct", "christensen"};

// clang-format off
inline constexpr std::array kParams{
    ParamSpec{"seed", "Seed", "", 0, 9007199254740992.0, 1, kForAll, Stage::shoot, &BakeParams::seed, {},
              "Another seed gives an independent result of the same quality; the difference of two shows the noise."},
    ParamSpec{"photons", "Photons per light group", "", 0, 1e9, 50'000, kForPhotons, Stage::shoot, &BakeParams::photonCount, {},
              "Noise falls with the square root; tracing time and memory grow in step. Each light group gets this many."},
    ParamSpec{"path.depth", "Longest path", "bounces", 1, 100'000, 1, kForPhotons | kForReference, Stage::shoot, &BakeParams::pathDepth, {},
              "Safety net behind Russian roulette; paths that reach it are counted and their light is missing."},
    ParamSpec{"octree.depth", "Octree depth", "levels", 1, 10, 1, kForOctree, Stage::build, &BakeParams::octreeDepth, {},
              "Cells are the longest side / 2^depth. Finer cells show more detail; time and memory grow fourfold a level."},
    ParamSpec{"octree.first-depth", "First depth shown", "levels", 1, 10, 1, kForOctree, Stage::build, &BakeParams::octreeFirstDepth, {},
              "The coarsest octree, shown while finer ones are made. Does not change the final result."},
    ParamSpec{"octree.detail", "Deeper leaves", "levels", 0, 3, 1, kForOctree, Stage::fit, &BakeParams::octreeDetail, {},
              "Most levels that leaves split below the octree depth where photons show light that they blur, such as caustics."},
    ParamSpec{"grid.shift", "Lattice shift", "cells", 0, 0.999, 0.25, kForLattices, Stage::build, &BakeParams::gridShift, {},
              "Moves the lattice by part of a cell along all axes; accuracy is stated as the worst of 0 .25 .5 .75."},
    ParamSpec{"grid.size", "Grid size (N)", "cells", 0, 512, 8, kForGrid, Stage::build, &BakeParams::gridSize, {},
              "Cells along the longest side; cells are cubes. Finer: smaller shadows, more noise, memory by the cube. 0: by how far walls lie apart."},
    ParamSpec{"grid.size.x", "Cells along x", "cells", 0, 512, 1, kForGrid, Stage::build, &BakeParams::gridSizeX, {},
              "Above 0: as many along x, so that cells need not be cubes. 0: by the grid's size."},
    ParamSpec{"grid.size.y", "Cells along y", "cells", 0, 512, 1, kForGrid, Stage::build, &BakeParams::gridSizeY, {},
              "Above 0: as many along y, so that cells need not be cubes. 0: by the grid's size."},
    ParamSpec{"grid.size.z", "Cells along z", "cells", 0, 512, 1, kForGrid, Stage::build, &BakeParams::gridSizeZ, {},
              "Above 0: as many along z, so that cells need not be cubes. 0: by the grid's size."},
    ParamSpec{"grid.estimator", "Grid estimator", "", 0, 2, 1, kForGrid, Stage::fit, &BakeParams::gridEstimator, kGridEstimatorNames,
              "crossings: photons through cell faces, by area and cosine. tracks: ways through cells. paper: as printed, a third too dark; for comparison."},
    ParamSpec{"grid.fit", "Fit to surfaces", "", 0, 1, 1, kForGrid, Stage::fit, &BakeParams::gridFit, kSwitchNames,
              "Corrects vertices by the photons that land on the surface beside them. Off: by those that pass through the air alone, as printed."},
    ParamSpec{"grid.smooth", "Smooth noise", "", 0, 1, 1, kForGrid, Stage::fit, &BakeParams::gridSmooth, kSwitchNames,
              "Draws vertices towards their neighbours where the difference is no more than their noise. Off: blotchier, every vertex by itself."},
    ParamSpec{"grid.noise", "Wanted noise", "fraction", 0, 1, 0.005, kForGrid, Stage::shoot, &BakeParams::gridNoise, {},
              "Above 0: as many photons as bring the noise to this share of the mean light, instead of a number. 0: the number counts."},
    ParamSpec{"grid.paths", "Photon ways kept", "MiB", 0, 1'000'000, 128, kForGrid, Stage::show, &BakeParams::gridPathMemory, {},
              "Memory for photons' ways, so that another grid of the same scene is filled without tracing. Does not change results."},
    ParamSpec{"grid.nest", "Finer grid inside", "", 0, 2, 1, kForGrid, Stage::build, &BakeParams::gridNest, kGridNestNames,
              "A second, finer grid within the first. off: none. auto: where light changes most within cells. box: in grid.nest.low to grid.nest.high."},
    ParamSpec{"grid.nest.fine", "Cells inside a cell", "per axis", 2, 8, 1, kForGrid, Stage::build, &BakeParams::gridNestFine, {},
              "How many cells of the finer grid lie along one of the outer grid's. Memory and depositing grow with the cube."},
    ParamSpec{"grid.nest.low.x", "Box from x", "m", -1e6, 1e6, 0.1, kForGrid, Stage::build, &BakeParams::gridNestLowX, {},
              "Low corner of the finer grid's box, in the scene file's frame, where grid.nest is box."},
    ParamSpec{"grid.nest.low.y", "Box from y", "m", -1e6, 1e6, 0.1, kForGrid, Stage::build, &BakeParams::gridNestLowY, {},
              "Low corner of the finer grid's box, in the scene file's frame, where grid.nest is box."},
    ParamSpec{"grid.nest.low.z", "Box from z", "m", -1e6, 1e6, 0.1, kForGrid, Stage::build, &BakeParams::gridNestLowZ, {},
              "Low corner of the finer grid's box, in the scene file's frame, where grid.nest is box."},
    ParamSpec{"grid.nest.high.x", "Box to x", "m", -1e6, 1e6, 0.1, kForGrid, Stage::build, &BakeParams::gridNestHighX, {},
              "High corner of the finer grid's box, in the scene file's frame, where grid.nest is box."},
    ParamSpec{"grid.nest.high.y", "Box to y", "m", -1e6, 1e6, 0.1, kForGrid, Stage::build, &BakeParams::gridNestHighY, {},
              "High corner of the finer grid's box, in the scene file's frame, where grid.nest is box."},
    ParamSpec{"grid.nest.high.z", "Box to z", "m", -1e6, 1e6, 0.1, kForGrid, Stage::build, &BakeParams::gridNestHighZ, {},
              "High corner of the finer grid's box, in the scene file's frame, where grid.nest is box."},
    ParamSpec{"grid.remap", "Grid remap", "", 0, 3, 1, kForGrid, Stage::show, &BakeParams::gridRemap, kGridRemapNames,
              "How light falls on tilted surfaces. joined: six axes, harmonics between. harmonic: these alone. flux: axes alone. paper: as printed, too dark."},
    ParamSpec{"grid.filter", "Grid filter", "", 0, 2, 1, kForGrid, Stage::show, &BakeParams::gridFilter, kGridFilterNames,
              "Between vertices. trilinear: fast, keeps walls apart. b-spline: smoothest. catmull-rom: smooth and sharper, may ring."},
    ParamSpec{"grid.offset", "Lookup offset", "cells", 0, 2, 0.1, kForGrid, Stage::show, &BakeParams::gridOffset, {},
              "How far along its normal a surface looks into the grid: more avoids vertices near walls, less keeps contact shadows."},
    ParamSpec{"voxel.size", "Voxels (N)", "voxels", 4, 1024, 16, kForVoxels, Stage::build, &BakeParams::voxelSize, {},
              "Voxels along the longest side; they are cubes. Finer: smaller shadows. Time and memory grow with the square."},
    ParamSpec{"voxel.samples", "Shadow rays per voxel", "", 1, 1024, 1, kForVoxels, Stage::fit, &BakeParams::voxelSamples, {},
              "Points on each voxel's surface from which each lamp is looked for. More: less noise in the light that goes on from there."},
    ParamSpec{"voxel.directions", "Directions", "", 1, 8192, 128, kForVoxels, Stage::fit, &BakeParams::voxelDirections, {},
              "Along which light is carried at the first bounce, each both ways; later bounces take half as many each. Time grows in step."},
    ParamSpec{"voxel.lines", "Lines", "", 0, 1, 1, kForVoxels, Stage::build, &BakeParams::voxelLines, kVoxelLinesNames,
              "covered: lines meet what surface covers of them, entries of several orientations a voxel. paper: one normal a voxel, chain rule alone."},
    ParamSpec{"voxel.gain", "Least gain of a bounce", "fraction", 0.0001, 1, 0.001, kForVoxels, Stage::fit, &BakeParams::voxelGain, {},
              "Light bounces on until one adds less than this share; what is still missing then is added as a series."},
    ParamSpec{"voxel.bounces", "Bounces", "", 0, 1, 1, kForVoxels, Stage::fit, &BakeParams::voxelBounces, kVoxelBouncesNames,
              "halving: each along half the directions of the one before. gauss-seidel: fewer, each from the newest light; wants all partners kept."},
    ParamSpec{"voxel.smooth", "Smooth over neighbours", "", 0, 3, 1, kForVoxels, Stage::fit, &BakeParams::voxelSmooth, kVoxelSmoothNames,
              "Averages light over neighbouring voxels that face alike. first: straight from lamps. bounced: all other light. Fainter bands, softer shadows."},
    ParamSpec{"voxel.slivers", "Slivers joined", "of a face", 0, 1, 0.01, kForVoxels, Stage::fit, &BakeParams::voxelSlivers, {},
              "Pieces of surface smaller than this share of a voxel's face get their light together with the largest neighbour that faces alike. 0: none."},
    ParamSpec{"voxel.photons", "Photons by mirrors, glass", "", 0, 1e9, 100'000, kForVoxels, Stage::fit, &BakeParams::voxelPhotons, {},
              "Per light group, for lamp light that comes by mirrors or through glass; none are shot where there are no such surfaces. 0: that light is missing."},
    ParamSpec{"voxel.rays", "Exact rays per voxel", "", 0, 4096, 16, kForVoxels, Stage::fit, &BakeParams::voxelRays, {},
              "Light of voxels as lights is carried along so many rays of each instead of lines: right in the mean where the scene is finer than voxels. 0: lines."},
    ParamSpec{"voxel.partners", "Partners kept", "MiB", 0, 1'000'000, 128, kForVoxels, Stage::show, &BakeParams::voxelPartnerMemory, {},
              "Memory for who sees whom, so that bounces and edits of lamps walk no line again. Does not change results."},
    ParamSpec{"voxel.lookup", "Voxel lookup", "", 0, 2, 1, kForVoxels, Stage::show, &BakeParams::voxelLookup, kVoxelLookupNames,
              "lightcuts: all voxels as lights, in a cut; finest, .1 ms a point. samples: some of them at random. field: the voxels around; at once."},
    ParamSpec{"voxel.threshold", "Cut threshold", "fraction", 0, 1, 0.005, kForVoxels, Stage::show, &BakeParams::voxelThreshold, {},
              "Share of a point's light that each cluster of voxels may be off by; the whole is off by about as much. Less: longer cuts."},
    ParamSpec{"voxel.cut", "Longest cut", "clusters", 0, 1'000'000, 100, kForVoxels, Stage::show, &BakeParams::voxelCut, {},
              "Most clusters in a cut; what is reached first counts. 0: any number."},
    ParamSpec{"voxel.near", "Near rays", "", 1, 4096, 16, kForVoxels, Stage::show, &BakeParams::voxelNear, {},
              "Short rays of each point for surface that is nearer than about two voxels. More: less noise in corners."},
    ParamSpec{"voxel.lights", "Sample voxels", "", 1, 1'000'000, 64, kForVoxels, Stage::show, &BakeParams::voxelLights, {},
              "Voxels drawn at random for voxel.lookup=samples, with a shadow ray of each point to each."},
    ParamSpec{"voxel.lamps", "Lamps in the cut", "discs", 0, 100'000, 64, kForVoxels, Stage::show, &BakeParams::voxelLamps, {},
              "Above 0: pictures take each glowing surface's own light as so many discs into the cut, instead of shadow rays to it alone. 0: apart."},
    ParamSpec{"gather.count", "Photons gathered (K)", "", 1, 100'000, 50, kForGathers, Stage::fit, &BakeParams::gatherCount, {},
              "More photons: less noise, more blur, longer gather."},
    ParamSpec{"gather.radius", "Largest gather radius", "leaf widths", 0, 64, 0.5, kForGathers, Stage::fit, &BakeParams::gatherRadius, {},
              "Cap on the gather kernel. 0: automatic, twice the radius that K photons fill where they lie evenly."},
    ParamSpec{"gather.kernel", "Gather kernel", "", 0, 1, 1, kForOctree, Stage::fit, &BakeParams::gatherKernel, kKernelNames,
              "Region photons are taken from: a sphere, or the paper's ellipsoid flattened along the leaf's normal."},
    ParamSpec{"gather.area", "Area divided by", "", 0, 1, 1, kForGathers, Stage::fit, &BakeParams::gatherArea, kAreaNames,
              "surface: what really lies under the kernel. disc: pi r^2 as printed in 2007, half too dark at edges; for comparison."},
    ParamSpec{"gather.fit", "Fit to the photons", "", 0, 1, 1, kForGathers, Stage::fit, &BakeParams::gatherFit, kFitNames,
              "plane: follows light that rises across the kernel, also at edges. mean: one value, as printed."},
    ParamSpec{"gather.adapt", "Adapt K", "", 0, 1, 1, kForGathers, Stage::fit, &BakeParams::gatherAdapt, kSwitchNames,
              "on: fewer photons than K where light changes within the kernel by more than its noise. off: K everywhere."},
    ParamSpec{"gather.filter", "Filter by normal", "", 0, 1, 1, kForGathers, Stage::fit, &BakeParams::gatherFilter, kSwitchNames,
              "on: only photons on surfaces within 60 degrees of the point's. off: all, which bleeds round corners."},
    ParamSpec{"gather.screens", "Stop at walls", "", 0, 1, 1, kForOctree, Stage::build, &BakeParams::gatherScreens, kSwitchNames,
              "on: leaves take no photons from behind a wall that stands on their surface. off: light leaks along floors, walls and ceilings."},
    ParamSpec{"photons.lookup", "Photon lookup", "", 0, 1, 1, kForPhotonMap, Stage::fit, &BakeParams::photonLookup, kPhotonLookupNames,
              "direct: density estimation at every point. christensen: kept at every 4th photon, the nearest answers; fast, in patches."},
    ParamSpec{"vdl.count", "Lights per leaf (k)", "", 1, 8, 1, kForOctree, Stage::fit, &BakeParams::vdlCount, {},
              "Virtual directional lights per leaf; each adds a texture read per pixel. Brightness does not depend on it."},
    ParamSpec{"vdl.tolerance", "Light tolerance", "fraction", 0, 1, 0.01, kForOctree, Stage::fit, &BakeParams::vdlTolerance, {},
              "Above 0: as few of the k lights as keep the leaf's light, on normals up to 72 degrees off, within this share. 0: k everywhere."},
    ParamSpec{"vdl.form", "Light form", "", 0, 1, 1, kForOctree, Stage::fit, &BakeParams::vdlForm, kVdlFormNames,
              "corrected: vector sum divided by the photon's cosine. paper: as printed in 2007, too dark; for comparison."},
    ParamSpec{"octree.show", "Shown of the octree", "", 0, 1, 1, kForOctree, Stage::show, &BakeParams::octreeShow, kOctreeShowNames,
              "lights: virtual lights, shaded by the receiver's normal. colour: their sum without directions; for comparison."},
    ParamSpec{"octree.values", "Numbers looked up", "", 0, 1, 1, kForOctree, Stage::show, &BakeParams::octreeValues, kOctreeValuesNames,
              "exact: as baked. packed: as the window's textures hold them, lamps merged, halves and 8-bit directions."},
    ParamSpec{"direct.samples", "Shadow rays per lamp", "", 1, 1'000'000, 16, kForAll, Stage::show, &BakeParams::directSamples, {},
              "Shadow rays to each emitting surface for exact direct light; softer noise in penumbrae, linear time."},
    ParamSpec{"probe.rays", "Gather rays in mid-air", "", 1, 1'000'000, 64, kForBakes, Stage::show, &BakeParams::probeRays, {},
              "Rays of the gather at points where a method keeps no answer of its own, such as a work plane."},
    ParamSpec{"reference.samples", "Reference paths", "per point", 1, 1e9, 256, kForReference, Stage::shoot, &BakeParams::referenceSamples, {},
              "Most paths per probe. The standard error falls with the square root."},
    ParamSpec{"reference.stderr", "Reference target error", "fraction", 0, 1, 0.005, kForReference, Stage::shoot, &BakeParams::referenceStderr, {},
              "Stop a probe once its standard error is below this fraction of the mean over all probes. 0: use all paths."},
    ParamSpec{"render.samples", "Samples per pixel", "", 1, 1'000'000, 4, kForAll, Stage::show, &BakeParams::pixelSamples, {},
              "Camera rays per pixel of a rendered picture; smooths edges and soft shadows."},
};
// clang-format on

} // namespace lightloom
