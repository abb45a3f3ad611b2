// SPDX-License-Identifier: Apache-2.0
#include "core/lightcuts/ray_partners.h"
#include "core/base/low_discrepancy.h"
#include "core/base/sampling.h"
#include <limits>

namespace lightloom {
namespace {

constexpr std::size_t kBlock = 256; // entries
constexpr int kMostSteps = 1000;    // albedos are at most .99: far more than it ever takes

/// By side (ReachedFacet::side): whether light reaches any of it.
std::vector<std::uint8_t> reachedSides(const RayScene& rays, const LightReach& reach)
{
    std::vector<std::uint8_t> reached(2 * rays.triangleCount(), 0);
    for (const ReachedFacet& facet : reach.facets()) reached[facet.side] = 1;
    return reached;
}

std::size_t blocksOf(std::size_t entries) { return (entries + kBlock - 1) / kBlock; }

} // namespace

std::shared_ptr<const RayPartners> RayPartners::trace(const RayScene& rays, const LightReach& reach,
                                                      const SurfaceVoxels& voxels, int count, std::uint64_t seed,
                                                      Workers& workers, const std::stop_token& stop)
{
    auto partners = std::make_shared<RayPartners>();
    const std::size_t entries = voxels.entries.size(), each = static_cast<std::size_t>(count);
    partners->count_ = each;
    for (const Orientation& o : voxels.entries) partners->areas_.push_back(o.area);
    partners->met_.assign(entries * each, SurfaceVoxels::kNoEntry);
    partners->open_.assign(entries, 1.0f);
    const std::vector<std::uint8_t> reached = reachedSides(rays, reach);
    const bool all = workers.run(blocksOf(entries), stop, [&](std::size_t block) {
        for (std::size_t e = block * kBlock; e < std::min(entries, (block + 1) * kBlock); ++e) {
            Rng rng(seed, hashName("ray partners"), e);
            const ShiftedPoints ways(count, rng), places(count, rng);
            int hidden = 0;
            for (int i = 0; i < count; ++i) {
                std::uint32_t facet = 0;
                const glm::vec3 p = voxels.pointOn(e, {rng.uniform(), places[i].x, places[i].y}, reach, facet);
                const glm::vec3 n = reach.facets()[facet].normal;
                const glm::vec3 travel = Frame(n).toWorld(sampleCosineHemisphere(ways[i].x, ways[i].y));
                Hit hit;
                if (!rays.intersect(rays.leave(p, n), travel, std::numeric_limits<float>::infinity(), hit)) continue;
                if (!reached[2 * hit.triangle + (hit.isFront ? 0 : 1)]) ++hidden;
                partners->met_[e * each + static_cast<std::size_t>(i)] = voxels.entryAt(hit.position, hit.facing());
            }
            partners->open_[e] = static_cast<float>(count - hidden) / static_cast<float>(count);
        }
    });
    return all ? partners : nullptr;
}

EntryValues RayPartners::bounced(const EntryValues& radiosity, std::span<const glm::vec3> albedo,
                                 const EntryValues& guess, Workers& workers, const std::stop_token& stop,
                                 double leastChange) const
{
    const std::size_t entries = areas_.size(), channels = static_cast<std::size_t>(radiosity.channels);
    EntryValues lux = guess;
    std::vector<glm::vec3> now(entries), next(entries), leaving(entries);
    const auto inGroup = [&](const std::vector<float>& values, std::size_t e, std::size_t first) {
        return glm::vec3(values[e * channels + first], values[e * channels + first + 1],
                         values[e * channels + first + 2]);
    };
    for (std::size_t first = 0; first < channels; first += 3) {
        for (std::size_t e = 0; e < entries; ++e) now[e] = inGroup(guess.values, e, first);
        for (int step = 0; step < kMostSteps; ++step) {
            for (std::size_t e = 0; e < entries; ++e)
                leaving[e] = inGroup(radiosity.values, e, first) + albedo[e] * now[e];
            const bool all = workers.run(blocksOf(entries), stop, [&](std::size_t block) {
                for (std::size_t e = block * kBlock; e < std::min(entries, (block + 1) * kBlock); ++e) {
                    glm::vec3 sum(0.0f);
                    for (std::size_t i = e * count_; i < (e + 1) * count_; ++i) {
                        if (met_[i] != SurfaceVoxels::kNoEntry) sum += leaving[met_[i]];
                    }
                    next[e] = sum / static_cast<float>(count_);
                }
            });
            if (!all) return {};
            double light = 0.0, change = 0.0;
            for (std::size_t e = 0; e < entries; ++e) {
                light += static_cast<double>(areas_[e] * luminance(next[e]));
                change += static_cast<double>(areas_[e] * luminance(next[e] - now[e]));
            }
            now.swap(next);
            if (std::abs(change) <= leastChange * light) break;
        }
        for (std::size_t e = 0; e < entries; ++e) {
            for (std::size_t c = 0; c < 3; ++c) lux.values[e * channels + first + c] = now[e][static_cast<int>(c)];
        }
    }
    return lux;
}

EntryValues RayPartners::ofOpen(EntryValues bounced) const
{
    const auto channels = static_cast<std::size_t>(bounced.channels);
    for (std::size_t i = 0; i < bounced.values.size(); ++i) {
        const float share = open_[i / channels];
        bounced.values[i] = share > 0.0f ? bounced.values[i] / share : 0.0f;
    }
    return bounced;
}

EntryValues RayPartners::ofAll(EntryValues ofOpen) const
{
    const auto channels = static_cast<std::size_t>(ofOpen.channels);
    for (std::size_t i = 0; i < ofOpen.values.size(); ++i) ofOpen.values[i] *= open_[i / channels];
    return ofOpen;
}

} // namespace lightloom
