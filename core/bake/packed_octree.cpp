// SPDX-License-Identifier: Apache-2.0
#include "core/bake/packed_octree.h"
#include "core/ivg/ivg_solver.h"
#include "core/voxel/voxel_cuts.h"
#include "shaders/common.h"
#include <cassert>
#include <cmath>

namespace lightloom {

namespace shader {
namespace {

/// The arrays as the shader sees them: reads by texel, and the text that walks over them.
struct OctreeArrays {
    explicit OctreeArrays(const GpuOctree& octree)
        : arrays(octree), depth(octree.depth), deepest(octree.deepest), hasDirections(!octree.hasDirections ? 0
                                                                                      : octree.isFirstFlat  ? 2
                                                                                                            : 1),
          lowest(octree.lowest), cellSize(std::ldexp(octree.rootSize, -octree.depth)), colourScale(octree.colourScale)
    {
    }

    [[nodiscard]] uvec4 brickAt(ivec3 texel) const
    {
        const uvec3 at(texel), size(2 * arrays.side);
        const std::uint8_t* t = arrays.bricks.data() + 4 * ((std::size_t(at.z) * size.y + at.y) * size.x + at.x);
        return {t[0], t[1], t[2], t[3]};
    }
    [[nodiscard]] uvec4 vdlAt(int number) const
    {
        const std::uint16_t* t = arrays.vdls.data() + 4 * static_cast<std::size_t>(number);
        return {t[0], t[1], t[2], t[3]};
    }
    [[nodiscard]] uvec4 normalAt(int entry) const
    {
        const std::uint8_t* t = arrays.normals.data() + 4 * static_cast<std::size_t>(entry);
        return {t[0], t[1], t[2], t[3]};
    }

    [[nodiscard]] int classEnd(int lights) const { return arrays.classEnds[static_cast<std::size_t>(lights)]; }
    [[nodiscard]] vec3 entryValue(int entry, vec3 n) { return entryIlluminance(entry, n); }

    const GpuOctree& arrays;
    int depth, deepest, hasDirections;
    vec3 lowest;
    float cellSize, colourScale;

#define SHARED [[nodiscard]] inline
#include "shaders/octree_walk.glsl"
#undef SHARED
};

} // namespace
} // namespace shader

std::optional<glm::vec3> packedIlluminance(const GpuOctree& octree, glm::vec3 p, glm::vec3 n)
{
    shader::OctreeArrays arrays(octree);
    const glm::vec4 light = arrays.octreeBlend(p, n);
    if (!(light.w > 0.0f)) return std::nullopt;
    return octree.colourScale * glm::vec3(light.x, light.y, light.z);
}

Result<std::shared_ptr<const PackedOctree>> PackedOctree::make(std::shared_ptr<const LightOctree> octree)
{
    Result<GpuOctree> packed = makeGpuOctree(*octree);
    if (!packed) return packed.error();
    return std::shared_ptr<const PackedOctree>(new PackedOctree(std::move(octree), std::move(*packed)));
}

bool PackedOctree::lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const
{
    const std::optional<glm::vec3> found = packedIlluminance(packed_, p, n);
    lux = found.value_or(glm::vec3(0.0f));
    return found.has_value();
}

std::shared_ptr<const IndirectField> PackedOctree::withMix(Mix mix) const
{
    const auto mixed = std::static_pointer_cast<const LightOctree>(octree_->withMix(std::move(mix)));
    Result<std::shared_ptr<const PackedOctree>> packed = make(mixed);
    assert(packed); // a mix changes no sizes
    return *packed;
}

Result<std::shared_ptr<const IndirectField>> shownField(std::shared_ptr<const IndirectField> field,
                                                        const BakeParams& params,
                                                        const std::shared_ptr<const LightSampler>& lights)
{
    if (const auto voxels = std::dynamic_pointer_cast<const VoxelField>(field)) {
        const VoxelShow show = voxelShow(params);
        if (show.lookup == VoxelLookup::field) return field;
        return std::shared_ptr<const IndirectField>(std::make_shared<VoxelCuts>(voxels, lights, show));
    }
    if (const auto grid = std::dynamic_pointer_cast<const IrradianceGrid>(field)) {
        const GridShow show = gridShow(params);
        if (grid->show() == show) return field;
        return std::static_pointer_cast<const IndirectField>(grid->withShow(show));
    }
    auto octree = std::dynamic_pointer_cast<const LightOctree>(field);
    if (!octree) return field;
    if (octree->show() != params.octreeShow) octree = octree->showing(params.octreeShow);
    if (params.octreeValues == OctreeValues::exact) return std::static_pointer_cast<const IndirectField>(octree);
    const Result<std::shared_ptr<const PackedOctree>> packed = PackedOctree::make(octree);
    if (!packed) return packed.error();
    return std::static_pointer_cast<const IndirectField>(*packed);
}

} // namespace lightloom
