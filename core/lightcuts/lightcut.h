// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/lightcuts/light_samples.h"
#include "core/lightcuts/near_field.h"

namespace lightloom {

struct LightcutParams {
    /// Share of a place's illuminance that each cluster may be off by at most; in cuts of more than 400 it is less, by
    /// the root of their number, as their errors add up, and less where a shadow's edge falls. A place's light is off
    /// by .6 to 1.4 times the threshold, RMS. 0: every light alone.
    float threshold = 0.02f;
    int mostNodes = 2000; ///< clusters in a cut, and lights; 0: any number
    int nearRays = 64;
    std::uint64_t seed = 1; ///< of the near rays
    bool operator==(const LightcutParams&) const = default;
};

/// What the light at one place was made from.
struct Lightcut {
    glm::vec3 illuminance{0.0f}; ///< lux
    glm::vec3 fromLamps{0.0f};   ///< lux, the part of it that comes from the tree of lamps
    int nodes = 0;               ///< clusters and lights in the cut
    int shadowRays = 0;
    float largestBound = 0.0f; ///< lux of luminance: no cluster of the cut is off by more
    float bound = 0.0f;        ///< the same for all of them together: true light of the discs is within
};

/// The last step of method `voxel-lightcuts` (the 2009 paper, section 4.2, after Walter et al. 2005): illuminance from
/// many thousands of discs by a cut through their tree, refined where the error may be largest until that is within a
/// share of the sum. Discs stand badly for surface nearer than about two voxels: there short rays look instead. Made
/// once per mix, cheap to make; any number of threads may ask. Results depend on the place, its number and the
/// parameters alone.
class Lightcuts {
public:
    /// `surface`: discs of lit voxels. `near`: what rays meet within `nearRange()`; null: discs alone. `lamps`: discs
    /// of lamps; a cut then goes through both trees, joined at a root (direct and indirect light in one; lamps are
    /// never left to rays); null: indirect light only.
    explicit Lightcuts(std::shared_ptr<const RayScene> rays, std::shared_ptr<const LightTree> surface,
                       std::shared_ptr<const NearField> near = {}, std::shared_ptr<const LightTree> lamps = {});

    /// Light that falls on a surface at `p` (on it, not moved off) that faces `n` (unit). `number` of the place: of a
    /// pixel or probe; near rays are drawn by it. Where `seen` is given the light's parts are appended, whose lux add
    /// up to the illuminance: a glossy surface weighs each by its lobe. About .1 ms at 2 %.
    [[nodiscard]] Lightcut at(glm::vec3 p, glm::vec3 n, std::uint64_t number, const LightcutParams& params,
                              std::vector<CutLight>* seen = nullptr) const;
    /// The same from every light one by one, `params.nearRays` included: what `at` comes to at threshold 0.
    [[nodiscard]] glm::vec3 everyLight(glm::vec3 p, glm::vec3 n, std::uint64_t number,
                                       const LightcutParams& params) const;

    /// The same from lights drawn at random, `samples` from `first` to before `last` of those drawn from the surface's
    /// tree (instant radiosity; the 2009 paper, section 4.1, with the factors its sum lacks): right in the mean. All
    /// places share the draws, so that errors are blotches and shadows' steps, not noise. Parts of equal length may be
    /// averaged: a picture that gets better. Lamps are left out.
    [[nodiscard]] glm::vec3 fromSamples(glm::vec3 p, glm::vec3 n, std::uint64_t number, const LightcutParams& params,
                                        const LightSamples& samples, std::size_t first, std::size_t last) const;

    [[nodiscard]] const NearRange& nearRange() const { return near_; } ///< empty without a near field
    /// Where a shadow ray to a light of `tree` ends: half a cell before it, or it would meet the surface beside. Before
    /// a place within the middle half of the voxel's surface, drawn once for all receivers: voxels stand in rows, and
    /// an edge along one would hide the middles of all of them at once.
    [[nodiscard]] glm::vec3 endOfRay(const LightTree& tree, const DiscLight& light) const;

private:
    friend class CutWalk;
    [[nodiscard]] glm::vec3 nearLight(const Receiver& at, std::uint64_t number, const LightcutParams& params,
                                      std::vector<CutLight>* seen = nullptr) const;
    [[nodiscard]] float visibleTransfer(const LightTree& tree, const Receiver& at, const DiscLight& light) const;
    std::shared_ptr<const RayScene> rays_;
    std::shared_ptr<const LightTree> surface_, lamps_;
    std::shared_ptr<const NearField> field_;
    NearRange near_;
};

} // namespace lightloom
