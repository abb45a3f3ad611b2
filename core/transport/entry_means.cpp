// SPDX-License-Identifier: Apache-2.0
#include "core/transport/entry_means.h"
#include "core/base/units.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lightloom {
namespace {

constexpr std::size_t kTogether = 1024; ///< voxels of a job
constexpr float kAlike = 0.70710678f;   ///< cosine of 45 degrees

/// Finds entries around an entry that belong to the same surface.
class Neighbours {
public:
    explicit Neighbours(const SurfaceVoxels& voxels) : voxels_(voxels), cell_(voxels.cellSize())
    {
        codes_.reserve(voxels.voxels.size());
        for (const glm::ivec3 voxel : voxels.voxels) codes_.push_back(mortonCode(glm::uvec3(voxel)));
    }

    /// Calls `what` with the number of each such entry, `e` of voxel `v` among them, in a fixed order.
    template<class Do>
    void around(std::size_t v, std::uint32_t e, Do what) const
    {
        const glm::ivec3 cell = voxels_.voxels[v];
        for (int i = 0; i < 27; ++i) {
            const glm::ivec3 at = cell + glm::ivec3(i % 3, i / 3 % 3, i / 9) - 1;
            if (glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, limit()))) continue;
            const std::uint64_t code = mortonCode(glm::uvec3(at));
            const auto found = std::ranges::lower_bound(codes_, code);
            if (found == codes_.end() || *found != code) continue;
            const auto other = static_cast<std::size_t>(found - codes_.begin());
            for (std::uint32_t j = voxels_.firstEntry[other]; j < voxels_.firstEntry[other + 1]; ++j)
                if (j == e || areOfOneSurface(voxels_.entries[e], voxels_.entries[j])) what(j);
        }
    }

private:
    [[nodiscard]] glm::ivec3 limit() const { return glm::ivec3(voxels_.cells); }
    [[nodiscard]] bool areOfOneSurface(const Orientation& a, const Orientation& b) const
    {
        const glm::vec3 way = b.centroid - a.centroid;
        return glm::dot(a.normal, b.normal) >= kAlike && std::abs(glm::dot(way, a.normal)) <= 0.5f * cell_ &&
               std::abs(glm::dot(way, b.normal)) <= 0.5f * cell_;
    }

    const SurfaceVoxels& voxels_;
    float cell_;
    std::vector<std::uint64_t> codes_;
};

/// Calls `what(voxel, entry)` for all entries, on all workers. False: stopped.
template<class Do>
bool forEntries(const SurfaceVoxels& voxels, Workers& workers, const std::stop_token& stop, Do what)
{
    const std::size_t count = voxels.voxels.size();
    return workers.run((count + kTogether - 1) / kTogether, stop, [&](std::size_t job) {
        for (std::size_t v = job * kTogether; v < std::min(count, (job + 1) * kTogether); ++v)
            for (std::uint32_t e = voxels.firstEntry[v]; e < voxels.firstEntry[v + 1]; ++e) what(v, e);
    });
}

/// Rows one after the other.
using Rows = std::vector<std::vector<std::pair<std::uint32_t, float>>>;
std::shared_ptr<const EntryMeans> meansOf(const Rows& rows)
{
    auto means = std::make_shared<EntryMeans>();
    for (const auto& row : rows) {
        means->first.push_back(static_cast<std::uint32_t>(means->from.size()));
        float sum = 0.0f;
        for (const auto& [entry, weight] : row) sum += weight;
        for (const auto& [entry, weight] : row) {
            means->from.push_back(entry);
            means->part.push_back(weight / sum);
        }
    }
    means->first.push_back(static_cast<std::uint32_t>(means->from.size()));
    return means;
}

/// Red, green and blue of one light group's entries, and their luminance.
std::vector<Floats4> litBy(const EntryValues& values, std::size_t firstChannel)
{
    std::vector<Floats4> lit(values.entries());
    const float* from = values.values.data() + firstChannel;
    for (Floats4& l : lit) {
        l = Floats4{from[0], from[1], from[2], luminance(glm::vec3(from[0], from[1], from[2]))};
        from += values.channels;
    }
    return lit;
}

} // namespace

EntryValues EntryMeans::of(const EntryValues& values, float within, Workers& workers, const std::stop_token& stop) const
{
    EntryValues out{values.channels, std::vector<float>(values.values.size())};
    const auto channels = static_cast<std::size_t>(values.channels);
    const std::size_t entries = values.entries();
    for (std::size_t c = 0; c < channels; c += 3) {
        const std::vector<Floats4> lit = litBy(values, c);
        const bool whole = workers.run((entries + kTogether - 1) / kTogether, stop, [&](std::size_t job) {
            for (std::size_t e = job * kTogether; e < std::min(entries, (job + 1) * kTogether); ++e) {
                const Floats4 mean = std::isinf(within) ? meanAt(e, lit) : meanWithin(e, lit, within);
                for (std::size_t k = 0; k < 3; ++k) out.values[e * channels + c + k] = mean[k];
            }
        });
        if (!whole) return {};
    }
    return out;
}

Floats4 EntryMeans::meanAt(std::size_t e, std::span<const Floats4> lit) const
{
    Floats4 sum{};
    float parts = 0.0f;
    for (std::uint32_t i = first[e]; i < first[e + 1]; ++i) {
        sum += part[i] * lit[from[i]];
        parts += part[i];
    }
    return sum / parts;
}

Floats4 EntryMeans::meanWithin(std::size_t e, std::span<const Floats4> lit, float within) const
{
    constexpr float kDark = std::numeric_limits<float>::min(); // where neither has any light
    const float here = lit[e][3];
    Floats4 sum{};
    float parts = 0.0f;
    for (std::uint32_t i = first[e]; i < first[e + 1]; ++i) {
        const Floats4 value = lit[from[i]];
        const float there = value[3], off = (there - here) / (within * std::max(here, there) + kDark);
        const float share = part[i] * std::max(0.0f, 1.0f - off * off);
        sum += share * value;
        parts += share;
    }
    return sum / parts;
}

std::shared_ptr<const EntryMeans> neighbourMeans(const SurfaceVoxels& voxels, Workers& workers,
                                                 const std::stop_token& stop)
{
    const Neighbours neighbours(voxels);
    const float reach = 2.0f * voxels.cellSize();
    Rows rows(voxels.entries.size());
    const bool whole = forEntries(voxels, workers, stop, [&](std::size_t v, std::uint32_t e) {
        const Orientation& at = voxels.entries[e];
        neighbours.around(v, e, [&](std::uint32_t j) {
            const Orientation& o = voxels.entries[j];
            const glm::vec3 tent = glm::max(glm::vec3(0.0f), 1.0f - glm::abs(o.centroid - at.centroid) / reach);
            rows[e].emplace_back(j, o.area * tent.x * tent.y * tent.z);
        });
    });
    return whole ? meansOf(rows) : nullptr;
}

std::shared_ptr<const EntryMeans> sliverMeans(const SurfaceVoxels& voxels, float share, Workers& workers,
                                              const std::stop_token& stop)
{
    const Neighbours neighbours(voxels);
    const float least = share * voxels.cellSize() * voxels.cellSize();
    std::vector<std::uint32_t> with(voxels.entries.size()); // the entry that each belongs to
    std::iota(with.begin(), with.end(), 0u);
    const bool whole = forEntries(voxels, workers, stop, [&](std::size_t v, std::uint32_t e) {
        if (voxels.entries[e].area >= least) return;
        float largest = 0.0f;
        neighbours.around(v, e, [&](std::uint32_t j) {
            const float area = voxels.entries[j].area;
            if (area >= least && area > largest) largest = area, with[e] = j;
        });
    });
    if (!whole) return nullptr;
    Rows groups(voxels.entries.size()), rows(voxels.entries.size());
    for (std::uint32_t e = 0; e < with.size(); ++e) groups[with[e]].emplace_back(e, voxels.entries[e].area);
    for (std::uint32_t e = 0; e < with.size(); ++e) rows[e] = groups[with[e]];
    return meansOf(rows);
}

} // namespace lightloom
