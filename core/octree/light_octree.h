// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/indirect_field.h"
#include "core/params/bake_params.h"
#include "core/trace/reference.h"
#include <span>
#include <vector>

namespace lightloom {

/// One orientation of the surface inside a leaf cell: what a VDL set is fitted to.
struct OctreeEntry {
    glm::vec3 centroid; ///< of the surface inside the cell, scene space
    glm::vec3 normal;   ///< area-weighted mean, unit
    float area;         ///< m2
};

/// Leaves of a geometric octree of one depth: cells that a triangle really crosses, each with one entry per
/// orientation. Leaf `i` owns entries [firstEntry[i], firstEntry[i+1]). `cells` is sorted.
struct OctreeGeometry {
    int depth = 0;
    glm::vec3 lowest{0.0f}; ///< corner of the root cell
    float rootSize = 1.0f;
    std::vector<std::uint64_t> cells; ///< Morton code of the cell, rising
    std::vector<std::uint32_t> firstEntry;
    std::vector<OctreeEntry> entries;
    [[nodiscard]] float cellSize() const { return rootSize / static_cast<float>(1u << depth); }
    /// Leaf at integer cell coordinates, or -1. O(log leaves).
    [[nodiscard]] std::int64_t leafAt(glm::ivec3 cell) const;
};

/// Virtual directional light: light from direction `toLight` that gives `colour` * max(0, n . toLight) lux on a surface
/// facing n (corrected form), or colour * brdf (paper form).
struct Vdl {
    glm::vec3 colour{0.0f};
    glm::vec3 toLight{0.0f, 1.0f, 0.0f}; ///< unit
};

/// VDLs of one light group at baked intensity: `count` per entry, entry e owns [e * count, (e + 1) * count); unused
/// ones are black.
struct VdlLayer {
    int group = 0;
    int count = 1;
    std::vector<Vdl> vdls;
    std::vector<glm::vec3>
        scalar;               ///< per entry: the density estimate, lux on the entry's own surface, without directions
    std::vector<float> noise; ///< per entry: standard error of the luminance of `scalar`, from the gather's own photons
};

/// The light octree (Vivanloc et al. 2007, corrected as in docs/methods): geometry, one layer per light group, a mix.
class LightOctree final : public IndirectField {
public:
    LightOctree(std::shared_ptr<const OctreeGeometry> geometry, std::vector<std::shared_ptr<const VdlLayer>> layers,
                VdlForm form, Mix mix, OctreeShow show = OctreeShow::lights);

    /// 8-neighbour interpolation over entries compatible with `n` (n . n_j >= 0.3), renormalised by those that exist.
    /// A colour octree takes each entry's accumulated illuminance as it is: `n` picks entries and does nothing else.
    [[nodiscard]] bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override;
    /// As `lookup` blends. Lamps are independent; neighbouring entries share most photons, so their errors are taken
    /// as one, which overstates the noise where kernels are no wider than cells.
    [[nodiscard]] std::optional<float> noise(glm::vec3 p, glm::vec3 n) const override;
    [[nodiscard]] std::shared_ptr<const IndirectField> withMix(Mix mix) const override;
    [[nodiscard]] std::string_view method() const override { return "light-octree"; }
    [[nodiscard]] std::size_t memoryBytes() const override;

    [[nodiscard]] const OctreeGeometry& geometry() const { return *geometry_; }
    [[nodiscard]] const std::vector<std::shared_ptr<const VdlLayer>>& layers() const { return layers_; }
    [[nodiscard]] VdlForm form() const { return form_; }
    [[nodiscard]] const Mix& mix() const { return mix_; }
    [[nodiscard]] OctreeShow show() const { return show_; }
    /// The same layers and mix, shown otherwise.
    [[nodiscard]] std::shared_ptr<const LightOctree> showing(OctreeShow show) const;
    /// Accumulated illuminance (lux) of entry `e` under the mix, without directions.
    [[nodiscard]] glm::vec3 mixedColour(std::size_t e) const;
    /// VDLs of entry `e` under the mix, all layers' united and merged to at most `most`, vector sums kept.
    [[nodiscard]] std::vector<Vdl> mixed(std::uint32_t e, int most) const;

private:
    [[nodiscard]] float noiseOf(std::size_t entry) const;
    [[nodiscard]] glm::vec3 illuminanceOf(std::size_t entry, glm::vec3 n) const;

    std::shared_ptr<const OctreeGeometry> geometry_;
    std::vector<std::shared_ptr<const VdlLayer>> layers_;
    VdlForm form_;
    Mix mix_;
    OctreeShow show_;
};

/// The leaves that lookups at the points read, with all their entries: a field over these answers there as one over the
/// whole octree does, to the bit.
[[nodiscard]] OctreeGeometry leavesRead(const OctreeGeometry& geometry, std::span<const ProbePoint> points);

inline constexpr float kCompatibleCosine = 0.3f; ///< entries whose normal is further off do not answer

} // namespace lightloom
