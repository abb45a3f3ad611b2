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
    [[nodiscard]] Box box(std::size_t number) const { return boxOf(groups_[number / kWidth], number % kWidth); }
    /// Whether `is(number)` holds for one of the boxes for which, and for whose bounds, `may(low, high)` holds.
    template<class May, class Is>
    [[nodiscard]] bool any(const May& may, const Is& is) const
    {
        return !groups_.empty() && any(firstOfLevel_.size() - 1, 0, may, is);
    }
    [[nodiscard]] std::size_t memoryBytes() const { return groups_.size() * sizeof(Group); }

    /// How many of `count` things, ordered by parting them again and again, go to the first part: about half, and so
    /// that groups are made of what was parted last.
    [[nodiscard]] static std::uint32_t firstPart(std::uint32_t count);

private:
    static constexpr std::size_t kWidth = 8;
    struct alignas(32) Group {
        float low[3][kWidth], high[3][kWidth]; // unused places: boxes that are empty
    };
    static Box boxOf(const Group& group, std::size_t i)
    {
        return {{group.low[0][i], group.low[1][i], group.low[2][i]},
                {group.high[0][i], group.high[1][i], group.high[2][i]}};
    }
    template<class May, class Is>
    [[nodiscard]] bool any(std::size_t level, std::size_t number, const May& may, const Is& is) const
    {
        const Group& group = groups_[firstOfLevel_[level] + number];
        for (std::size_t i = 0; i < kWidth; ++i) {
            const Box box = boxOf(group, i);
            if (!(box.low.x <= box.high.x) || !may(box.low, box.high)) continue;
            const std::size_t member = number * kWidth + i;
            if (level == 0 ? is(member) : any(level - 1, member, may, is)) return true;
        }
        return false;
    }
    static std::size_t open(const Group* level, const std::uint64_t* from, std::size_t count, const float* p,
                            float squared, std::uint64_t* to);
    std::vector<Group> groups_;             // level by level, from the boxes up
    std::vector<std::size_t> firstOfLevel_; // the last has one group
};

} // namespace lightloom
