// SPDX-License-Identifier: Apache-2.0
#include "core/voxel/voxel_field.h"

namespace lightloom {

VoxelField::VoxelField(std::shared_ptr<const VoxelSurface> surface,
                       std::vector<std::shared_ptr<const VoxelLayer>> layers, Mix mix)
    : surface_(std::move(surface)), layers_(std::move(layers))
{
    std::vector<std::shared_ptr<const VdlLayer>> indirect;
    for (const auto& layer : layers_) indirect.push_back(layer ? layer->indirect : nullptr);
    octree_ = std::make_shared<const LightOctree>(surface_->leaves, std::move(indirect), VdlForm::corrected,
                                                  std::move(mix), OctreeShow::colour);
}

std::shared_ptr<const IndirectField> VoxelField::withMix(Mix mix) const
{
    return std::make_shared<VoxelField>(surface_, layers_, std::move(mix));
}

std::size_t VoxelField::memoryBytes() const
{
    std::size_t sum = octree_->memoryBytes() + surface_->albedo.size() * sizeof(glm::vec3);
    for (const auto& layer : layers_)
        sum += layer ? (layer->direct.size() + layer->byRays.size()) * sizeof(glm::vec3) : 0;
    return sum;
}

glm::vec3 VoxelField::direct(std::size_t entry) const
{
    glm::vec3 sum(0.0f);
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        if (layers_[g]) sum += gainOf(mix(), static_cast<int>(g)) * layers_[g]->direct[entry];
    }
    return sum;
}

glm::vec3 VoxelField::exitance(std::size_t entry) const
{
    glm::vec3 lux = direct(entry);
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        if (!layers_[g]) continue;
        const VoxelLayer& layer = *layers_[g];
        const glm::vec3 indirect = layer.byRays.empty() ? layer.indirect->scalar[entry] : layer.byRays[entry];
        lux += gainOf(mix(), static_cast<int>(g)) * indirect;
    }
    return surface_->albedo[entry] * lux;
}

glm::vec3 VoxelField::illuminance(std::size_t entry) const { return direct(entry) + octree_->mixedColour({entry, 0}); }

} // namespace lightloom
