// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/trace/side_elements.h"
#include <functional>
#include <optional>
#include <vector>

namespace lightloom {

/// A point in the open, moved off its surface.
struct OpenPoint {
    glm::vec3 p, n;
    std::uint32_t element;
};

/// Open points in the order of the Morton curve: neighbours in the list are neighbours in space, mostly.
class OpenPoints {
public:
    OpenPoints() = default;
    OpenPoints(const Bounds& bounds, const std::vector<OpenPoint>& points);

    [[nodiscard]] std::size_t size() const { return points_.size(); }
    [[nodiscard]] const std::vector<OpenPoint>& all() const { return points_; }
    [[nodiscard]] const Bounds& box() const { return box_; } ///< of the points
    /// One of them at random, or at random among those near `p`.
    [[nodiscard]] const OpenPoint& pick(Rng& rng) const { return points_[rng.bits() % points_.size()]; }
    [[nodiscard]] const OpenPoint& pickNear(glm::vec3 p, Rng& rng) const;
    /// Whether `here` sees one of them, both before themselves: `tries` lines of sight, half of them nearby. Never in
    /// an empty list.
    [[nodiscard]] bool isSeenFrom(const RayScene& rays, const OpenPoint& here, std::size_t tries, Rng& rng) const;

private:
    [[nodiscard]] std::uint64_t codeOf(glm::vec3 p) const;
    Bounds bounds_, box_;
    std::vector<std::uint64_t> codes_;
    std::vector<OpenPoint> points_; // copies, one after another, because they are picked at random a million times
};

/// Where a ray met a surface, as an open point.
[[nodiscard]] OpenPoint openPointAt(const RayScene& rays, const SideElements& elements, const Hit& hit);

/// Runs blocks that find open points on all workers and adds these to `points` in the order of the blocks. False:
/// stopped.
[[nodiscard]] bool collectPoints(std::size_t blocks, Workers& workers, const std::stop_token& stop,
                                 std::vector<OpenPoint>& points,
                                 const std::function<void(std::size_t block, std::vector<OpenPoint>& found)>& body);

/// What light gets to from some points by any number of bounces: elements that a random walk meets, and those that see
/// something it met; glass that is reached from one side is reached on both.
struct Flooded {
    std::vector<std::uint8_t> isReached; ///< by element
    OpenPoints points;                   ///< the first that was found on each element
};

/// Floods from `starts`. Only points pass light on, never elements: an element that is half under a block is reached,
/// but what lies under the block sees none of its open points. `walks`, a multiple of 512: how many set out at a time,
/// four times. Deterministic on any number of threads. Null: stopped.
[[nodiscard]] std::unique_ptr<const Flooded> floodFrom(const RayScene& rays, const SideElements& elements,
                                                       const std::vector<OpenPoint>& starts, std::uint32_t walks,
                                                       Workers& workers, const std::stop_token& stop);

} // namespace lightloom
