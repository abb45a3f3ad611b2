// SPDX-License-Identifier: Apache-2.0
#include "core/voxel/ray_correction.h"
#include "core/base/units.h"
#include <algorithm>
#include <limits>

namespace lightloom {
namespace {

constexpr int kRounds = 2;     ///< of means: four voxels wide each way
constexpr float kApart = 4.0f; ///< neighbours that err apart, of the thirteen or so which two rounds count

constexpr float kAnyLight = std::numeric_limits<float>::infinity();

void put(EntryValues& into, std::size_t i, glm::vec3 value)
{
    for (std::size_t k = 0; k < 3; ++k) into.values[i + k] = value[static_cast<int>(k)];
}

/// Each entry's values by its share.
EntryValues weighed(EntryValues values, const std::vector<float>& open)
{
    const auto channels = static_cast<std::size_t>(values.channels);
    for (std::size_t i = 0; i < values.values.size(); ++i) values.values[i] *= open[i / channels];
    return values;
}

/// The shares as values of one light group, which means are divided by.
EntryValues asValues(const std::vector<float>& open)
{
    EntryValues values{3, std::vector<float>(3 * open.size())};
    for (std::size_t i = 0; i < values.values.size(); ++i) values.values[i] = open[i / 3];
    return values;
}

} // namespace

EntryValues correctedByRays(EntryValues lines, const EntryValues& rays, const std::vector<float>& open,
                            const EntryMeans& neighbours, Workers& workers, const std::stop_token& stop)
{
    const auto channels = static_cast<std::size_t>(lines.channels);
    EntryValues byLines = weighed(lines, open), byRays = weighed(rays, open), squares = lines, shares = asValues(open);
    for (std::size_t i = 0; i < lines.values.size(); i += 3) {
        const float off = luminance(rays.groupAt(i)) - luminance(lines.groupAt(i));
        put(squares, i, glm::vec3(open[i / channels] * off * off));
    }
    for (int round = 0; round < kRounds; ++round) {
        for (EntryValues* values : {&byLines, &byRays, &squares, &shares}) {
            *values = neighbours.of(*values, kAnyLight, workers, stop);
            if (values->values.empty()) return {};
        }
    }
    for (std::size_t i = 0; i < lines.values.size(); i += 3) {
        const float share = shares.values[3 * (i / channels)];
        if (!(share > 0.0f)) continue;
        const glm::vec3 off = (byRays.groupAt(i) - byLines.groupAt(i)) / share;
        const float square = luminance(off) * luminance(off);
        const float spread = std::max(0.0f, squares.values[i] / share - square) / kApart;
        if (square <= spread) continue;
        put(lines, i, glm::max(glm::vec3(0.0f), lines.groupAt(i) + (1.0f - spread / square) * off));
    }
    return lines;
}

EntryValues spreadIntoHidden(EntryValues lux, const std::vector<float>& open, const EntryMeans& neighbours,
                             Workers& workers, const std::stop_token& stop)
{
    const auto channels = static_cast<std::size_t>(lux.channels);
    const EntryValues around = neighbours.of(weighed(lux, open), kAnyLight, workers, stop),
                      shares = neighbours.of(asValues(open), kAnyLight, workers, stop);
    if (around.values.empty() || shares.values.empty()) return {};
    for (std::size_t i = 0; i < lux.values.size(); i += 3) {
        const float own = open[i / channels], share = shares.values[3 * (i / channels)];
        if (own >= 1.0f || !(share > 0.0f)) continue;
        put(lux, i, glm::mix(around.groupAt(i) / share, lux.groupAt(i), own));
    }
    return lux;
}

} // namespace lightloom
