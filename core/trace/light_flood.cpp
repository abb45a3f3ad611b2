// SPDX-License-Identifier: Apache-2.0
#include "core/trace/light_flood.h"
#include "core/base/hash.h"
#include "core/base/sampling.h"
#include "core/trace/material.h"
#include <algorithm>
#include <functional>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint32_t kWalksPerBlock = 512, kBounces = 8;
constexpr std::uint32_t kGenerations = 4; ///< a generation starts where others came to: far rooms get their walks too
constexpr std::size_t kLooks = 16;        ///< lines of sight that an element tries
constexpr std::size_t kNearby = 256;      ///< open points that count as nearby, along the Morton curve
constexpr std::size_t kFew = 128;         ///< open points that are all tried for facing before any ray
constexpr std::uint64_t kRounds = 32;
constexpr float kFar = std::numeric_limits<float>::infinity();

bool areFacing(const OpenPoint& a, const OpenPoint& b)
{
    const glm::vec3 line = b.p - a.p;
    return glm::dot(line, a.n) > 0.0f && glm::dot(line, b.n) < 0.0f;
}

class Explorer {
public:
    Explorer(const RayScene& rays, const SideElements& elements, std::uint32_t walks)
        : rays_(rays), elements_(elements), walks_(walks), reached_(elements.count(), 0),
          isGlassy_(std::ranges::any_of(rays.scene().materials, mayTransmit))
    {
    }

    void add(const OpenPoint& point)
    {
        open_.push_back(point);
        if (reached_[point.element]) return;
        reached_[point.element] = 1;
        firsts_.push_back(point);
    }

    /// Random walks from reached points that lose nothing at the walls, and go on either side of glass.
    bool walk(Workers& workers, const std::stop_token& stop)
    {
        for (std::uint32_t generation = 0; generation < kGenerations; ++generation) {
            const std::vector<OpenPoint> from = firsts_;
            const bool all =
                collect(walks_ / kWalksPerBlock, workers, stop, [&](std::size_t block, std::vector<OpenPoint>& found) {
                    for (std::uint64_t i = 0; i < kWalksPerBlock; ++i) {
                        walkOnce(from, generation, block * kWalksPerBlock + i, found);
                    }
                });
            if (!all) return false;
        }
        return true;
    }

    /// Elements not reached yet look for open points, the first time for any, then for those the last round found;
    /// repeats until nothing is found.
    bool lookAround(Workers& workers, const std::stop_token& stop)
    {
        std::size_t first = 0; // of the points to look for
        for (std::uint64_t round = 0; round < kRounds && first < open_.size(); ++round) {
            std::vector<std::uint32_t> unreached;
            for (std::uint32_t e = 0; e < reached_.size(); ++e) {
                if (!reached_[e]) unreached.push_back(e);
            }
            const OpenPoints targets(rays_.scene().bounds,
                                     {open_.begin() + static_cast<std::ptrdiff_t>(first), open_.end()});
            first = open_.size();
            // most of what stays dark (the outside of a room, say) faces away from all of them
            std::erase_if(unreached, [&](std::uint32_t e) { return !elements_.mayFace(e, targets.box()); });
            constexpr std::size_t kBlock = 64;
            const bool all = collect((unreached.size() + kBlock - 1) / kBlock, workers, stop,
                                     [&](std::size_t block, std::vector<OpenPoint>& found) {
                                         const std::size_t end = std::min(unreached.size(), (block + 1) * kBlock);
                                         for (std::size_t i = block * kBlock; i < end && !stop.stop_requested(); ++i) {
                                             look(unreached[i], round, targets, found);
                                         }
                                     });
            if (!all) return false;
        }
        return true;
    }

    [[nodiscard]] std::unique_ptr<const Flooded> taken()
    {
        return std::make_unique<const Flooded>(Flooded{std::move(reached_), OpenPoints(rays_.scene().bounds, firsts_)});
    }

private:
    /// A step of a walk. A point that is moved off its surface in a crease may end up behind the surface beside it, in
    /// a closed body; then the place it came from does not see it.
    struct Sight {
        glm::vec3 from, to;
    };

    /// Runs blocks that find open points and adds these in the order of the blocks.
    bool collect(std::size_t blocks, Workers& workers, const std::stop_token& stop,
                 const std::function<void(std::size_t, std::vector<OpenPoint>&)>& body)
    {
        std::vector<OpenPoint> found;
        if (!collectPoints(blocks, workers, stop, found, body)) return false;
        for (const OpenPoint& point : found) add(point);
        return true;
    }

    void walkOnce(const std::vector<OpenPoint>& from, std::uint32_t generation, std::uint64_t number,
                  std::vector<OpenPoint>& found) const
    {
        Rng rng(generation, hashName("light flood"), number);
        const OpenPoint& start = from[rng.bits() % from.size()];
        glm::vec3 origin = start.p, normal = start.n;
        std::vector<Sight> unproven;
        for (std::uint32_t bounce = 0; bounce < kBounces; ++bounce) {
            const float u1 = rng.uniform(), u2 = rng.uniform();
            Hit hit;
            if (!rays_.intersect(origin, Frame(normal).toWorld(sampleCosineHemisphere(u1, u2)), kFar, hit)) return;
            const OpenPoint met = openPointAt(rays_, elements_, hit);
            unproven.push_back({origin, met.p});
            if (!reached_[met.element]) {
                if (std::ranges::any_of(unproven, [&](const Sight& s) { return rays_.isBlocked(s.from, s.to); }))
                    return;
                unproven.clear();
            }
            found.push_back(met);
            if (mayTransmit(rays_.material(hit.triangle)) && rng.uniform() < 0.5f) {
                hit.isFront = !hit.isFront;
                found.push_back(openPointAt(rays_, elements_, hit));
            }
            origin = found.back().p, normal = found.back().n;
        }
    }

    void look(std::uint32_t element, std::uint64_t round, const OpenPoints& targets,
              std::vector<OpenPoint>& found) const
    {
        // late rounds look for a handful of points from tens of thousands of hidden elements that face none of them
        if (targets.size() <= kFew && !facesAny(element, targets)) return;
        const std::size_t tries = std::min(kLooks, 2 * targets.size());
        for (std::uint64_t i = 0; i < tries; ++i) {
            Rng rng(round, hashName("look around"), (std::uint64_t(element) << 8) + i);
            OpenPoint here{glm::vec3(0.0f), glm::vec3(0.0f), element};
            if (!elements_.sample(element, rng, here.p, here.n)) continue;
            here.p = rays_.leave(here.p, here.n);
            const OpenPoint& other = i % 2 ? targets.pick(rng) : targets.pickNear(here.p, rng);
            if (!areFacing(here, other) || rays_.isBlocked(here.p, other.p)) continue;
            found.push_back(here);
            lookThrough(here, found);
            return;
        }
    }

    /// Light on glass comes out on its other side.
    void lookThrough(const OpenPoint& here, std::vector<OpenPoint>& found) const
    {
        Hit hit; // seen from `here`, a step back to the surface
        if (!isGlassy_ || !rays_.intersect(here.p, -here.n, 3.0f * rays_.offset(), hit)) return;
        if (!mayTransmit(rays_.material(hit.triangle))) return;
        hit.isFront = !hit.isFront;
        found.push_back(openPointAt(rays_, elements_, hit));
    }

    [[nodiscard]] bool facesAny(std::uint32_t element, const OpenPoints& targets) const
    {
        return std::ranges::any_of(targets.all(),
                                   [&](const OpenPoint& t) { return elements_.canFace(element, t.p, t.n); });
    }

    const RayScene& rays_;
    const SideElements& elements_;
    std::uint32_t walks_; // of each generation
    std::vector<std::uint8_t> reached_;
    bool isGlassy_; // some material lets light through
    std::vector<OpenPoint> open_, firsts_;
};

} // namespace

OpenPoint openPointAt(const RayScene& rays, const SideElements& elements, const Hit& hit)
{
    return {rays.leave(hit.position, hit.facing()), hit.facing(), elements.of(hit)};
}

OpenPoints::OpenPoints(const Bounds& bounds, const std::vector<OpenPoint>& points) : bounds_(bounds)
{
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    order.reserve(points.size());
    if (!points.empty()) box_ = {points[0].p, points[0].p};
    for (const OpenPoint& point : points) {
        box_.low = glm::min(box_.low, point.p);
        box_.high = glm::max(box_.high, point.p);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        order.emplace_back(codeOf(points[i].p), static_cast<std::uint32_t>(i));
    }
    std::ranges::sort(order);
    codes_.reserve(points.size());
    points_.reserve(points.size());
    for (const auto& [code, i] : order) {
        codes_.push_back(code);
        points_.push_back(points[i]);
    }
}

std::uint64_t OpenPoints::codeOf(glm::vec3 p) const
{
    const glm::vec3 part = (p - bounds_.low) / glm::max(bounds_.longestSide(), 1e-30f);
    return mortonCode(glm::uvec3(glm::clamp(part, 0.0f, 1.0f) * 65535.0f));
}

const OpenPoint& OpenPoints::pickNear(glm::vec3 p, Rng& rng) const
{
    const std::size_t window = std::min(kNearby, size());
    const auto at = std::ranges::lower_bound(codes_, codeOf(p)) - codes_.begin();
    const auto low =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at - static_cast<std::ptrdiff_t>(window / 2)));
    return points_[std::min(low, size() - window) + rng.bits() % window];
}

bool OpenPoints::isSeenFrom(const RayScene& rays, const OpenPoint& here, std::size_t tries, Rng& rng) const
{
    if (points_.empty()) return false;
    for (std::size_t i = 0; i < tries; ++i) {
        const OpenPoint& other = i % 2 ? pick(rng) : pickNear(here.p, rng);
        if (areFacing(here, other) && !rays.isBlocked(here.p, other.p)) return true;
    }
    return false;
}

bool collectPoints(std::size_t blocks, Workers& workers, const std::stop_token& stop, std::vector<OpenPoint>& points,
                   const std::function<void(std::size_t, std::vector<OpenPoint>&)>& body)
{
    std::vector<std::vector<OpenPoint>> found(blocks);
    if (!workers.run(blocks, stop, [&](std::size_t block) { body(block, found[block]); })) return false;
    for (const std::vector<OpenPoint>& some : found) points.insert(points.end(), some.begin(), some.end());
    return true;
}

std::unique_ptr<const Flooded> floodFrom(const RayScene& rays, const SideElements& elements,
                                         const std::vector<OpenPoint>& starts, std::uint32_t walks, Workers& workers,
                                         const std::stop_token& stop)
{
    Explorer explorer(rays, elements, walks);
    for (const OpenPoint& start : starts) explorer.add(start);
    if (!starts.empty() && (!explorer.walk(workers, stop) || !explorer.lookAround(workers, stop))) return nullptr;
    return explorer.taken();
}

} // namespace lightloom
