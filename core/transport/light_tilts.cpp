// SPDX-License-Identifier: Apache-2.0
#include "core/transport/light_tilts.h"
#include "core/base/units.h"
#include "core/transport/bright_entries.h"
#include <algorithm>

namespace lightloom {
namespace {

constexpr std::size_t kTogether = 1024; ///< entries of a job

/// Luminance that leaves each entry, of one light group after the other, and 0 where there is no partner; all 0 of a
/// group that a few entries send.
std::vector<float> luminances(const EntryValues& radiosity, const SurfaceVoxels& voxels, int directions)
{
    const std::size_t entries = voxels.entries.size(), groups = static_cast<std::size_t>(radiosity.channels) / 3;
    std::vector<float> leaving((entries + 1) * groups, 0.0f), lumen(entries);
    for (std::size_t g = 0; g < groups; ++g) {
        for (std::size_t e = 0; e < entries; ++e) {
            const float* v = &radiosity.values[(e * groups + g) * 3];
            leaving[e * groups + g] = luminance({v[0], v[1], v[2]});
            lumen[e] = voxels.entries[e].area * leaving[e * groups + g];
        }
        if (brightestOf(lumen, static_cast<std::size_t>(directions)).empty()) continue;
        for (std::size_t e = 0; e < entries; ++e) leaving[e * groups + g] = 0.0f;
    }
    return leaving;
}

/// Adds what an entry sees along a block's directions to its sums, one for each group.
void addRow(const PartnerBlock& block, std::span<const LineDirection> directions, std::size_t entry, glm::vec3 n,
            std::span<const float> leaving, std::span<glm::vec3> sums)
{
    block.withRows([&](const auto* rows) {
        for (std::size_t i = 0; i < directions.size(); ++i) {
            const float* seen = &leaving[rows[entry * PartnerBlock::kDirections + i] * sums.size()];
            const glm::vec3 way = directions[i].unit, towards = glm::dot(way, n) < 0.0f ? -way : way;
            for (std::size_t g = 0; g < sums.size(); ++g) sums[g] += seen[g] * towards;
        }
    });
}

glm::vec3 tiltOf(glm::vec3 sum, glm::vec3 n)
{
    const float along = glm::dot(sum, n);
    if (!(along > 0.0f)) return glm::vec3(0.0f);
    const glm::vec3 across = sum / along - n;
    return across * (kMostTilt / glm::max(kMostTilt, glm::length(across)));
}

} // namespace

EntryValues lightTilts(const RayScene& rays, const SurfaceVoxels& voxels, const VoxelOrders& orders,
                       const EntryValues& radiosity, int directions, Workers& workers, const std::stop_token& stop,
                       const PartnerTable* stored)
{
    const std::size_t entries = voxels.entries.size(), groups = static_cast<std::size_t>(radiosity.channels) / 3;
    const std::vector<LineDirection> set = directionSet(directions);
    const std::vector<float> leaving = luminances(radiosity, voxels, directions);
    std::vector<glm::vec3> sums(entries * groups, glm::vec3(0.0f));
    BlockWalker walker(rays, voxels, orders, set);
    const auto forEntries = [&](const auto& body) {
        return workers.run((entries + kTogether - 1) / kTogether, stop, [&](std::size_t job) {
            for (std::size_t e = job * kTogether; e < std::min(entries, (job + 1) * kTogether); ++e)
                body(e, voxels.entries[e].normal, std::span(sums).subspan(e * groups, groups));
        });
    };
    for (std::size_t first = 0; first < set.size(); first += PartnerBlock::kDirections) {
        const std::size_t number = first / PartnerBlock::kDirections;
        const std::size_t count = std::min(set.size() - first, PartnerBlock::kDirections);
        const bool isStored = stored && static_cast<std::size_t>(stored->directions()) >= first + count;
        const PartnerBlock walked = isStored ? PartnerBlock() : walker.walk(number);
        const PartnerBlock& block = isStored ? stored->block(number) : walked;
        const std::span<const LineDirection> ways = std::span(set).subspan(first, count);
        const auto add = [&](std::size_t e, glm::vec3 n, std::span<glm::vec3> of) {
            addRow(block, ways, e, n, leaving, of);
        };
        if (!forEntries(add)) return {};
    }
    EntryValues tilts{radiosity.channels, std::vector<float>(radiosity.values.size())};
    const bool all = forEntries([&](std::size_t e, glm::vec3 n, std::span<glm::vec3> of) {
        for (std::size_t g = 0; g < groups; ++g) {
            const glm::vec3 tilt = tiltOf(of[g], n);
            for (int k = 0; k < 3; ++k) tilts.values[(e * groups + g) * 3 + static_cast<std::size_t>(k)] = tilt[k];
        }
    });
    return all ? tilts : EntryValues{};
}

} // namespace lightloom
