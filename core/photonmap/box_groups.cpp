// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/box_groups.h"
#include "core/base/wide_vectors.h"
#include <algorithm>
#include <cstring>

namespace lightloom {

BoxGroups::BoxGroups(std::span<const Box> boxes)
{
    static_assert(kWidth == kLanes);
    std::vector<Box> level(boxes.begin(), boxes.end());
    while (!level.empty()) {
        firstOfLevel_.push_back(groups_.size());
        std::vector<Box> above((level.size() + kWidth - 1) / kWidth);
        for (std::size_t i = 0; i < above.size() * kWidth; ++i) {
            const Box box = i < level.size() ? level[i] : Box{};
            if (i % kWidth == 0) groups_.emplace_back();
            for (int axis = 0; axis < 3; ++axis) {
                groups_.back().low[axis][i % kWidth] = box.low[axis];
                groups_.back().high[axis][i % kWidth] = box.high[axis];
            }
            above[i / kWidth].add(box.low);
            above[i / kWidth].add(box.high);
        }
        if (above.size() == 1) return;
        level = std::move(above);
    }
}

std::uint32_t BoxGroups::firstPart(std::uint32_t count)
{
    std::uint32_t unit = 1; // the largest whole groups
    while (unit < (count + kWidth - 1) / kWidth) unit *= kWidth;
    return glm::max(1u, (count / 2 + unit / 2) / unit) * unit;
}

/// Writes the members of `count` groups that come near enough; eight numbers more may be written to.
LIGHTLOOM_WIDE_VECTORS std::size_t BoxGroups::open(const Group* level, const std::uint64_t* from, std::size_t count,
                                                   const float* p, float squared, std::uint64_t* to)
{
    std::uint64_t* next = to;
    for (std::size_t g = 0; g < count; ++g) {
        const auto number = static_cast<std::uint32_t>(from[g]);
        const Group& group = level[number];
        Floats8 distance{};
        for (int axis = 0; axis < 3; ++axis) {
            const Floats8 under = lanesOf<Floats8>(group.low[axis], 0) - p[axis];
            const Floats8 over = p[axis] - lanesOf<Floats8>(group.high[axis], 0);
            const Floats8 beside = under > over ? under : over;
            const Floats8 gap = beside > 0.0f ? beside : Floats8{};
            distance += gap * gap;
        }
        const Ints8 isNear = distance <= squared;
        Ints8 bits;
        std::memcpy(&bits, &distance, sizeof bits);
        for (std::size_t i = 0; i < kWidth; ++i) {
            *next = std::uint64_t(static_cast<std::uint32_t>(bits[i])) << 32 | (std::uint64_t(number) * kWidth + i);
            next -= isNear[i];
        }
    }
    return static_cast<std::size_t>(next - to);
}

std::span<std::uint64_t> BoxGroups::within(glm::vec3 p, float squared, Near& near) const
{
    near.keys.resize(std::max<std::size_t>(near.keys.size(), 1));
    near.keys[0] = 0;
    std::size_t count = groups_.empty() ? 0 : 1;
    for (std::size_t level = firstOfLevel_.size(); level-- > 0;) {
        near.work.resize(std::max(near.work.size(), (count + 1) * kWidth));
        count = open(groups_.data() + firstOfLevel_[level], near.keys.data(), count, &p.x, squared, near.work.data());
        std::swap(near.keys, near.work);
    }
    return std::span(near.keys).first(count);
}

} // namespace lightloom
