// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/units.h"
#include "core/lightcuts/lightcut.h"
#include "core/lightcuts/ray_partners.h"
#include "core/trace/direct_light.h"
#include "core/trace/material.h"
#include "core/transport/first_light.h"
#include <algorithm>
#include <numeric>

/// A scene's multi-bounce light on voxels as discs, and the voxels looked up near by: what a method that stands on
/// lightcuts has, in its simplest form. For tests and benches.
namespace lightloom {

/// Values by voxel entry, interpolated over compatible entries of the 3 x 3 x 3 cells around a point by area and
/// distance.
class EntryLookup {
public:
    explicit EntryLookup(std::shared_ptr<const SurfaceVoxels> voxels)
        : voxels_(std::move(voxels)), cells_(voxels_->cells + 2)
    {
        numbers_.assign(static_cast<std::size_t>(cells_ * cells_ * cells_), -1);
        for (std::size_t v = 0; v < voxels_->voxels.size(); ++v) number(voxels_->voxels[v]) = static_cast<int>(v);
    }

    [[nodiscard]] glm::vec3 at(glm::vec3 p, glm::vec3 n, const std::vector<glm::vec3>& values) const
    {
        const float h = voxels_->cellSize();
        const glm::ivec3 cell(glm::floor((p - voxels_->lattice.lowest) / h));
        glm::vec3 sum(0.0f);
        float weights = 0.0f;
        for (int i = 0; i < 27; ++i) {
            const glm::ivec3 c = cell + glm::ivec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            if (glm::any(glm::lessThan(c, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(c, glm::ivec3(cells_))))
                continue;
            const int v = number(c);
            if (v < 0) continue;
            for (std::uint32_t e = voxels_->firstEntry[static_cast<std::size_t>(v)];
                 e < voxels_->firstEntry[static_cast<std::size_t>(v) + 1]; ++e) {
                const Orientation& o = voxels_->entries[e];
                const glm::vec3 off = (o.centroid - p) / h;
                if (glm::dot(o.normal, n) < 0.7f || glm::abs(glm::dot(off, n)) > 1.0f) continue;
                const glm::vec3 tent = glm::max(glm::vec3(0.0f), 1.0f - glm::abs(off) / 1.5f);
                const float weight = o.area * tent.x * tent.y * tent.z;
                sum += weight * values[e];
                weights += weight;
            }
        }
        return weights > 0.0f ? sum / weights : glm::vec3(0.0f);
    }

private:
    [[nodiscard]] const int& number(glm::ivec3 c) const
    {
        return numbers_[static_cast<std::size_t>((c.z * cells_ + c.y) * cells_ + c.x)];
    }
    int& number(glm::ivec3 c) { return const_cast<int&>(std::as_const(*this).number(c)); }

    std::shared_ptr<const SurfaceVoxels> voxels_;
    int cells_;
    std::vector<int> numbers_; // by cell
};

/// All lamps together.
struct VoxelLights {
    std::shared_ptr<const SurfaceVoxels> voxels;
    std::vector<glm::vec3> direct, indirect; ///< lux, by entry
    std::vector<glm::vec3> soft;             ///< of `direct`, what comes from glowing surfaces
    Mix sharp;                               ///< 1 for lamps that throw sharp shadows, 0 for glowing surfaces
    std::vector<DiscLight> discs;            ///< by entry
    std::vector<glm::vec3> exitance;         ///< lm/m2, by entry

    /// With `exactRays` of each entry what discs send is the light that came along these, not along lines.
    VoxelLights(const RayScene& rays, const LightSampler& lights, const LightReach& reach, int cells, int directions,
                Workers& workers, float shift = 0.0f, int exactRays = 0)
        : voxels(voxelise(rays.scene().bounds, reach, cells, shift, workers, {}))
    {
        const std::vector<glm::vec3> albedo = entryAlbedos(rays, reach, *voxels);
        std::vector<int> groups(rays.scene().groups.size());
        std::iota(groups.begin(), groups.end(), 0);
        const EntryValues first = firstLight(lights, reach, *voxels, groups, 4, 1, workers, {});
        BounceParams params;
        params.directions = directions;
        direct = allLamps(first);
        sharp.assign(rays.scene().groups.size(), glm::vec3(1.0f));
        for (const Emitter& emitter : lights.emitters()) {
            if (emitter.kind == Emitter::Kind::surface)
                sharp[static_cast<std::size_t>(emitter.group)] = glm::vec3(0.0f);
        }
        soft = allLamps(first, sharp);
        const EntryValues leaving = reflected(first, albedo);
        EntryValues lux = bounceLight(rays, *voxels, VoxelOrders(*voxels), leaving, albedo, params, workers, {});
        indirect = allLamps(lux);
        if (exactRays > 0) {
            const auto partners = RayPartners::trace(rays, reach, *voxels, exactRays, 1, workers, {});
            lux = partners->bounced(leaving, albedo, lux, workers, {});
        }
        const std::vector<glm::vec3> carried = allLamps(lux);
        for (std::size_t e = 0; e < albedo.size(); ++e) {
            const Orientation& o = voxels->entries[e];
            discs.push_back({o.centroid, o.area, o.normal});
            exitance.push_back(albedo[e] * (direct[e] + carried[e]));
        }
    }
    [[nodiscard]] std::shared_ptr<const LightTree> tree(std::uint64_t seed = 1) const
    {
        return LightTree::build(discs, exitance, voxels->cellSize(), seed);
    }

private:
    static std::vector<glm::vec3> allLamps(const EntryValues& lux, const Mix& without = {})
    {
        const auto channels = static_cast<std::size_t>(lux.channels);
        std::vector<glm::vec3> sums(lux.entries(), glm::vec3(0.0f));
        for (std::size_t i = 0; i < lux.values.size(); ++i) {
            if (without.empty() || without[i % channels / 3] == glm::vec3(0.0f))
                sums[i / channels][static_cast<int>(i % 3)] += lux.values[i];
        }
        return sums;
    }
};

/// What rays meet: the surface's own colour under the light of its voxels. Where it gets `lamps` light of those that
/// throw sharp shadows is taken exactly instead.
class EntryNearField final : public NearField {
public:
    EntryNearField(std::shared_ptr<const RayScene> rays, const VoxelLights& lights, const LightSampler* lamps = nullptr)
        : rays_(std::move(rays)), lamps_(lamps), sharp_(lights.sharp), lookup_(lights.voxels),
          lux_(lamps ? lights.soft : lights.direct)
    {
        for (std::size_t e = 0; e < lux_.size(); ++e) lux_[e] += lights.indirect[e];
    }
    [[nodiscard]] glm::vec3 exitance(const Hit& hit) const override
    {
        const Surface surface = surfaceAt(*rays_, hit);
        glm::vec3 lux = lookup_.at(hit.position, hit.facing(), lux_);
        Rng unused(0, 0, 0);
        if (lamps_) lux += directIlluminance(*rays_, *lamps_, sharp_, hit.position, hit.facing(), 1, unused);
        return (surface.diffuse + surface.specular) * lux;
    }

private:
    std::shared_ptr<const RayScene> rays_;
    const LightSampler* lamps_;
    Mix sharp_;
    EntryLookup lookup_;
    std::vector<glm::vec3> lux_;
};

} // namespace lightloom
