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

    /// The cut at a place, whatever `show` says.
    [[nodiscard]] Lightcut cutAt(glm::vec3 p, glm::vec3 n) const;
    [[nodiscard]] const VoxelField& field() const { return *field_; }
    [[nodiscard]] const VoxelShow& show() const { return show_; }

private:
    VoxelCuts(const VoxelCuts& other, std::shared_ptr<const VoxelField> field);
    void light();

    std::shared_ptr<const VoxelField> field_;
    std::shared_ptr<const LightSampler> lights_;
    VoxelShow show_;
    std::shared_ptr<const LightTree> tree_; ///< of all entries, under the field's mix
    std::unique_ptr<const Lightcuts> cuts_;
    std::unique_ptr<const LightSamples> samples_;
};

} // namespace lightloom
