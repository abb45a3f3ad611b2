// SPDX-License-Identifier: Apache-2.0
#include "core/voxel/ray_correction.h"
#include "core/base/units.h"
#include <algorithm>
#include <limits>

namespace lightloom {
namespace {

constexpr int kRounds = 2; ///< of means: four voxels wide each way

glm::vec3 groupAt(const EntryValues& of, std::size_t i) { return {of.values[i], of.values[i + 1], of.values[i + 2]}; }

} // namespace

EntryValues correctedByRays(EntryValues lines, const EntryValues& rays, const EntryMeans& neighbours, Workers& workers,
                            const std::stop_token& stop)
{
    EntryValues byLines = lines, byRays = rays, squares = lines;
    for (std::size_t i = 0; i < lines.values.size(); i += 3) {
        const float off = luminance(groupAt(rays, i)) - luminance(groupAt(lines, i));
        for (std::size_t k = 0; k < 3; ++k) squares.values[i + k] = off * off;
    }
    for (int round = 0; round < kRounds; ++round) {
        for (EntryValues* values : {&byLines, &byRays, &squares}) {
            *values = neighbours.of(*values, std::numeric_limits<float>::infinity(), workers, stop);
            if (values->values.empty()) return {};
        }
    }
    for (std::size_t i = 0; i < lines.values.size(); i += 3) {
        const glm::vec3 off = groupAt(byRays, i) - groupAt(byLines, i);
        const float square = luminance(off) * luminance(off), spread = std::max(0.0f, squares.values[i] - square);
        if (square <= spread) continue;
        const glm::vec3 put = glm::max(glm::vec3(0.0f), groupAt(lines, i) + (1.0f - spread / square) * off);
        for (std::size_t k = 0; k < 3; ++k) lines.values[i + k] = put[static_cast<int>(k)];
    }
    return lines;
}

} // namespace lightloom
