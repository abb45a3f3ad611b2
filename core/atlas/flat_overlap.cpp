// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/flat_overlap.h"
#include <algorithm>
#include <limits>
#include <set>
#include <tuple>

namespace lightloom {
namespace {

using Triangle2 = std::array<glm::dvec2, 3>;

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }
double twiceArea(const Triangle2& t) { return cross(t[1] - t[0], t[2] - t[0]); }

/// How far two triangles reach into each other along the edge normals of the first; least of the three.
double depthAlong(const Triangle2& a, const Triangle2& b)
{
    const double turn = twiceArea(a) > 0.0 ? 1.0 : -1.0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 edge = a[(k + 1) % 3] - a[k];
        const glm::dvec2 inwards = glm::dvec2(-edge.y, edge.x) * (turn / std::max(glm::length(edge), 1e-300));
        double deepest = -std::numeric_limits<double>::infinity();
        for (const glm::dvec2 p : b) deepest = std::max(deepest, glm::dot(inwards, p - a[k]));
        least = std::min(least, deepest);
    }
    return least;
}

struct Interval {
    double low, high;
};

/// The sweep: a vertical line goes to the right; the triangles that it cuts, from below. As long as none overlap, any
/// two of them lie one above the other at all places that both have, so that the order never changes.
class Sweep {
public:
    Sweep(const std::vector<Triangle2>& triangles, double tolerance) : tolerance_(tolerance), cut_(Below{this})
    {
        for (Triangle2 t : triangles) {
            std::ranges::sort(t, [](glm::dvec2 a, glm::dvec2 b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
            triangles_.push_back(t);
        }
    }

    OverlapSearch run(const std::stop_token& stop)
    {
        struct Event {
            double x;
            bool isStart; // ends first: what only touches at a place is never cut at once
            std::uint32_t triangle;
            bool operator<(const Event& o) const
            {
                return std::tie(x, isStart, triangle) < std::tie(o.x, o.isStart, o.triangle);
            }
        };
        std::vector<Event> events;
        for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
            const Triangle2& t = triangles_[i];
            if (twiceArea(t) == 0.0 || !(t[0].x < t[2].x)) continue;
            events.push_back({t[0].x, true, i});
            events.push_back({t[2].x, false, i});
        }
        std::sort(events.begin(), events.end());
        std::vector<Cut::iterator> places(triangles_.size(), cut_.end());
        for (const Event& event : events) {
            if (stop.stop_requested() || found_.pair) break;
            if (event.isStart) {
                places[event.triangle] = cut_.insert(event.triangle);
                meetNeighbours(places[event.triangle]);
            } else {
                const auto above = cut_.erase(places[event.triangle]);
                if (above != cut_.end() && above != cut_.begin()) (void)meet(*std::prev(above), *above);
            }
        }
        return found_;
    }

private:
    struct Below {
        Sweep* sweep;
        bool operator()(std::uint32_t a, std::uint32_t b) const { return sweep->isBelow(a, b); }
    };
    using Cut = std::multiset<std::uint32_t, Below>;

    /// Of a triangle with its corners from left to right, where the line at `x` cuts it.
    static Interval at(const Triangle2& t, double x)
    {
        const auto on = [x](glm::dvec2 a, glm::dvec2 b) {
            return b.x > a.x ? glm::mix(a.y, b.y, glm::clamp((x - a.x) / (b.x - a.x), 0.0, 1.0)) : b.y;
        };
        const double one = on(t[0], t[2]), other = x < t[1].x ? on(t[0], t[1]) : on(t[1], t[2]);
        return {std::min(one, other), std::max(one, other)};
    }
    /// In the middle of the stretch that both have: there they are apart, even if they start at one corner.
    std::pair<Interval, Interval> inTheMiddle(std::uint32_t a, std::uint32_t b) const
    {
        const Triangle2 &t = triangles_[a], &u = triangles_[b];
        const double x = 0.5 * (std::max(t[0].x, u[0].x) + std::min(t[2].x, u[2].x));
        return {at(t, x), at(u, x)};
    }
    bool isBelow(std::uint32_t a, std::uint32_t b)
    {
        ++found_.comparisons;
        const auto [ofA, ofB] = inTheMiddle(a, b);
        return ofA.low + ofA.high < ofB.low + ofB.high;
    }
    bool meet(std::uint32_t a, std::uint32_t b)
    {
        ++found_.comparisons;
        const Triangle2 &t = triangles_[a], &u = triangles_[b];
        if (!(depthAlong(t, u) > tolerance_ && depthAlong(u, t) > tolerance_)) return false;
        found_.pair = std::minmax(std::size_t(a), std::size_t(b));
        return true;
    }
    /// The neighbours on both sides, and further on as long as there are only some that are thinner than the tolerance.
    void meetNeighbours(Cut::iterator place)
    {
        const auto isNear = [&](std::uint32_t other) {
            const auto [mine, its] = inTheMiddle(*place, other);
            return its.low <= mine.high + 2.0 * tolerance_ && mine.low <= its.high + 2.0 * tolerance_;
        };
        for (auto above = std::next(place); above != cut_.end(); ++above) {
            if (meet(*place, *above) || !isNear(*above)) break;
        }
        for (auto below = place; below != cut_.begin();) {
            --below;
            if (meet(*place, *below) || !isNear(*below)) break;
        }
    }

    std::vector<Triangle2> triangles_; // corners from left to right
    double tolerance_;
    OverlapSearch found_;
    Cut cut_;
};

} // namespace

OverlapSearch findOverlap(const std::vector<std::array<glm::dvec2, 3>>& triangles, double tolerance,
                          const std::stop_token& stop)
{
    return Sweep(triangles, tolerance).run(stop);
}

} // namespace lightloom
