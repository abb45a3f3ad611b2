// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/indirect_field.h"
#include "core/params/bake_params.h"
#include "core/photonmap/screens.h"
#include "core/trace/reference.h"
#include <span>
#include <vector>

namespace lightloom {

/// One orientation of the surface inside a leaf cell: what a VDL set is fitted to.
struct OctreeEntry {
    glm::vec3 centroid;     ///< of the surface inside the cell, scene space
    glm::vec3 normal;       ///< area-weighted mean, unit
    float area;             ///< m2
    std::uint32_t side = 0; ///< 16 bits: of a wall that parts the surface near it; 0: none. See entry_side.h
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
    /// Walls that entries do not gather across: entry e has [firstScreen[e], firstScreen[e+1]); empty: no entry has
    /// any. Wanted for fits alone.
    std::vector<std::uint32_t> firstScreen;
    std::vector<Screen> screens;
    [[nodiscard]] Screens screensOf(std::size_t entry) const
    {
        if (firstScreen.empty()) return {};
        return Screens(screens).subspan(firstScreen[entry], firstScreen[entry + 1] - firstScreen[entry]);
    }
    /// Appends an entry of another geometry, and its screens.
    void take(const OctreeGeometry& from, std::size_t entry);
    [[nodiscard]] float cellSize() const { return rootSize / static_cast<float>(1u << depth); }
    /// Leaf at integer cell coordinates, or -1. O(log leaves).
    [[nodiscard]] std::int64_t leafAt(glm::ivec3 cell) const;
    /// Whether a leaf lies in a cell of the depth above. O(log leaves).
    [[nodiscard]] bool splits(glm::ivec3 parent) const;
};

/// Virtual directional light: light from direction `toLight` that gives `colour` * max(0, n . toLight) lux on a surface
/// facing n (corrected form), or colour * brdf (paper form).
struct Vdl {
    glm::vec3 colour{0.0f};
    glm::vec3 toLight{0.0f, 1.0f, 0.0f}; ///< unit
};

/// VDLs of one light group at baked intensity: `count` per entry, unused ones black; or, where `first` is not empty, at
/// most `count`, entry e owning [first[e], first[e + 1]).
struct VdlLayer {
    int group = 0;
    int count = 1;
    float tolerance = 0.0f; ///< above 0: see spendVdls
    std::vector<std::uint32_t> first;
    std::vector<Vdl> vdls;
    std::vector<glm::vec3>
        scalar;               ///< per entry: the density estimate, lux on the entry's own surface, without directions
    float flat = 0.0f;        ///< share of `scalar` that an entry gives whatever the normal, besides its VDLs
    std::vector<float> noise; ///< per entry: standard error of the luminance of `scalar`, from the gather's own photons
    [[nodiscard]] std::span<const Vdl> of(std::size_t entry) const
    {
        if (!first.empty()) return std::span(vdls).subspan(first[entry], first[entry + 1] - first[entry]);
        const auto each = static_cast<std::size_t>(count);
        return std::span(vdls).subspan(entry * each, each);
    }
};

/// Deeper leaves of one light group: all children of the cells of the depth above that its photons call to be split,
/// and their light. What is split keeps its own light as well.
struct DetailLevel {
    std::shared_ptr<const OctreeGeometry> geometry;
    std::shared_ptr<const VdlLayer> layer;
};
/// One below the other, the first below the octree's own depth. Empty: no cell is split.
using LampDetail = std::vector<DetailLevel>;

struct UnionLevel;
struct Answers;

/// The light octree (Vivanloc et al. 2007, corrected as in docs/methods): geometry, one layer per light group, and per
/// group the deeper leaves that its light calls for; a mix.
class LightOctree final : public IndirectField {
public:
    /// `details` by layer, or empty.
    LightOctree(std::shared_ptr<const OctreeGeometry> geometry, std::vector<std::shared_ptr<const VdlLayer>> layers,
                VdlForm form, Mix mix, OctreeShow show = OctreeShow::lights,
                std::vector<std::shared_ptr<const LampDetail>> details = {});

    /// 8-neighbour interpolation over entries compatible with `n` (n . n_j >= 0.3), renormalised by those that exist.
    /// At each deeper level in turn, where cells are split: children answer for their share, and what the level above
    /// gives at `p` for the share of cells that are not split, so that there is no seam between depths.
    /// A colour octree takes each entry's accumulated illuminance as it is: `n` picks entries and does nothing else.
    [[nodiscard]] bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override;
    /// As `lookup` blends. Lamps are independent; neighbouring entries share most photons, so their errors are taken
    /// as one, which overstates the noise where kernels are no wider than cells.
    [[nodiscard]] std::optional<float> noise(glm::vec3 p, glm::vec3 n) const override;
    [[nodiscard]] std::shared_ptr<const IndirectField> withMix(Mix mix) const override;
    [[nodiscard]] std::string_view method() const override { return "light-octree"; }
    [[nodiscard]] std::size_t memoryBytes() const override;

    [[nodiscard]] const OctreeGeometry& geometry() const { return *geometry_; }
    [[nodiscard]] const std::shared_ptr<const OctreeGeometry>& geometryShared() const { return geometry_; }
    [[nodiscard]] const std::vector<std::shared_ptr<const VdlLayer>>& layers() const { return layers_; }
    /// By layer; an empty one where none of the lamp's cells is split.
    [[nodiscard]] const LampDetail& detail(std::size_t layer) const;
    [[nodiscard]] const std::vector<std::shared_ptr<const LampDetail>>& details() const { return details_; }
    /// All lamps' deeper leaves, level by level; empty where no cell is split.
    [[nodiscard]] const std::vector<UnionLevel>& deeper() const { return *deeper_; }
    [[nodiscard]] VdlForm form() const { return form_; }
    [[nodiscard]] const Mix& mix() const { return mix_; }
    [[nodiscard]] OctreeShow show() const { return show_; }
    /// The same layers and mix, shown otherwise.
    [[nodiscard]] std::shared_ptr<const LightOctree> showing(OctreeShow show) const;
    /// The same with at most the first `levels` of deeper leaves.
    [[nodiscard]] std::shared_ptr<const LightOctree> withDetail(std::size_t levels) const;
    /// An entry of the geometry (level 0), or of deeper()[level - 1].
    struct At {
        std::size_t entry = 0, level = 0;
    };
    [[nodiscard]] const OctreeEntry& surface(At at) const;
    /// Accumulated illuminance (lux) of an entry under the mix, without directions. Lamps whose light does not call for
    /// a leaf as deep give what they have there, interpolated.
    [[nodiscard]] glm::vec3 mixedColour(At at) const;
    /// Share of each entry's accumulated illuminance that counts beside its VDLs, the same in all layers; 0 but for
    /// voxels.
    [[nodiscard]] float flatShare() const;
    /// VDLs of an entry under the mix, all layers' united and merged to at most `most`, vector sums kept: `most`,
    /// unused ones black, or as many as the layers' tolerance asks for.
    [[nodiscard]] std::vector<Vdl> mixed(At at, int most) const;

private:
    /// Deeper leaves of all lamps are united once and shared by all mixes.
    LightOctree(const LightOctree& other, Mix mix, OctreeShow show);
    [[nodiscard]] glm::vec3 valueOf(const VdlLayer& layer, std::size_t entry, glm::vec3 n) const;
    template<class ValueOf>
    [[nodiscard]] auto blended(std::size_t layer, glm::vec3 p, glm::vec3 n, const Answers& coarse,
                               const ValueOf& valueOf) const;
    /// Number of an entry in the layer's own level; -1: the lamp has no leaf there.
    [[nodiscard]] std::int64_t ownEntry(std::size_t layer, At at) const;
    [[nodiscard]] std::vector<Vdl> lightsOf(std::size_t layer, At at) const;

    std::shared_ptr<const OctreeGeometry> geometry_;
    std::vector<std::shared_ptr<const VdlLayer>> layers_;
    VdlForm form_;
    Mix mix_;
    OctreeShow show_;
    std::vector<std::shared_ptr<const LampDetail>> details_;
    std::shared_ptr<const std::vector<UnionLevel>> deeper_;
};

/// The leaves that lookups at the points read, with all their entries: a field over these answers there as one over the
/// whole octree does, to the bit.
[[nodiscard]] OctreeGeometry leavesRead(const OctreeGeometry& geometry, std::span<const ProbePoint> points);

inline constexpr float kCompatibleCosine = 0.3f; ///< entries whose normal is further off do not answer

} // namespace lightloom
