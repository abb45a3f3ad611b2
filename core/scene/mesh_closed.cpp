// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mesh_closed.h"
#include "core/base/rng.h"
#include <cmath>
#include <unordered_map>
#include <utility>

namespace lightloom {
namespace {

/// Vertices in a grid of cells four tolerances wide: what a vertex may join lies in at most 8 of them, mostly in one.
class VertexGrid {
public:
    VertexGrid(std::span<const glm::vec3> positions, float tolerance)
        : positions_(positions), tolerance_(tolerance), cell_(4.0 * static_cast<double>(tolerance)),
          next_(positions.size(), kNone)
    {
        first_.reserve(positions.size());
    }

    /// The vertex that stands for `v`: one already there, or itself.
    std::uint32_t join(std::uint32_t v)
    {
        const glm::vec3 p = positions_[v], reach(tolerance_);
        const glm::i64vec3 low = cellOf(p - reach), high = cellOf(p + reach);
        for (auto z = low.z; z <= high.z; ++z) {
            for (auto y = low.y; y <= high.y; ++y) {
                for (auto x = low.x; x <= high.x; ++x) {
                    const std::uint32_t found = find({x, y, z}, p);
                    if (found != kNone) return found;
                }
            }
        }
        const auto [entry, isNew] = first_.try_emplace(key(cellOf(p)), v);
        if (!isNew) next_[v] = std::exchange(entry->second, v);
        return v;
    }

private:
    static constexpr std::uint32_t kNone = ~0u;

    [[nodiscard]] glm::i64vec3 cellOf(glm::vec3 p) const { return glm::i64vec3(glm::floor(glm::dvec3(p) / cell_)); }
    /// Two cells with one key share a list, which costs time only: distances are compared anyway.
    static std::uint64_t key(glm::i64vec3 c)
    {
        return mixBits(mixBits(mixBits(static_cast<std::uint64_t>(c.x)) + static_cast<std::uint64_t>(c.y)) +
                       static_cast<std::uint64_t>(c.z));
    }
    [[nodiscard]] std::uint32_t find(glm::i64vec3 cell, glm::vec3 p) const
    {
        const auto entry = first_.find(key(cell));
        if (entry == first_.end()) return kNone;
        for (std::uint32_t v = entry->second; v != kNone; v = next_[v]) {
            if (glm::distance(positions_[v], p) <= tolerance_) return v;
        }
        return kNone;
    }

    std::span<const glm::vec3> positions_;
    float tolerance_;
    double cell_;
    std::unordered_map<std::uint64_t, std::uint32_t> first_; ///< last vertex put into a cell; `next_` leads on
    std::vector<std::uint32_t> next_;
};

} // namespace

std::vector<std::uint32_t> weldVertices(std::span<const glm::vec3> positions, float tolerance)
{
    VertexGrid grid(positions, tolerance);
    std::vector<std::uint32_t> standIn(positions.size());
    for (std::uint32_t v = 0; v < standIn.size(); ++v) standIn[v] = grid.join(v);
    return standIn;
}

void EdgeBalance::add(glm::uvec3 t)
{
    const std::uint32_t ring[4] = {t.x, t.y, t.z, t.x};
    for (int i = 0; i < 3; ++i) {
        const std::uint64_t a = ring[i], b = ring[i + 1];
        if (a < b) sum_ += mixBits(a << 32 | b);
        if (a > b) sum_ -= mixBits(b << 32 | a);
    }
}

} // namespace lightloom
