// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

namespace lightloom {

/// Boxes in an order that keeps near ones together, to ask which lie near a point: eight to a group, the groups' bounds
/// again eight to a group, and so on. Any thread may ask.
class BoxGroups {
public:
    /// Along the axes; empty until something is added.
    struct Box {
        glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
        void add(glm::vec3 p) { low = glm::min(low, p), high = glm::max(high, p); }
    };

    BoxGroups() = default;
    explicit BoxGroups(std::span<const Box> boxes); ///< O(n); fewer than 2^32

    /// Memory of one thread.
    struct Near {
        std::vector<std::uint64_t> keys, work;
    };
    /// Of the boxes that come within the root of `squared` of `p`: keys (least_keys.h) of their distance and number, by
    /// rising number. Valid until the next call with `near`.
    [[nodiscard]] std::span<std::uint64_t> within(glm::vec3 p, float squared, Near& near) const;
    [[nodiscard]] std::size_t memoryBytes() const { return groups_.size() * sizeof(Group); }

    /// How many of `count` things, ordered by parting them again and again, go to the first part: about half, and so
    /// that groups are made of what was parted last.
    [[nodiscard]] static std::uint32_t firstPart(std::uint32_t count);

private:
    static constexpr std::size_t kWidth = 8;
    struct alignas(32) Group {
        float low[3][kWidth], high[3][kWidth]; // unused places: boxes that are empty
    };
    static std::size_t open(const Group* level, const std::uint64_t* from, std::size_t count, const float* p,
                            float squared, std::uint64_t* to);
    std::vector<Group> groups_;             // level by level, from the boxes up
    std::vector<std::size_t> firstOfLevel_; // the last has one group
};

} // namespace lightloom
