// SPDX-License-Identifier: Apache-2.0
#include "core/voxel/voxel_field.h"

namespace lightloom {

std::shared_ptr<const VdlLayer> leaningLayer(int group, std::vector<glm::vec3> scalar,
                                             const std::vector<glm::vec3>& towards, const OctreeGeometry& leaves)
{
    auto layer = std::make_shared<VdlLayer>();
    layer->group = group;
    layer->flat = towards.empty() ? 0.0f : 0.5f;
    layer->vdls.reserve(towards.size());
    for (std::size_t e = 0; e < towards.size(); ++e)
        layer->vdls.push_back({0.5f / glm::dot(leaves.entries[e].normal, towards[e]) * scalar[e], towards[e]});
    layer->scalar = std::move(scalar);
    return layer;
}

VoxelField::VoxelField(std::shared_ptr<const VoxelSurface> surface,
                       std::vector<std::shared_ptr<const VoxelLayer>> layers, Mix mix)
    : surface_(std::move(surface)), layers_(std::move(layers))
{
    std::vector<std::shared_ptr<const VdlLayer>> indirect;
    OctreeShow show = OctreeShow::lights;
    for (const auto& layer : layers_) {
        indirect.push_back(layer ? layer->indirect : nullptr);
        if (layer && layer->indirect->vdls.empty()) show = OctreeShow::colour;
    }
    octree_ = std::make_shared<const LightOctree>(surface_->leaves, std::move(indirect), VdlForm::corrected,
                                                  std::move(mix), show);
}

std::shared_ptr<const IndirectField> VoxelField::withMix(Mix mix) const
{
    return std::make_shared<VoxelField>(surface_, layers_, std::move(mix));
}

std::size_t VoxelField::memoryBytes() const
{
    std::size_t sum = octree_->memoryBytes() + (surface_->albedo.size() + surface_->matt.size()) * sizeof(glm::vec3);
    for (const auto& layer : layers_)
        sum += layer ? (layer->direct.size() + layer->byRays.size() + layer->specular.size()) * sizeof(glm::vec3) : 0;
    return sum;
}

glm::vec3 VoxelField::mixed(std::vector<glm::vec3> VoxelLayer::*part, std::size_t entry) const
{
    glm::vec3 sum(0.0f);
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        if (layers_[g] && !((*layers_[g]).*part).empty())
            sum += gainOf(mix(), static_cast<int>(g)) * ((*layers_[g]).*part)[entry];
    }
    return sum;
}

glm::vec3 VoxelField::direct(std::size_t entry) const { return mixed(&VoxelLayer::direct, entry); }

/// Where photons have followed what mirrors and glass do with lamps' light, entries send on the rest of it alone.
glm::vec3 VoxelField::exitance(std::size_t entry) const
{
    glm::vec3 sum(0.0f);
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        if (!layers_[g]) continue;
        const VoxelLayer& layer = *layers_[g];
        const glm::vec3 indirect = layer.byRays.empty() ? layer.indirect->scalar[entry] : layer.byRays[entry];
        glm::vec3 sent = surface_->albedo[entry] * (layer.direct[entry] + indirect);
        if (!layer.specular.empty()) {
            const glm::vec3 followed = layer.direct[entry] + layer.specular[entry];
            sent -= (surface_->albedo[entry] - surface_->matt[entry]) * followed;
        }
        sum += gainOf(mix(), static_cast<int>(g)) * sent;
    }
    return sum;
}

glm::vec3 VoxelField::illuminance(std::size_t entry) const { return direct(entry) + octree_->mixedColour({entry, 0}); }

} // namespace lightloom
