// SPDX-License-Identifier: Apache-2.0
#include "core/transport/light_strip.h"
#include <algorithm>
#include <utility>

namespace lightloom {

LightStrip::LightStrip(std::span<const Orientation> entries, std::span<const glm::vec3> albedo,
                       const EntryValues& radiosity, std::size_t firstChannel)
    : entries_(entries), albedo_(albedo), firstChannel_(firstChannel),
      channels_(std::min(kMostChannels, static_cast<std::size_t>(radiosity.channels) - firstChannel)),
      leaving_(entries.size(), channels_), arriving_(entries.size(), channels_), all_(entries.size(), channels_),
      cosines_(entries.size()), groups_((channels_ + 2) / 3)
{
    const float* from = radiosity.values.data() + firstChannel;
    for (std::size_t e = 0; e < entries.size(); ++e, from += radiosity.channels)
        std::copy_n(from, channels_, leaving_.line(e));
}

std::size_t LightStrip::bytesFor(std::size_t entries)
{
    return (entries + 1) * (3 * ChannelLines::kMostWidth * sizeof(ChannelLines::Four) + sizeof(float));
}

void LightStrip::beginBounce(std::size_t directions, bool looksForBright)
{
    std::ranges::fill(arriving_.fours, ChannelLines::Four{});
    std::ranges::fill(cosines_, 0.0f);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        groups_[g].bright.clear();
        if (looksForBright && !groups_[g].isDone) takeBright(g, directions);
    }
}

void LightStrip::takeBright(std::size_t group, std::size_t directions)
{
    const std::size_t first = 3 * group, count = std::min<std::size_t>(3, channels_ - first);
    std::vector<float> lumen(entries_.size());
    for (std::size_t e = 0; e < entries_.size(); ++e) {
        const float* leaving = leaving_.line(e) + first;
        for (std::size_t c = 0; c < count; ++c) lumen[e] += leaving[c] * entries_[e].area;
    }
    for (const std::uint32_t e : brightestOf(lumen, directions)) {
        BrightEntry bright{e, glm::vec3(0.0f)};
        for (std::size_t c = 0; c < count; ++c)
            bright.radiosity[static_cast<int>(c)] = std::exchange(leaving_.line(e)[first + c], 0.0f);
        groups_[group].bright.push_back(bright);
    }
}

/// E = sum of B / pi cos dOmega, with dOmega such that the sum of cos dOmega over the entry's half space is pi.
void LightStrip::arrive(const RayScene& rays, const SurfaceVoxels& voxels, std::size_t first, std::size_t end)
{
    for (std::size_t e = first; e < end; ++e) {
        const float share = cosines_[e] > 0.0f ? 1.0f / cosines_[e] : 0.0f;
        float* lux = arriving_.line(e);
        for (std::size_t c = 0; c < channels_; ++c) lux[c] *= share;
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            if (groups_[g].bright.empty()) continue;
            const glm::vec3 straight = luxFrom(groups_[g].bright, e, rays, voxels);
            for (std::size_t c = 3 * g; c < std::min(channels_, 3 * g + 3); ++c)
                lux[c] += straight[static_cast<int>(c % 3)];
        }
    }
}

/// Lumen of each group that the bounce brings to all entries, its three channels together.
std::vector<double> LightStrip::lumenArrived() const
{
    std::vector<double> lumen;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        double sum = 0.0;
        for (std::size_t e = 0; e < entries_.size(); ++e) {
            const float* lux = arriving_.line(e);
            double here = 0.0; // one step of the long sum: each waits for the one before
            for (std::size_t c = 3 * g; c < std::min(channels_, 3 * g + 3); ++c)
                here += static_cast<double>(lux[c] * entries_[e].area);
            sum += here;
        }
        lumen.push_back(sum);
    }
    return lumen;
}

void LightStrip::passOn(std::size_t first, std::size_t end, bool isFirst)
{
    for (std::size_t e = first; e < end; ++e) {
        const float* lux = arriving_.line(e);
        float* leaving = leaving_.line(e);
        for (std::size_t c = 0; c < channels_; ++c)
            leaving[c] = lux[c] * albedo_[e][static_cast<int>(c % 3)] + (isFirst ? leaving[c] : 0.0f);
    }
}

bool LightStrip::endBounce(float leastGain, bool isLast)
{
    const std::vector<double> lumen = lumenArrived();
    float weights[kMostChannels] = {}; // of groups that are done: 0
    bool areDone = true;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        Group& group = groups_[g];
        if (group.isDone) continue;
        group.sum += lumen[g];
        group.isDone = isLast || lumen[g] <= static_cast<double>(leastGain) * group.sum;
        // each further bounce is taken to bring the same share of the one before
        const double share = group.isDone && group.before > lumen[g] ? lumen[g] / group.before : 0.0;
        std::fill_n(weights + 3 * g, 3, static_cast<float>(1.0 / (1.0 - share)));
        group.before = lumen[g];
        areDone &= group.isDone;
    }
    for (std::size_t e = 0; e < entries_.size(); ++e) {
        const float* lux = arriving_.line(e);
        float *all = all_.line(e), *leaving = leaving_.line(e);
        for (std::size_t c = 0; c < channels_; ++c) {
            all[c] += lux[c] * weights[c];
            leaving[c] = lux[c] * albedo_[e][static_cast<int>(c % 3)];
        }
    }
    return areDone;
}

void LightStrip::writeTo(EntryValues& lux) const
{
    float* to = lux.values.data() + firstChannel_;
    for (std::size_t e = 0; e < entries_.size(); ++e, to += lux.channels) std::copy_n(all_.line(e), channels_, to);
}

} // namespace lightloom
