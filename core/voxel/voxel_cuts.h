// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/lightcuts/lightcut.h"
#include "core/trace/light_sampler.h"
#include "core/voxel/voxel_field.h"

namespace lightloom {

/// How voxel radiosity is looked up: no bake is needed to change it.
struct VoxelShow {
    VoxelLookup lookup = VoxelLookup::lightcuts;
    LightcutParams cuts;
    int samples = 256; ///< voxels drawn at random
    int lamps = 0;     ///< discs of each glowing surface in `joinedAt`; 0: none
    bool operator==(const VoxelShow&) const = default;
};
[[nodiscard]] VoxelShow voxelShow(const BakeParams& params);

/// A voxel field whose light is gathered anew at each place: by a lightcut, or from voxels drawn at random (the 2009
/// paper, sections 4.1 and 4.2). Some .1 ms a lookup. The same bits wherever and whenever it is asked.
class VoxelCuts final : public IndirectField {
public:
    /// `lights` of the scene that was baked; `show.lookup` is not `field`.
    VoxelCuts(std::shared_ptr<const VoxelField> field, std::shared_ptr<const LightSampler> lights, VoxelShow show);

    /// Answers everywhere, in mid-air too.
    [[nodiscard]] bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override;
    [[nodiscard]] std::shared_ptr<const IndirectField> withMix(Mix mix) const override;
    [[nodiscard]] std::string_view method() const override { return field_->method(); }
    [[nodiscard]] std::size_t memoryBytes() const override;
    [[nodiscard]] bool isCostly() const override { return true; }
    [[nodiscard]] bool lookupQuick(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override
    {
        return field_->lookup(p, n, lux);
    }

    /// The cut at a place, whatever `show` says, and the lamps' light that comes there by mirrors and glass: that of
    /// the voxels around.
    [[nodiscard]] Lightcut cutAt(glm::vec3 p, glm::vec3 n) const;
    /// The same from all voxels one by one, that come along (lux): what cuts are to come near to. A shadow ray for each
    /// that may be in view; 20 ms for 10,000.
    [[nodiscard]] glm::vec3 everyLightAt(glm::vec3 p, glm::vec3 n) const;
    /// The light's parts there by direction, for a surface that weighs them by a lobe: each within `share` of the
    /// threshold. What comes by mirrors and glass has no direction and is left out.
    [[nodiscard]] std::vector<CutLight> lightsAt(glm::vec3 p, glm::vec3 n, float share) const;
    /// A cut through the trees of voxels and of glowing surfaces, joined at a root: all light but that straight from
    /// point, spot and directional lights, each cluster within a share of it all. Where `show` has lamps.
    [[nodiscard]] Lightcut joinedAt(glm::vec3 p, glm::vec3 n) const;
    [[nodiscard]] const VoxelField& field() const { return *field_; }
    [[nodiscard]] const VoxelShow& show() const { return show_; }

private:
    VoxelCuts(const VoxelCuts& other, std::shared_ptr<const VoxelField> field);
    void light();
    [[nodiscard]] glm::vec3 specularAt(glm::vec3 p, glm::vec3 n) const;

    std::shared_ptr<const VoxelField> field_;
    std::shared_ptr<const LightSampler> lights_;
    VoxelShow show_;
    std::shared_ptr<const LightTree> tree_; ///< of all entries, under the field's mix
    std::unique_ptr<const Lightcuts> cuts_, joined_;
    std::unique_ptr<const LightSamples> samples_;
    std::unique_ptr<const LightOctree> specular_; ///< null: no lamp's light comes by mirrors or glass
};

} // namespace lightloom
