// SPDX-License-Identifier: Apache-2.0
#include "core/voxel/voxel_cuts.h"
#include "core/lightcuts/lamp_tree.h"
#include "core/trace/direct_light.h"
#include "core/transport/first_light.h"
#include <algorithm>
#include <bit>
#include <cassert>

namespace lightloom {
namespace {

constexpr std::size_t kMostSuns = 4; ///< lamps that are looked for at each near ray's end

/// The mix of light groups that have suns and spots only, black elsewhere: their shadows have edges that voxels blur.
/// All black where there are many.
Mix sharpOnly(const LightSampler& lights, const Mix& mix)
{
    const std::size_t groups = lights.rays()->scene().groups.size();
    std::vector<bool> isSharp(groups, true);
    for (const Emitter& e : lights.emitters()) {
        if (e.kind != Emitter::Kind::directional && e.kind != Emitter::Kind::spot)
            isSharp[static_cast<std::size_t>(e.group)] = false;
    }
    const auto count = static_cast<std::size_t>(std::ranges::count_if(
        lights.emitters(), [&](const Emitter& e) { return isSharp[static_cast<std::size_t>(e.group)]; }));
    Mix sharp(groups, glm::vec3(0.0f));
    for (std::size_t g = 0; g < groups && count <= kMostSuns; ++g)
        if (isSharp[g]) sharp[g] = gainOf(mix, static_cast<int>(g));
    return sharp;
}

/// A value by entry, looked up as a colour octree.
template<class Value>
std::unique_ptr<const LightOctree> octreeOf(const VoxelField& field, Value value)
{
    auto layer = std::make_shared<VdlLayer>();
    for (std::size_t e = 0; e < field.surface().leaves->entries.size(); ++e)
        layer->scalar.push_back(glm::max(value(e), glm::vec3(0.0f)));
    return std::make_unique<const LightOctree>(field.surface().leaves,
                                               std::vector<std::shared_ptr<const VdlLayer>>{std::move(layer)},
                                               VdlForm::corrected, Mix{}, OctreeShow::colour);
}

bool hasSpecular(const VoxelField& field)
{
    return std::ranges::any_of(field.layers(), [](const auto& layer) { return layer && !layer->specular.empty(); });
}

/// What surface near a receiver sends on: as its voxels are lit, by its own colour; light of suns and spots exactly.
class NearVoxels final : public NearField {
public:
    NearVoxels(const VoxelField& field, std::shared_ptr<const LightSampler> lights)
        : lights_(std::move(lights)), sharp_(sharpOnly(*lights_, field.mix())),
          hasSharp_(std::ranges::any_of(sharp_, [](glm::vec3 gain) { return gain != glm::vec3(0.0f); }))
    {
        lit_ = octreeOf(field, [&](std::size_t e) {
            glm::vec3 lux = field.illuminance(e);
            for (std::size_t g = 0; g < sharp_.size(); ++g)
                if (field.layers()[g]) lux -= sharp_[g] * field.layers()[g]->direct[e];
            return lux;
        });
        if (!hasSpecular(field)) return;
        bounced_ = octreeOf(field, [&](std::size_t e) {
            return field.illuminance(e) - field.direct(e) - field.mixed(&VoxelLayer::specular, e);
        });
    }
    [[nodiscard]] glm::vec3 exitance(const Hit& hit) const override
    {
        const RayScene& rays = *lights_->rays();
        const Surface surface = surfaceAt(rays, hit);
        const glm::vec3 matt = bounced_ ? mattAlbedo(surface) : evenAlbedo(surface);
        glm::vec3 lux = lit_->irradiance(hit.position, hit.facing());
        Rng unused(0, 0, 0); // suns and spots have no surface to sample
        if (hasSharp_) lux += directIlluminance(rays, *lights_, sharp_, hit.position, hit.facing(), 1, unused);
        if (matt == evenAlbedo(surface)) return matt * lux;
        return matt * lux + (evenAlbedo(surface) - matt) * bounced_->irradiance(hit.position, hit.facing());
    }

private:
    std::shared_ptr<const LightSampler> lights_;
    Mix sharp_;
    bool hasSharp_;
    std::unique_ptr<const LightOctree> lit_; ///< all light under the mix but that of `sharp_`, straight from its lamps
    std::unique_ptr<const LightOctree>
        bounced_; ///< what mirrors send on evenly: photons have followed lamps' own light
};

std::shared_ptr<const LightTree> treeOf(const VoxelField& field, std::uint64_t seed)
{
    std::vector<DiscLight> lights;
    for (const OctreeEntry& e : field.surface().leaves->entries) lights.push_back({e.centroid, e.area, e.normal});
    const std::vector<glm::vec3> none(lights.size(), glm::vec3(0.0f));
    return LightTree::build(lights, none, field.surface().leaves->cellSize(), seed);
}

/// A number for a place, for what is drawn there.
std::uint64_t numberOf(glm::vec3 p)
{
    const auto bits = [](float v) { return std::uint64_t{std::bit_cast<std::uint32_t>(v)}; };
    return mixBits(mixBits(bits(p.x) << 32 | bits(p.y)) ^ bits(p.z));
}

} // namespace

VoxelShow voxelShow(const BakeParams& params)
{
    VoxelShow show;
    show.lookup = params.voxelLookup;
    show.cuts.threshold = params.voxelThreshold;
    show.cuts.mostNodes = params.voxelCut;
    show.cuts.nearRays = params.voxelNear;
    show.cuts.seed = params.seed;
    show.samples = params.voxelLights;
    show.lamps = params.voxelLamps;
    return show;
}

VoxelCuts::VoxelCuts(std::shared_ptr<const VoxelField> field, std::shared_ptr<const LightSampler> lights,
                     VoxelShow show)
    : field_(std::move(field)), lights_(std::move(lights)), show_(show), tree_(treeOf(*field_, show.cuts.seed))
{
    light();
}

VoxelCuts::VoxelCuts(const VoxelCuts& other, std::shared_ptr<const VoxelField> field)
    : field_(std::move(field)), lights_(other.lights_), show_(other.show_), tree_(other.tree_)
{
    light();
}

void VoxelCuts::light()
{
    std::vector<glm::vec3> exitance;
    for (std::size_t e = 0; e < field_->surface().leaves->entries.size(); ++e) exitance.push_back(field_->exitance(e));
    tree_ = tree_->withExitance(exitance);
    const auto near = std::make_shared<const NearVoxels>(*field_, lights_);
    cuts_ = std::make_unique<const Lightcuts>(lights_->rays(), tree_, near);
    if (hasSpecular(*field_))
        specular_ = octreeOf(*field_, [&](std::size_t e) { return field_->mixed(&VoxelLayer::specular, e); });
    if (show_.lamps > 0) {
        const auto lamps = lampTree(*lights_, field_->mix(), show_.lamps, show_.cuts.seed);
        joined_ = std::make_unique<const Lightcuts>(lights_->rays(), tree_, near, lamps);
    }
    if (show_.lookup == VoxelLookup::samples)
        samples_ =
            std::make_unique<const LightSamples>(*tree_, static_cast<std::size_t>(show_.samples), show_.cuts.seed);
}

bool VoxelCuts::lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const
{
    lux = samples_
              ? cuts_->fromSamples(p, n, numberOf(p), show_.cuts, *samples_, 0, samples_->count()) + specularAt(p, n)
              : cutAt(p, n).illuminance;
    return true;
}

glm::vec3 VoxelCuts::specularAt(glm::vec3 p, glm::vec3 n) const
{
    return specular_ ? specular_->irradiance(p, n) : glm::vec3(0.0f);
}

Lightcut VoxelCuts::cutAt(glm::vec3 p, glm::vec3 n) const
{
    Lightcut cut = cuts_->at(p, n, numberOf(p), show_.cuts);
    cut.illuminance += specularAt(p, n);
    return cut;
}

glm::vec3 VoxelCuts::everyLightAt(glm::vec3 p, glm::vec3 n) const
{
    return cuts_->everyLight(p, n, numberOf(p), show_.cuts) + specularAt(p, n);
}

std::vector<CutLight> VoxelCuts::lightsAt(glm::vec3 p, glm::vec3 n, float share) const
{
    LightcutParams finer = show_.cuts;
    finer.threshold *= share;
    std::vector<CutLight> seen;
    static_cast<void>(cuts_->at(p, n, numberOf(p), finer, &seen));
    return seen;
}

Lightcut VoxelCuts::joinedAt(glm::vec3 p, glm::vec3 n) const
{
    assert(joined_);
    Lightcut cut = joined_->at(p, n, numberOf(p), show_.cuts);
    cut.illuminance += specularAt(p, n);
    return cut;
}

std::shared_ptr<const IndirectField> VoxelCuts::withMix(Mix mix) const
{
    const auto mixed = std::static_pointer_cast<const VoxelField>(field_->withMix(std::move(mix)));
    return std::shared_ptr<const IndirectField>(new VoxelCuts(*this, mixed));
}

std::size_t VoxelCuts::memoryBytes() const { return field_->memoryBytes() + tree_->memoryBytes(); }

} // namespace lightloom
