// SPDX-License-Identifier: Apache-2.0
#include "core/transport/light_strip.h"
#include <algorithm>
#include <cmath>
#include <utility>

namespace lightloom {
namespace {

Floats4& lanes(ChannelLines& lines, std::size_t four) { return lanesOf<Floats4>(lines.fours[four].values, 0); }
const Floats4& lanes(const ChannelLines& lines, std::size_t four)
{
    return lanesOf<Floats4>(lines.fours[four].values, 0);
}

} // namespace

LightStrip::LightStrip(const RowOrder& order, std::span<const glm::vec3> albedo, const EntryValues& radiosity,
                       std::size_t firstChannel)
    : order_(order), firstChannel_(firstChannel),
      channels_(std::min(kMostChannels, static_cast<std::size_t>(radiosity.channels) - firstChannel)),
      albedo_(order.size(), channels_), leaving_(order.size(), channels_), arriving_(order.size(), channels_),
      before_(order.size(), channels_), all_(order.size(), channels_), cosines_(order.size()), lumenBefore_(channels_),
      groups_((channels_ + 2) / 3)
{
    const float* from = radiosity.values.data() + firstChannel;
    const auto stride = static_cast<std::size_t>(radiosity.channels);
    for (std::size_t r = 0; r < order.size(); ++r) {
        const std::size_t e = order.entryOf[r];
        std::copy_n(from + e * stride, channels_, leaving_.line(r));
        float* sentOn = albedo_.line(r);
        for (std::size_t c = 0; c < channels_; ++c) sentOn[c] = albedo[e][static_cast<int>(c % 3)];
    }
}

std::size_t LightStrip::bytesFor(std::size_t entries)
{
    return (entries + 1) * (5 * ChannelLines::kMostWidth * sizeof(ChannelLines::Four) + sizeof(float));
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
    std::vector<float> lumen(order_.size());
    for (std::size_t r = 0; r < lumen.size(); ++r) {
        const float* leaving = leaving_.line(r) + first;
        float sum = 0.0f;
        for (std::size_t c = 0; c < count; ++c) sum += leaving[c];
        lumen[r] = sum * order_.orientations[r].area;
    }
    for (const std::uint32_t r : brightestOf(lumen, directions)) {
        BrightEntry bright{order_.entryOf[r], glm::vec3(0.0f)};
        for (std::size_t c = 0; c < count; ++c)
            bright.radiosity[static_cast<int>(c)] = std::exchange(leaving_.line(r)[first + c], 0.0f);
        groups_[group].bright.push_back(bright);
    }
}

/// E = sum of B / pi cos dOmega, with dOmega such that the sum of cos dOmega over the entry's half space is pi.
void LightStrip::arrive(const RayScene& rays, const SurfaceVoxels& voxels, std::size_t first, std::size_t end)
{
    for (std::size_t r = first; r < end; ++r) {
        const float share = cosines_[r] > 0.0f ? 1.0f / cosines_[r] : 0.0f;
        for (std::size_t w = 0; w < arriving_.width; ++w) lanes(arriving_, r * arriving_.width + w) *= share;
    }
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (groups_[g].bright.empty()) continue;
        for (std::size_t r = first; r < end; ++r) {
            const glm::vec3 straight = luxFrom(groups_[g].bright, order_.entryOf[r], rays, voxels);
            for (std::size_t c = 3 * g; c < std::min(channels_, 3 * g + 3); ++c)
                arriving_.line(r)[c] += straight[static_cast<int>(c % 3)];
        }
    }
}

/// Lumen of each channel that the bounce brings to all entries.
std::vector<double> LightStrip::lumenArrived() const
{
    constexpr std::size_t kTogether = 64; // rows whose sum fits into a float
    const std::size_t width = arriving_.width;
    std::vector<double> lumen(channels_);
    for (std::size_t first = 0; first < order_.size(); first += kTogether) {
        Floats4 sums[ChannelLines::kMostWidth] = {};
        for (std::size_t r = first; r < std::min(order_.size(), first + kTogether); ++r)
            for (std::size_t w = 0; w < width; ++w)
                sums[w] += lanes(arriving_, r * width + w) * order_.orientations[r].area;
        for (std::size_t c = 0; c < channels_; ++c) lumen[c] += static_cast<double>(sums[c / 4][c % 4]);
    }
    return lumen;
}

/// How far each channel's further bounces, taken to bring `shares` of the one before each, are off at an entry, as a
/// share of all that has come to it: about as far as this bounce is off those shares of the one before, times the rest
/// of the series. Mean by area over some of the entries.
double LightStrip::offBySeries(std::size_t group, std::span<const double> shares) const
{
    constexpr std::size_t kSome = 1024;
    const std::size_t step = std::max<std::size_t>(1, order_.size() / kSome), first = 3 * group;
    const std::size_t end = std::min(channels_, first + 3);
    double sum = 0.0, area = 0.0;
    for (std::size_t r = 0; r < order_.size(); r += step) {
        const float *lux = arriving_.line(r), *before = before_.line(r), *all = all_.line(r);
        double off = 0.0, come = 0.0;
        for (std::size_t c = first; c < end; ++c) {
            const double share = shares[c - first], now = static_cast<double>(lux[c]);
            off += std::abs(now - share * static_cast<double>(before[c])) * share / (1.0 - share);
            come += static_cast<double>(all[c]) + now;
        }
        if (!(come > 0.0)) continue;
        const auto size = static_cast<double>(order_.orientations[r].area);
        sum += size * off / come;
        area += size;
    }
    return area > 0.0 ? sum / area : 0.0;
}

void LightStrip::passOn(std::size_t first, std::size_t end, bool isFirst)
{
    const float kept = isFirst ? 1.0f : 0.0f;
    for (std::size_t i = first * leaving_.width; i < end * leaving_.width; ++i)
        lanes(leaving_, i) = lanes(arriving_, i) * lanes(albedo_, i) + lanes(leaving_, i) * kept;
}

bool LightStrip::endBounce(float leastGain, float seriesOff, bool isLast)
{
    const std::vector<double> lumen = lumenArrived();
    alignas(16) float weights[kMostChannels + 1] = {}; // of groups that are done: 0
    bool areDone = true;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        Group& group = groups_[g];
        if (group.isDone) continue;
        const std::size_t first = 3 * g, count = std::min<std::size_t>(3, channels_ - first);
        double arrived = 0.0, shares[3] = {};
        bool isFading = true;
        for (std::size_t c = 0; c < count; ++c) {
            const double now = lumen[first + c], before = lumenBefore_[first + c];
            arrived += now;
            isFading &= now < before || now == 0.0;
            shares[c] = now < before ? now / before : 0.0;
        }
        const double gain = static_cast<double>(leastGain), off = static_cast<double>(seriesOff) * gain;
        group.sum += arrived;
        group.isDone =
            isLast || arrived <= gain * group.sum || (off > 0.0 && isFading && offBySeries(g, shares) <= off);
        // each further bounce is taken to bring the same share of the one before
        for (std::size_t c = 0; c < count; ++c)
            weights[first + c] = static_cast<float>(group.isDone ? 1.0 / (1.0 - shares[c]) : 1.0);
        areDone &= group.isDone;
    }
    lumenBefore_ = lumen;
    const std::size_t width = all_.width;
    for (std::size_t i = 0; i < order_.size() * width; i += width) {
        for (std::size_t w = 0; w < width; ++w) {
            const Floats4 lux = lanes(arriving_, i + w);
            lanes(all_, i + w) += lux * lanesOf<Floats4>(weights, w);
            lanes(leaving_, i + w) = lux * lanes(albedo_, i + w);
        }
    }
    std::swap(arriving_, before_);
    return areDone;
}

void LightStrip::writeTo(EntryValues& lux) const
{
    float* to = lux.values.data() + firstChannel_;
    const auto stride = static_cast<std::size_t>(lux.channels);
    for (std::size_t r = 0; r < order_.size(); ++r)
        std::copy_n(all_.line(r), channels_, to + order_.entryOf[r] * stride);
}

} // namespace lightloom
