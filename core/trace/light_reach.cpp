// SPDX-License-Identifier: Apache-2.0
#include "core/trace/light_reach.h"
#include "core/base/sampling.h"
#include "core/trace/side_elements.h"
#include <algorithm>
#include <functional>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint32_t kWalks = 32'768, kWalksPerBlock = 512, kBounces = 8; ///< walks in all, shared by the lamps
constexpr std::size_t kLooks = 16;          ///< lines of sight that an element tries, half of them nearby
constexpr std::size_t kNearby = 256;        ///< open points that count as nearby, along the Morton curve
constexpr std::size_t kFew = 128;           ///< open points that are all tried for facing before any ray
constexpr std::uint32_t kOpenBounces = 128; ///< a walk out of a narrow gap behind furniture takes many
constexpr float kFar = std::numeric_limits<float>::infinity();

/// A point that light certainly reaches, moved off its surface.
struct OpenPoint {
    glm::vec3 p, n;
    std::uint32_t element;
};

/// Finds the elements that light reaches. Only points pass light on, never elements: an element that is half under a
/// block is reached, but what lies under the block sees none of its open points.
class Explorer {
public:
    Explorer(const RayScene& rays, const LightSampler& lights, const SideElements& elements)
        : rays_(rays), lights_(lights), elements_(elements), reached_(elements.count(), 0),
          isGlassy_(std::ranges::any_of(rays.scene().materials, mayTransmit))
    {
    }

    /// Random walks from every lamp that lose nothing at the walls, and go on either side of glass.
    bool walkFromLamps(Workers& workers, const std::stop_token& stop)
    {
        const std::size_t groups = rays_.scene().groups.size();
        const std::size_t each = std::max<std::size_t>(1, kWalks / kWalksPerBlock / groups);
        return collect(groups * each, workers, stop, [&](std::size_t block, std::vector<OpenPoint>& found) {
            const std::uint64_t first = (block % each) * kWalksPerBlock;
            for (std::uint64_t i = first; i < first + kWalksPerBlock; ++i)
                walk(static_cast<int>(block / each), i, found);
        });
    }

    /// Elements not reached yet look for open points, the first time for any, then for those the last round found;
    /// repeats until nothing is found.
    bool lookAround(Workers& workers, const std::stop_token& stop)
    {
        std::size_t first = 0; // of the points to look for
        for (std::uint64_t round = 0; round < 32 && first < open_.size(); ++round) {
            std::vector<std::uint32_t> unreached;
            for (std::uint32_t e = 0; e < reached_.size(); ++e) {
                if (!reached_[e]) unreached.push_back(e);
            }
            const Targets targets = sortedAlongCurve(first);
            first = open_.size();
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

    [[nodiscard]] bool isReached(std::uint32_t element) const { return reached_[element] != 0; }

private:
    /// Runs blocks that find open points and adds these in the order of the blocks.
    bool collect(std::size_t blocks, Workers& workers, const std::stop_token& stop,
                 const std::function<void(std::size_t, std::vector<OpenPoint>&)>& body)
    {
        std::vector<std::vector<OpenPoint>> found(blocks);
        if (!workers.run(blocks, stop, [&](std::size_t block) { body(block, found[block]); })) return false;
        for (const std::vector<OpenPoint>& some : found) {
            for (const OpenPoint& point : some) reached_[point.element] = 1;
            open_.insert(open_.end(), some.begin(), some.end());
        }
        return true;
    }

    void walk(int group, std::uint64_t number, std::vector<OpenPoint>& found) const
    {
        Rng rng(0, rays_.scene().groups[static_cast<std::size_t>(group)].key() ^ hashName("light reach"), number);
        EmittedPhoton photon;
        if (!lights_.emit(group, rng, photon)) return;
        glm::vec3 origin = photon.position, travel = photon.travel;
        for (std::uint32_t bounce = 0; bounce < kBounces; ++bounce) {
            Hit hit;
            if (!rays_.intersect(origin, travel, kFar, hit)) return;
            origin = rays_.leave(hit.position, hit.facing());
            found.push_back({origin, hit.facing(), elements_.of(hit)});
            if (mayTransmit(rays_.material(hit.triangle)) && rng.uniform() < 0.5f) {
                hit.isFront = !hit.isFront;
                origin = rays_.leave(hit.position, hit.facing());
                found.push_back({origin, hit.facing(), elements_.of(hit)});
            }
            const float u1 = rng.uniform(), u2 = rng.uniform();
            travel = Frame(hit.facing()).toWorld(sampleCosineHemisphere(u1, u2));
        }
    }

    /// Open points in the order of the Morton curve: neighbours in the lists are neighbours in space, mostly. Copies,
    /// one after another, because they are picked at random a million times.
    struct Targets {
        std::vector<std::uint64_t> codes;
        std::vector<OpenPoint> points;
        [[nodiscard]] std::size_t size() const { return points.size(); }
    };

    [[nodiscard]] std::uint64_t codeOf(glm::vec3 p) const
    {
        const Bounds& bounds = rays_.scene().bounds;
        const glm::vec3 part = (p - bounds.low) / glm::max(bounds.longestSide(), 1e-30f);
        return mortonCode(glm::uvec3(glm::clamp(part, 0.0f, 1.0f) * 65535.0f));
    }

    [[nodiscard]] Targets sortedAlongCurve(std::size_t first) const
    {
        std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
        for (std::size_t i = first; i < open_.size(); ++i) {
            order.emplace_back(codeOf(open_[i].p), static_cast<std::uint32_t>(i));
        }
        std::ranges::sort(order);
        Targets targets;
        for (const auto& [code, i] : order) {
            targets.codes.push_back(code);
            targets.points.push_back(open_[i]);
        }
        return targets;
    }

    void look(std::uint32_t element, std::uint64_t round, const Targets& targets, std::vector<OpenPoint>& found) const
    {
        // late rounds look for a handful of points from tens of thousands of hidden elements that face none of them
        if (targets.size() <= kFew && !facesAny(element, targets)) return;
        const std::size_t tries = std::min(kLooks, 2 * targets.size());
        for (std::uint64_t i = 0; i < tries; ++i) {
            Rng rng(round, hashName("look around"), (std::uint64_t(element) << 8) + i);
            OpenPoint here{glm::vec3(0.0f), glm::vec3(0.0f), element};
            if (!elements_.sample(element, rng, here.p, here.n)) continue;
            here.p = rays_.leave(here.p, here.n);
            const std::size_t pick = i % 2 ? rng.bits() % targets.size() : nearby(here.p, targets, rng);
            const OpenPoint& other = targets.points[pick];
            const glm::vec3 line = other.p - here.p;
            const bool facing = glm::dot(line, here.n) > 0.0f && glm::dot(line, other.n) < 0.0f;
            if (!facing || rays_.isBlocked(here.p, other.p)) continue;
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
        found.push_back({rays_.leave(hit.position, hit.facing()), hit.facing(), elements_.of(hit)});
    }

    [[nodiscard]] bool facesAny(std::uint32_t element, const Targets& targets) const
    {
        return std::ranges::any_of(targets.points,
                                   [&](const OpenPoint& t) { return elements_.canFace(element, t.p, t.n); });
    }

    [[nodiscard]] std::size_t nearby(glm::vec3 p, const Targets& targets, Rng& rng) const
    {
        const std::size_t window = std::min(kNearby, targets.size());
        const auto at = std::ranges::lower_bound(targets.codes, codeOf(p)) - targets.codes.begin();
        const auto low =
            static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at - static_cast<std::ptrdiff_t>(window / 2)));
        return std::min(low, targets.size() - window) + rng.bits() % window;
    }

    const RayScene& rays_;
    const LightSampler& lights_;
    const SideElements& elements_;
    std::vector<std::uint8_t> reached_;
    bool isGlassy_; // some material lets light through
    std::vector<OpenPoint> open_;
};

double areaOf(const ReachedFacet& f)
{
    return 0.5 * glm::length(glm::cross(glm::dvec3(f.b) - glm::dvec3(f.a), glm::dvec3(f.c) - glm::dvec3(f.a)));
}

/// Whether a point is in the open: it sees a lamp, or two random walks that lose nothing at the walls come to where one
/// is seen, on either side of the glass they meet. (Two: a single ray can leak through an edge into a closed void.)
class OpenTest {
public:
    OpenTest(const RayScene& rays, const LightSampler& lights) : rays_(rays), lights_(lights) {}

    [[nodiscard]] bool isOpen(glm::vec3 p, glm::vec3 n, Rng rng) const
    {
        const glm::vec3 origin = rays_.leave(p, n);
        if (rays_.scene().groups.empty() || seesLamp(origin, n, rng)) return true;
        int found = 0;
        for (int i = 0; i < 32 && found < 2; ++i) found += findsLamp(origin, n, rng);
        return found == 2;
    }

private:
    [[nodiscard]] bool findsLamp(glm::vec3 origin, glm::vec3 n, Rng& rng) const
    {
        for (std::uint32_t bounce = 0; bounce < kOpenBounces; ++bounce) {
            const float u1 = rng.uniform(), u2 = rng.uniform();
            Hit hit;
            if (!rays_.intersect(origin, Frame(n).toWorld(sampleCosineHemisphere(u1, u2)), kFar, hit)) return false;
            if (mayTransmit(rays_.material(hit.triangle)) && rng.uniform() < 0.5f) hit.isFront = !hit.isFront;
            n = hit.facing();
            origin = rays_.leave(hit.position, n);
            if (seesLamp(origin, n, rng)) return true;
        }
        return false;
    }

    [[nodiscard]] bool seesLamp(glm::vec3 origin, glm::vec3 n, Rng& rng) const
    {
        for (int e = 0; e < static_cast<int>(lights_.emitters().size()); ++e) {
            const float u1 = rng.uniform(), u2 = rng.uniform();
            LightSample light;
            if (!lights_.sample(e, origin, {u1, u2}, light) || !(glm::dot(light.toLight, n) > 0.0f)) continue;
            if (!rays_.isBlocked(origin, light.end)) return true;
        }
        return false;
    }

    const RayScene& rays_;
    const LightSampler& lights_;
};

} // namespace

std::shared_ptr<const LightReach> LightReach::find(const RayScene& rays, const LightSampler& lights, Workers& workers,
                                                   const std::stop_token& stop)
{
    auto reach = std::make_shared<LightReach>();
    const std::unique_ptr<const SideElements> elements = SideElements::build(rays, workers, stop);
    if (!elements) return nullptr;
    if (rays.scene().groups.empty()) {
        if (!elements->listFacets([](std::uint32_t) { return true; }, stop, reach->facets_)) return nullptr;
    } else {
        Explorer explorer(rays, lights, *elements);
        if (!explorer.walkFromLamps(workers, stop) || !explorer.lookAround(workers, stop)) return nullptr;
        const auto isReached = [&](std::uint32_t e) { return explorer.isReached(e); };
        if (!elements->listFacets(isReached, stop, reach->facets_)) return nullptr;
    }
    for (const ReachedFacet& f : reach->facets_) reach->area_ += areaOf(f);
    return reach;
}

std::vector<SurfacePoint> samplePoints(const RayScene& rays, const LightSampler& lights, const LightReach& reach,
                                       std::uint64_t count, std::uint64_t seed)
{
    std::vector<double> sums; // running area
    double total = 0.0;
    for (const ReachedFacet& f : reach.facets()) sums.push_back(total += areaOf(f));
    std::vector<SurfacePoint> points;
    if (!(total > 0.0)) return points;
    points.reserve(count);
    const OpenTest open(rays, lights);
    for (std::uint64_t i = 0; i < count; ++i) {
        Rng rng(seed, hashName("probe points"), i);
        for (int attempt = 0; attempt < 256; ++attempt) {
            const auto at =
                static_cast<std::size_t>(std::ranges::upper_bound(sums, rng.uniformDouble() * total) - sums.begin());
            const ReachedFacet& f = reach.facets()[std::min(at, sums.size() - 1)];
            const float u1 = rng.uniform(), u2 = rng.uniform();
            const glm::vec2 b = sampleTriangle(u1, u2);
            const glm::vec3 p = f.a * (1.0f - b.x - b.y) + f.b * b.x + f.c * b.y;
            if (!open.isOpen(p, f.normal, rng)) continue;
            points.push_back({p, f.normal, f.side / 2});
            break;
        }
    }
    return points;
}

} // namespace lightloom
