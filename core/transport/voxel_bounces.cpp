// SPDX-License-Identifier: Apache-2.0
#include "core/transport/voxel_bounces.h"
#include <algorithm>
#include <cassert>

namespace lightloom {
namespace {

constexpr std::size_t kLeastDirections = 64;

/// A part of the directions: what they bring to every entry. Parts are fixed, whatever the number of threads, and added
/// in their order.
struct Part {
    std::vector<float> light;   // sum of radiosity x cosine, by entry and channel
    std::vector<float> cosines; // sum, by entry
};

class Bouncer {
public:
    Bouncer(const RayScene& rays, const SurfaceVoxels& voxels, const VoxelOrders& orders, int channels, int directions,
            Workers& workers, const std::stop_token& stop)
        : voxels_(voxels), orders_(orders), exact_(rays, voxels), channels_(static_cast<std::size_t>(channels)),
          directions_(directionSet(directions)), workers_(workers), stop_(stop)
    {
    }

    /// One bounce: lux from lm/m2. False: stopped.
    [[nodiscard]] bool gather(const std::vector<float>& radiosity, std::size_t directions, std::vector<float>& lux)
    {
        constexpr std::size_t kParts = 8;
        directions = std::min(directions, directions_.size());
        parts_.resize(kParts);
        const bool all = workers_.run(kParts, stop_, [&](std::size_t p) {
            gatherPart(radiosity, directions * p / kParts, directions * (p + 1) / kParts, parts_[p]);
        });
        if (!all || stop_.stop_requested()) return false;
        addParts(lux);
        return true;
    }

private:
    void gatherPart(const std::vector<float>& radiosity, std::size_t first, std::size_t end, Part& part) const
    {
        const std::vector<Orientation>& entries = voxels_.entries;
        part.light.assign(entries.size() * channels_, 0.0f);
        part.cosines.assign(entries.size(), 0.0f);
        LinePartners lines(voxels_, orders_);
        for (std::size_t d = first; d < end && !stop_.stop_requested(); ++d) {
            const std::span<std::uint32_t> partners = lines.find(directions_[d], static_cast<std::uint32_t>(d));
            exact_.complete(directions_[d], partners);
            for (std::size_t e = 0; e < entries.size(); ++e) {
                const float cosine = glm::abs(glm::dot(entries[e].normal, directions_[d].unit));
                part.cosines[e] += cosine;
                if (partners[e] == LinePartners::kNothing) continue;
                const float* from = &radiosity[partners[e] * channels_];
                float* to = &part.light[e * channels_];
                for (std::size_t c = 0; c < channels_; ++c) to[c] += from[c] * cosine;
            }
        }
    }

    /// E = sum of B / pi cos dOmega, with dOmega such that the sum of cos dOmega over the entry's half space is pi.
    void addParts(std::vector<float>& lux) const
    {
        lux.assign(parts_[0].light.size(), 0.0f);
        for (std::size_t e = 0; e < voxels_.entries.size(); ++e) {
            float cosines = 0.0f;
            for (const Part& part : parts_) cosines += part.cosines[e];
            const float share = cosines > 0.0f ? 1.0f / cosines : 0.0f;
            for (std::size_t i = e * channels_; i < (e + 1) * channels_; ++i) {
                for (const Part& part : parts_) lux[i] += part.light[i];
                lux[i] *= share;
            }
        }
    }

    const SurfaceVoxels& voxels_;
    const VoxelOrders& orders_;
    ExactPartners exact_;
    std::size_t channels_;
    std::vector<LineDirection> directions_;
    Workers& workers_;
    const std::stop_token& stop_;
    std::vector<Part> parts_;
};

/// Lumen of a light group that a bounce brings to all entries, its three channels together.
std::vector<double> lumenOf(const SurfaceVoxels& voxels, const std::vector<float>& lux, std::size_t channels)
{
    std::vector<double> lumen((channels + 2) / 3, 0.0);
    for (std::size_t i = 0; i < lux.size(); ++i) {
        lumen[i % channels / 3] += static_cast<double>(lux[i] * voxels.entries[i / channels].area);
    }
    return lumen;
}

} // namespace

EntryValues bounceLight(const RayScene& rays, const SurfaceVoxels& voxels, const VoxelOrders& orders,
                        const EntryValues& radiosity, std::span<const glm::vec3> albedo, const BounceParams& params,
                        Workers& workers, const std::stop_token& stop, int* bounces)
{
    assert(radiosity.entries() == voxels.entries.size() && albedo.size() == voxels.entries.size());
    const auto channels = static_cast<std::size_t>(radiosity.channels);
    Bouncer bouncer(rays, voxels, orders, radiosity.channels, params.directions, workers, stop);
    EntryValues all{radiosity.channels, std::vector<float>(radiosity.values.size(), 0.0f)};
    std::vector<float> leaving = radiosity.values, lux;
    std::vector<double> sum((channels + 2) / 3, 0.0), before;
    std::size_t directions = static_cast<std::size_t>(params.directions);
    for (int bounce = 1;; ++bounce) {
        if (!bouncer.gather(leaving, directions, lux)) return {};
        if (bounces) *bounces = bounce;
        const std::vector<double> now = lumenOf(voxels, lux, channels);
        bool isLast = true;
        for (std::size_t g = 0; g < sum.size(); ++g) {
            sum[g] += now[g];
            isLast &= now[g] <= static_cast<double>(params.leastGain) * sum[g];
        }
        isLast |= bounce >= params.mostBounces;
        for (std::size_t i = 0; i < lux.size(); ++i) {
            const std::size_t g = i % channels / 3;
            // each further bounce is taken to bring the same share of the one before
            const double share = isLast && !before.empty() && before[g] > now[g] ? now[g] / before[g] : 0.0;
            all.values[i] += static_cast<float>(static_cast<double>(lux[i]) / (1.0 - share));
            leaving[i] = lux[i] * albedo[i / channels][static_cast<int>(i % channels % 3)];
        }
        if (isLast) return all;
        before = now;
        directions = std::max(kLeastDirections, directions / 2);
    }
}

} // namespace lightloom
