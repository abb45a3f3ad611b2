// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/screen_finder.h"
#include "core/base/units.h"
#include <algorithm>
#include <cmath>
#include <glm/gtx/component_wise.hpp>

namespace lightloom {
namespace {

constexpr float kSameSurface = 0.5f; ///< cosine above which a hit is the surface itself, as gathers take it
constexpr float kSlack = 0.03f;      ///< of the height: surface that far behind a wall's plane is still before it
constexpr float kGrazing = 0.05f;    ///< cosine to a wall's normal at which a wedge has to end
constexpr float kNearest = 4.0f;     ///< heights, of what hides all beyond: within a cell the surface may bend
constexpr float kTurn = 2.0f * kPi / 16.0f;

glm::vec3 direction(const Frame& frame, float turns)
{
    return std::cos(turns * kTurn) * frame.tangent + std::sin(turns * kTurn) * frame.bitangent;
}

} // namespace

/// What is seen in one direction: a wall, or nothing that parts the surface.
struct ScreenFinder::Sight {
    bool isWall = false;
    glm::vec3 away{0.0f}; ///< into the wall
    float behind = 0.0f;  ///< distance of its plane from where one looks
    [[nodiscard]] bool isSameWall(const Sight& o, float slack) const
    {
        return isWall && o.isWall && glm::dot(away, o.away) > 0.9999f && std::abs(behind - o.behind) < slack;
    }

    /// How far beyond `here` it goes on towards the next direction, `there`, where no other wall is met: half way if it
    /// ends in the open; further where that direction does not meet its plane.
    [[nodiscard]] float openEnd(glm::vec3 here, glm::vec3 there) const
    {
        const float front = glm::dot(away, here), side = glm::dot(away, there);
        return side <= 0.0f ? glm::clamp((front - kGrazing) / (front - side), 0.5f, 1.0f) : 0.5f;
    }
};

namespace {

/// Where walls a, met in direction number `at`, and b, met in the next, part: in turns from `at`. In their corner, or
/// half way where that is not between the two.
template<class Sight>
float partingOf(const Sight& a, const Sight& b, const Frame& frame, float at)
{
    const auto flat = [&](glm::vec3 v) { return glm::vec2(glm::dot(v, frame.tangent), glm::dot(v, frame.bitangent)); };
    const glm::vec2 p = flat(a.away), q = flat(b.away);
    const float across = p.x * q.y - p.y * q.x;
    if (std::abs(across) < 1e-3f) return 0.5f;
    const glm::vec2 corner = glm::vec2(a.behind * q.y - b.behind * p.y, b.behind * p.x - a.behind * q.x) / across;
    const glm::vec2 here = flat(direction(frame, at));
    const float turns = std::atan2(here.x * corner.y - here.y * corner.x, glm::dot(here, corner)) / kTurn;
    return turns > 0.0f && turns < 1.0f ? turns : 0.5f;
}

} // namespace

ScreenFinder::ScreenFinder(const RayScene& rays, const LightReach& reach, const SurfaceArea& area)
    : rays_(rays), area_(area), isReached_(2 * std::size_t(rays.triangleCount()), false)
{
    for (const ReachedFacet& facet : reach.facets()) isReached_[facet.side] = true;
}

glm::vec3 ScreenFinder::lifted(glm::vec3 p, glm::vec3 n, float height) const
{
    Hit hit;
    glm::vec3 from = rays_.leave(p, n);
    if (!rays_.intersect(from, n, 2.0f * height, hit)) return p + height * n;
    if (!isReached(hit)) { // the mean of a bulging surface lies below it
        from = rays_.leave(hit.position, n);
        if (!rays_.intersect(from, n, 2.0f * height, hit)) return from + height * n;
    }
    return from + 0.5f * hit.distance * n;
}

bool ScreenFinder::lookAround(glm::vec3 from, const Frame& frame, std::array<Sight, kDirections>& sights) const
{
    std::size_t dark = 0;
    for (std::size_t first = 0; first < kDirections; first += Rays8::kCount) {
        Rays8 rays;
        Met8 met;
        for (std::size_t i = 0; i < Rays8::kCount; ++i) {
            const glm::vec3 travel = direction(frame, static_cast<float>(first + i));
            for (int axis = 0; axis < 3; ++axis) rays.origin[axis][i] = from[axis], rays.travel[axis][i] = travel[axis];
        }
        rays_.intersect(rays, Rays8::kCount, met);
        for (std::size_t i = 0; i < Rays8::kCount; ++i) {
            if (met.triangle[i] == Met8::kNothing) continue;
            const Hit hit = rays_.hitOf(rays, met, i);
            if (!isReached(hit)) {
                ++dark;
            } else if (glm::dot(hit.facing(), frame.normal) < kSameSurface) {
                sights[first + i] = {true, -hit.facing(), -glm::dot(hit.facing(), hit.position - from)};
            }
        }
    }
    return dark < kDirections / 2; // in a wall some ways may lead to a side that is reached elsewhere
}

void ScreenFinder::addSlab(glm::vec3 p, glm::vec3 n, float height, float radius, std::vector<Screen>& out) const
{
    const auto add = [&](glm::vec3 away, float behind) {
        const Screen screen = Screen::beyond(away, std::max(behind, kNearest * height));
        if (isAnyHidden(screen, p, n, radius)) out.push_back(screen);
    };
    Hit over, ground, under;
    const glm::vec3 above = lifted(p, n, height);
    if (rays_.intersect(above, n, radius, over)) add(n, glm::dot(n, over.position - p));
    if (!rays_.intersect(above, -n, radius, ground)) return;
    if (!rays_.intersect(rays_.leave(ground.position, -n), -n, radius, under)) return;
    // the back of a solid, or what a sheet lies over
    add(-n, glm::dot(n, p - ground.position) + (under.isFront ? 0.5f : 1.0f) * under.distance);
}

bool ScreenFinder::find(glm::vec3 p, glm::vec3 n, float height, float radius, std::vector<Screen>& out) const
{
    const Frame frame(n);
    const float slack = kSlack * height;
    const glm::vec3 from = lifted(p, n, height);
    std::array<Sight, kDirections> sights;
    if (!lookAround(from, frame, sights)) return false;
    const auto at = [&](std::size_t i) -> const Sight& { return sights[i % kDirections]; };
    std::size_t begin = 0; // where a wall begins, or nothing is
    while (begin < kDirections && at(begin).isSameWall(at(begin + kDirections - 1), slack)) ++begin;
    for (std::size_t i = begin; i < begin + kDirections; ++i) {
        const std::size_t first = i;
        while (i + 1 < begin + kDirections && at(i).isSameWall(at(i + 1), slack)) ++i;
        const Sight& wall = at(first);
        if (!wall.isWall) continue;
        const Sight &before = at(first + kDirections - 1), &next = at(i + 1);
        const auto low = static_cast<float>(first), high = static_cast<float>(i);
        const auto towards = [&](float turns) { return direction(frame, turns); };
        const float begins = before.isWall ? low - 1.0f + partingOf(before, wall, frame, low - 1.0f)
                                           : low - wall.openEnd(towards(low), towards(low - 1.0f));
        const float ends = high + (next.isWall ? partingOf(wall, next, frame, high)
                                               : wall.openEnd(towards(high), towards(high + 1.0f)));
        Screen screen;
        screen.away = wall.away;
        screen.behind = wall.behind + glm::dot(wall.away, from - p) + slack;
        screen.sides = {glm::cross(n, towards(begins)), glm::cross(towards(ends), n)};
        if (isAnyHidden(screen, p, n, radius)) out.push_back(screen);
    }
    addSlab(p, n, height, radius, out);
    return true;
}

bool ScreenFinder::isAnyHidden(const Screen& screen, glm::vec3 p, glm::vec3 n, float radius) const
{
    return area_.isAnyHidden({p, n, 1.0f, kSameSurface, Screens(&screen, 1)}, radius);
}

float ScreenFinder::thicknessOf(glm::vec3 p, glm::vec3 n, float height, glm::vec3 travel, float far, float most) const
{
    Hit face, back;
    if (!rays_.intersect(lifted(p, n, height), travel, far, face)) return 0.0f;
    const glm::vec3 inside = rays_.leave(face.position, -face.facing());
    return rays_.intersect(inside, travel, most, back) && !back.isFront ? back.distance : 0.0f;
}

std::vector<ScreenFinder::Place> ScreenFinder::seenPlaces(glm::vec3 p, glm::vec3 n, float height,
                                                          const BoxGroups::Box& within) const
{
    constexpr int kSteps = 8; // a raster over the plane, wide enough for any turn of it
    const Frame frame(n);
    const float step = 2.0f * glm::compMax(within.high - within.low) / static_cast<float>(kSteps);
    std::vector<Place> seen;
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const float x = static_cast<float>(i % kSteps) - 0.5f * kSteps + 0.5f;
        const float y = static_cast<float>(i / kSteps) - 0.5f * kSteps + 0.5f;
        const glm::vec3 q = p + step * (x * frame.tangent + y * frame.bitangent);
        if (glm::any(glm::lessThan(q, within.low)) || glm::any(glm::greaterThan(q, within.high))) continue;
        Hit hit;
        if (!rays_.intersect(q + height * n, -n, 2.0f * height, hit)) continue;
        if (!isReached(hit) || glm::dot(hit.facing(), n) < kSameSurface) continue;
        const glm::vec3 above = lifted(hit.position, n, height);
        std::array<Sight, kDirections> sights;
        if (lookAround(above, frame, sights)) seen.push_back({hit.position, above});
    }
    return seen;
}

std::vector<ScreenFinder::SeenPart> ScreenFinder::seenParts(glm::vec3 p, glm::vec3 n, float height,
                                                            const BoxGroups::Box& within) const
{
    std::vector<Place> left = seenPlaces(p, n, height, within);
    std::vector<SeenPart> parts;
    while (!left.empty()) {
        std::vector<Place> part{left.back()}; // and whatever sees one of its places
        left.pop_back();
        for (std::size_t i = 0; i < part.size(); ++i) {
            const auto joins = std::ranges::stable_partition(
                left, [&](const Place& other) { return rays_.isBlocked(part[i].above, other.above); });
            part.insert(part.end(), joins.begin(), joins.end());
            left.erase(joins.begin(), joins.end());
        }
        glm::vec3 sum(0.0f);
        for (const Place& place : part) sum += place.on;
        const glm::vec3 mean = sum / static_cast<float>(part.size());
        const Place middle =
            *std::ranges::min_element(part, {}, [&](const Place& place) { return glm::distance(place.on, mean); });
        parts.push_back({middle.on, part.size()});
    }
    std::ranges::stable_sort(parts, std::ranges::greater(), &SeenPart::size);
    return parts;
}

} // namespace lightloom
