// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/gpu_layout.h"

namespace lightloom {

/// Illuminance (lux) at `p` on a surface facing `n` (unit), from the arrays that pixels are drawn from and by the same
/// text (shaders/octree_walk.glsl). Nothing where no compatible entry is near.
[[nodiscard]] std::optional<glm::vec3> packedIlluminance(const GpuOctree& octree, glm::vec3 p, glm::vec3 n);

/// A light octree as the window shows it: all lamps' lights merged to k, colours as half floats, directions in 8 + 8
/// bits. For whoever wants to know what that changes; see docs/methods/light-octree.md.
class PackedOctree final : public IndirectField {
public:
    /// Errors: as makeGpuOctree.
    [[nodiscard]] static Result<std::shared_ptr<const PackedOctree>> make(std::shared_ptr<const LightOctree> octree);

    [[nodiscard]] bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override;
    [[nodiscard]] std::optional<float> noise(glm::vec3 p, glm::vec3 n) const override { return octree_->noise(p, n); }
    [[nodiscard]] std::shared_ptr<const IndirectField> withMix(Mix mix) const override;
    [[nodiscard]] std::string_view method() const override { return octree_->method(); }
    [[nodiscard]] std::size_t memoryBytes() const override { return packed_.memoryBytes(); } ///< of the arrays
    [[nodiscard]] const GpuOctree& arrays() const { return packed_; }

private:
    PackedOctree(std::shared_ptr<const LightOctree> octree, GpuOctree packed)
        : octree_(std::move(octree)), packed_(std::move(packed))
    {
    }
    std::shared_ptr<const LightOctree> octree_;
    GpuOctree packed_;
};

/// `field` as the parameters want it looked up (octree.show, octree.values; grid.remap, grid.filter,
/// grid.offset; voxel.lookup and what follows it). Fields of other methods as they are. `lights` of the same scene.
/// Errors: as makeGpuOctree.
[[nodiscard]] Result<std::shared_ptr<const IndirectField>>
shownField(std::shared_ptr<const IndirectField> field, const BakeParams& params,
           const std::shared_ptr<const LightSampler>& lights);

} // namespace lightloom
