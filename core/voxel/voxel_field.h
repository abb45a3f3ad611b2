// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"

namespace lightloom {

/// Surface voxels as they are looked up and lit: leaves of an octree, with what their entries reflect.
struct VoxelSurface {
    int cells = 0;                                ///< along the longest side of the scene
    std::shared_ptr<const OctreeGeometry> leaves; ///< voxels, each with one entry per orientation
    std::vector<glm::vec3> albedo;                ///< of each entry, per channel, 0 to 1
    std::vector<glm::vec3> matt; ///< the same without mirrors; empty: there are neither these nor glass
};

/// The indirect light of one group (`scalar`, lux on each entry's own surface) as a layer of an octree. Of an entry
/// that faces n, with a tilt t (`lightTilts`), a surface that faces m gets scalar ((1 + m . n) / 2 + m . t): the first
/// term is what an evenly bright half of all directions gives, the second how light leans. Half of it counts whatever
/// the normal, the rest is one light that comes from n / 2 + t. `towards`: these, unit, at least .44 along n; empty:
/// light has no direction.
[[nodiscard]] std::shared_ptr<const VdlLayer> leaningLayer(int group, std::vector<glm::vec3> scalar,
                                                           const std::vector<glm::vec3>& towards,
                                                           const OctreeGeometry& leaves);

/// Light of one group on the entries of a surface, at baked intensity, lux.
struct VoxelLayer {
    std::vector<glm::vec3> direct; ///< by entry: straight from the lamps
    std::shared_ptr<const VdlLayer>
        indirect; ///< what arrives by way of at least one other surface, along lines that exact rays put right where
                  ///< there are any (correctedByRays), and where it comes from (leaningLayer)
    std::vector<glm::vec3> byRays; ///< the same along a few exact rays of each entry: noisy alone, right in the mean of
                                   ///< many (RayPartners); empty: there is none
    std::vector<glm::vec3> specular; ///< the part of both that comes from lamps by mirrors and glass alone; empty:
                                     ///< there is none, or it is missing
};

/// Multi-bounce light on surface voxels (Chatelier and Malgouyres 2006): one illuminance per orientation of the surface
/// in a voxel, interpolated as a light octree interpolates its leaves.
class VoxelField final : public IndirectField {
public:
    /// `layers` by light group; null where a lamp is off.
    VoxelField(std::shared_ptr<const VoxelSurface> surface, std::vector<std::shared_ptr<const VoxelLayer>> layers,
               Mix mix);

    [[nodiscard]] bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override
    {
        return octree_->lookup(p, n, lux);
    }
    [[nodiscard]] std::shared_ptr<const IndirectField> withMix(Mix mix) const override;
    [[nodiscard]] std::string_view method() const override { return "voxel-lightcuts"; }
    [[nodiscard]] std::size_t memoryBytes() const override;

    [[nodiscard]] const VoxelSurface& surface() const { return *surface_; }
    [[nodiscard]] const std::vector<std::shared_ptr<const VoxelLayer>>& layers() const { return layers_; }
    [[nodiscard]] const Mix& mix() const { return octree_->mix(); }
    /// A part of each layer by entry, under the mix, lux; 0 where a layer has none.
    [[nodiscard]] glm::vec3 mixed(std::vector<glm::vec3> VoxelLayer::*part, std::size_t entry) const;
    /// Illuminance of an entry under the mix, lux: straight from the lamps, and all.
    [[nodiscard]] glm::vec3 direct(std::size_t entry) const;
    [[nodiscard]] glm::vec3 illuminance(std::size_t entry) const;
    /// What an entry sends on of all the light that falls on it, lm/m2, for whoever adds up many of them as lights: by
    /// exact rays where the bake has them.
    [[nodiscard]] glm::vec3 exitance(std::size_t entry) const;
    /// The same values as an octree, for whoever draws one.
    [[nodiscard]] const LightOctree& octree() const { return *octree_; }
    [[nodiscard]] const std::shared_ptr<const LightOctree>& octreeShared() const { return octree_; }

private:
    std::shared_ptr<const VoxelSurface> surface_;
    std::vector<std::shared_ptr<const VoxelLayer>> layers_;
    std::shared_ptr<const LightOctree> octree_;
};

} // namespace lightloom
