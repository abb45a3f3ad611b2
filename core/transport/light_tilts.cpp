// SPDX-License-Identifier: Apache-2.0
#include "core/transport/light_tilts.h"
#include "core/base/units.h"
#include "core/base/wide_vectors.h"
#include "core/transport/bright_entries.h"
#include <algorithm>

namespace lightloom {
namespace {

constexpr std::size_t kTogether = 1024; ///< rows of a job

/// Luminance that leaves each row's entry, of one light group after the other, and 0 where there is no partner; all 0
/// of a group that a few entries send.
std::vector<float> luminances(const EntryValues& radiosity, const RowOrder& order, int directions)
{
    const std::size_t rows = order.size(), groups = static_cast<std::size_t>(radiosity.channels) / 3;
    std::vector<float> leaving((rows + 1) * groups, 0.0f), lumen(rows);
    for (std::size_t g = 0; g < groups; ++g) {
        for (std::size_t r = 0; r < rows; ++r) {
            const float* v = &radiosity.values[(order.entryOf[r] * groups + g) * 3];
            leaving[r * groups + g] = luminance({v[0], v[1], v[2]});
            lumen[r] = order.orientations[r].area * leaving[r * groups + g];
        }
        if (brightestOf(lumen, static_cast<std::size_t>(directions)).empty()) continue;
        for (std::size_t r = 0; r < rows; ++r) leaving[r * groups + g] = 0.0f;
    }
    return leaving;
}

struct Rows {
    const RowOrder& order;
    std::size_t first, end;
};

/// Adds what rows see along a block's directions to their sums, one for each group.
template<class Number>
void addRows(const Number* partners, std::span<const LineDirection> directions, const Rows& rows,
             std::span<const float> leaving, std::size_t groups, std::span<Floats4> sums)
{
    Floats4 ways[PartnerBlock::kDirections] = {}; // towards what entries of normal `faced` see
    glm::vec3 faced(0.0f);
    for (std::size_t r = rows.first; r < rows.end; ++r) {
        const glm::vec3 n = rows.order.orientations[r].normal;
        for (std::size_t i = 0; n != faced && i < directions.size(); ++i) {
            const glm::vec3 way = directions[i].unit, towards = glm::dot(way, n) < 0.0f ? -way : way;
            ways[i] = Floats4{towards.x, towards.y, towards.z, 0.0f};
        }
        faced = n;
        const Number* row = partners + r * PartnerBlock::kDirections;
        for (std::size_t g = 0; g < groups; ++g) {
            Floats4 sum = sums[r * groups + g];
            for (std::size_t i = 0; i < directions.size(); ++i) sum += leaving[row[i] * groups + g] * ways[i];
            sums[r * groups + g] = sum;
        }
    }
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
    const RowOrder& order = *orders.rows();
    const std::size_t entries = order.size(), groups = static_cast<std::size_t>(radiosity.channels) / 3;
    const std::vector<LineDirection> set = directionSet(directions);
    const std::vector<float> leaving = luminances(radiosity, order, directions);
    std::vector<Floats4> sums(entries * groups, Floats4{});
    BlockWalker walker(rays, voxels, orders, set);
    const auto forRows = [&](const auto& body) {
        return workers.run((entries + kTogether - 1) / kTogether, stop, [&](std::size_t job) {
            body(Rows{order, job * kTogether, std::min(entries, (job + 1) * kTogether)});
        });
    };
    for (std::size_t first = 0; first < set.size(); first += PartnerBlock::kDirections) {
        const std::size_t number = first / PartnerBlock::kDirections;
        const std::size_t count = std::min(set.size() - first, PartnerBlock::kDirections);
        const bool isStored = stored && static_cast<std::size_t>(stored->directions()) >= first + count;
        const PartnerBlock walked = isStored ? PartnerBlock() : walker.walk(number);
        const PartnerBlock& block = isStored ? stored->block(number) : walked;
        const std::span<const LineDirection> ways = std::span(set).subspan(first, count);
        const auto add = [&](const Rows& rows) {
            if (block.isNarrow())
                addRows(block.rows<std::uint16_t>(), ways, rows, leaving, groups, sums);
            else
                addRows(block.rows<std::uint32_t>(), ways, rows, leaving, groups, sums);
        };
        if (!forRows(add)) return {};
    }
    EntryValues tilts{radiosity.channels, std::vector<float>(radiosity.values.size())};
    const bool all = forRows([&](const Rows& rows) {
        for (std::size_t r = rows.first; r < rows.end; ++r) {
            for (std::size_t g = 0; g < groups; ++g) {
                const Floats4 sum = sums[r * groups + g];
                const glm::vec3 tilt = tiltOf({sum[0], sum[1], sum[2]}, order.orientations[r].normal);
                for (int k = 0; k < 3; ++k)
                    tilts.values[(order.entryOf[r] * groups + g) * 3 + static_cast<std::size_t>(k)] = tilt[k];
            }
        }
    });
    return all ? tilts : EntryValues{};
}

} // namespace lightloom
