// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/atlas/flat_check.h"
#include "core/atlas/texels.h"
#include "core/base/parallel.h"
#include "core/base/result.h"
#include "core/trace/light_reach.h"
#include <functional>

namespace lightloom {

struct AtlasOptions {
    int size = 1024;             ///< texels a side, a multiple of 4 from kLeastAtlas to kMostAtlas
    double texelsPerMetre = 0.0; ///< over 0: the least power of two a side that holds so many, instead of `size`
    bool useSceneUv = false;     ///< the scene's own second UV set instead of new charts; `size` counts
};
/// Sizes and densities out of range.
[[nodiscard]] Result<Done> checkAtlasOptions(const AtlasOptions& options);
inline constexpr int kLeastAtlas = 16, kMostAtlas = 4096;

/// What an atlas is like.
struct AtlasReport {
    std::uint64_t charts = 0, faces = 0; ///< faces: sides of triangles that have a place
    std::uint64_t unlitFaces = 0;        ///< that are drawn but that light never reaches: they have none
    std::uint64_t sharedFaces = 0;       ///< backs that have no place of their own in the scene's own UV set
    Stretch stretch;                     ///< of all charts
    double texelsPerMetre = 0.0;
    double utilisation = 0.0;            ///< share of the texels whose centre lies on a face
    std::uint64_t overlappingTexels = 0; ///< whose centre lies inside two faces
    double chartMs = 0.0, packMs = 0.0, texelMs = 0.0;
};

/// A square picture in which every face that light reaches and that is drawn has a place of its own: fronts, and the
/// backs of double-sided materials apart from them. Faces that light never reaches share a black corner. Never changes
/// once made; any thread may read it.
struct Atlas {
    int size = 0;                             ///< texels a side
    std::vector<std::uint32_t> sides;         ///< that have a place: 2 * triangle, + 1 for its back; rising
    std::vector<std::array<glm::vec2, 3>> uv; ///< per side: of the triangle's a, b, c; in [0,1], (0,0) at the top left
    glm::vec2 voidUv{0.0f};                   ///< in the middle of the black corner
    std::vector<std::int32_t> owners;         ///< per texel: its chart, padding included; -1: none
    std::vector<SurfaceTexel> texels;         ///< that show surface: chart by chart
    AtlasReport report;

    /// Place of a side in `uv`; nothing if it has none. O(log n).
    [[nodiscard]] std::optional<std::size_t> find(std::uint32_t side) const;
    [[nodiscard]] std::size_t texelCount() const
    {
        return static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
    }
};

/// Unwraps the scene: charts (charts.h), packing (chart_pack.h), texels. The same atlas on any number of threads.
/// `progress` from 0 to 1, on any worker. Errors: charts that do not fit, a second UV set that is missing, leaves 0..1
/// or overlaps (first place named); cancelled.
[[nodiscard]] Result<std::shared_ptr<const Atlas>> makeAtlas(const RayScene& rays, const LightReach& reach,
                                                             const AtlasOptions& options, Workers& workers,
                                                             const std::stop_token& stop,
                                                             const std::function<void(double)>& progress = {});

/// Sides that get a place (rising), and how many are drawn without light.
struct AtlasSides {
    std::vector<std::uint32_t> lit;
    std::uint64_t unlit = 0;
};
[[nodiscard]] AtlasSides atlasSides(const RayScene& rays, const LightReach& reach);

} // namespace lightloom
