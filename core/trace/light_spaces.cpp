// SPDX-License-Identifier: Apache-2.0
#include "core/trace/light_spaces.h"
#include "core/base/hash.h"
#include "core/base/sampling.h"
#include "core/trace/lamp_light.h"
#include <algorithm>
#include <functional>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint32_t kSeeds = 1'024, kSeedRays = 8;
constexpr std::uint32_t kPhotons = 512, kBounces = 16; ///< that find out which spaces a group is in
constexpr std::size_t kBlock = 64;
constexpr std::size_t kTries = 32;       ///< lines of sight between a seed and what a lamp lights
constexpr std::size_t kMemberTries = 64; ///< between a point and a space
constexpr std::size_t kFewPart = 64;     ///< one in so many photons outside all spaces is chance: a gap at an edge
constexpr float kFar = std::numeric_limits<float>::infinity();

} // namespace

struct LightSpaces::Lit {
    std::vector<OpenPoint> hits;                 // of photons on the first surface
    std::vector<std::vector<OpenPoint>> wanders; // by hit: where light may go on from it
};

struct LightSpaces::Space {
    std::unique_ptr<const Flooded> flooded;
    std::vector<std::uint8_t> hasSeed; // by seed
    /// Elements alone do not tell: a floor that two rooms stand on may be one.
    [[nodiscard]] bool holds(const RayScene& rays, const OpenPoint& point, Rng& rng) const
    {
        return flooded->isReached[point.element] != 0 && flooded->points.isSeenFrom(rays, point, kMemberTries, rng);
    }
    /// Whether light that fell on the first of the points and went on to the others is in this space.
    [[nodiscard]] bool joins(const RayScene& rays, const std::vector<OpenPoint>& wander, Rng rng) const
    {
        return std::ranges::any_of(wander, [&](const OpenPoint& p) { return holds(rays, p, rng); });
    }
};

LightSpaces::LightSpaces(std::shared_ptr<const RayScene> rays, SpaceDetail detail)
    : rays_(std::move(rays)), detail_(detail)
{
}
LightSpaces::~LightSpaces() = default;

std::shared_ptr<const LightSpaces> LightSpaces::build(std::shared_ptr<const RayScene> rays, SpaceDetail detail,
                                                      Workers& workers, const std::stop_token& stop)
{
    const std::shared_ptr<LightSpaces> made(new LightSpaces(std::move(rays), detail));
    made->elements_ = SideElements::build(*made->rays_, detail.depth, workers, stop);
    if (!made->elements_ || !made->placeSeeds(workers, stop)) return nullptr;
    return made;
}

/// Points spread over the surface by area, those first that have the most room before them: nearly every lamp of a
/// space sees its first seed, so that nearly never two seeds of one space are flooded.
bool LightSpaces::placeSeeds(Workers& workers, const std::stop_token& stop)
{
    std::vector<double> sums;
    double area = 0.0;
    for (std::uint32_t t = 0; t < rays_->triangleCount(); ++t) {
        if (t % 65'536 == 0 && stop.stop_requested()) return false;
        sums.push_back(area += static_cast<double>(rays_->triangleArea(t)));
    }
    if (!(area > 0.0)) return true;
    struct Placed {
        double room = 0.0;
        OpenPoint at;
    };
    std::vector<Placed> placed(kSeeds);
    const auto place = [&](std::size_t i) {
        Rng rng(0, hashName("space seeds"), i);
        const auto found = std::ranges::upper_bound(sums, rng.uniformDouble() * area) - sums.begin();
        Hit hit;
        hit.triangle = static_cast<std::uint32_t>(std::min<std::ptrdiff_t>(found, std::ssize(sums) - 1));
        const float u1 = rng.uniform(), u2 = rng.uniform();
        const glm::vec2 b = sampleTriangle(u1, u2);
        const SceneTriangle& t = rays_->triangle(hit.triangle);
        hit.position = t.a * (1.0f - b.x - b.y) + t.b * b.x + t.c * b.y;
        hit.normal = rays_->triangleNormal(hit.triangle);
        hit.isFront = rng.uniform() < 0.5f;
        placed[i].at = openPointAt(*rays_, *elements_, hit);
        for (std::uint32_t j = 0; j < kSeedRays; ++j) {
            const float v1 = rng.uniform(), v2 = rng.uniform();
            const glm::vec3 travel = Frame(placed[i].at.n).toWorld(sampleCosineHemisphere(v1, v2));
            Hit met; // a ray that goes nowhere joins nothing
            if (rays_->intersect(placed[i].at.p, travel, kFar, met))
                placed[i].room += static_cast<double>(met.distance);
        }
    };
    const bool all = workers.run(kSeeds / kBlock, stop, [&](std::size_t block) {
        for (std::size_t i = block * kBlock; i < (block + 1) * kBlock; ++i) place(i);
    });
    if (!all) return false;
    std::ranges::stable_sort(placed, [](const Placed& a, const Placed& b) { return a.room > b.room; });
    for (const Placed& p : placed) seeds_.push_back(p.at);
    return true;
}

bool LightSpaces::shine(const Scene& scene, const LightSampler& lights, int group, Workers& workers,
                        const std::stop_token& stop, Lit& lit) const
{
    const LampLight lamps(*rays_, *elements_, scene, lights, group);
    std::vector<Lit> found(kPhotons / kBlock);
    const bool all = workers.run(found.size(), stop, [&](std::size_t block) {
        const auto wander = [&](const OpenPoint& hit, Rng& rng) {
            std::vector<OpenPoint> on{hit};
            for (std::uint32_t bounce = 0; bounce < kBounces; ++bounce) {
                const float u1 = rng.uniform(), u2 = rng.uniform();
                const glm::vec3 travel = Frame(on.back().n).toWorld(sampleCosineHemisphere(u1, u2));
                Hit next;
                if (!rays_->intersect(on.back().p, travel, kFar, next)) break;
                on.push_back(openPointAt(*rays_, *elements_, next));
            }
            found[block].hits.push_back(hit);
            found[block].wanders.push_back(std::move(on));
        };
        lamps.firstHits(block * kBlock, (block + 1) * kBlock, wander);
    });
    for (Lit& some : found) {
        lit.hits.insert(lit.hits.end(), some.hits.begin(), some.hits.end());
        std::ranges::move(some.wanders, std::back_inserter(lit.wanders));
    }
    return all;
}

bool LightSpaces::isSeedSeen(int seed, const std::vector<OpenPoint>& points) const
{
    const OpenPoint& here = seeds_[static_cast<std::size_t>(seed)];
    Rng rng(0, hashName("seed seen"), static_cast<std::uint64_t>(seed));
    for (std::size_t i = 0; i < kTries; ++i) {
        const OpenPoint& other = points[rng.bits() % points.size()];
        const glm::vec3 line = other.p - here.p;
        const bool areFacing = glm::dot(line, here.n) > 0.0f && glm::dot(line, other.n) < 0.0f;
        if (areFacing && !rays_->isBlocked(here.p, other.p)) return true;
    }
    return false;
}

/// The space around a seed, and which seeds lie in it. Null: stopped.
const LightSpaces::Space* LightSpaces::flooded(int seed, Workers& workers, const std::stop_token& stop) const
{
    std::unique_ptr<const Space>& kept = spaces_[seed];
    if (kept) return kept.get();
    auto made = std::make_unique<Space>();
    made->flooded =
        floodFrom(*rays_, *elements_, {seeds_[static_cast<std::size_t>(seed)]}, detail_.walks, workers, stop);
    if (!made->flooded) return nullptr;
    made->hasSeed.resize(seeds_.size());
    for (std::size_t i = 0; i < seeds_.size(); ++i) {
        Rng rng(0, hashName("seed in space"), i);
        made->hasSeed[i] = made->holds(*rays_, seeds_[i], rng);
    }
    made->hasSeed[static_cast<std::size_t>(seed)] = 1;
    kept = std::move(made);
    return kept.get();
}

/// The first seed of the space that `seed` lies in. Nothing: stopped.
std::optional<int> LightSpaces::spaceOf(int seed, Workers& workers, const std::stop_token& stop) const
{
    while (true) {
        const Space* space = flooded(seed, workers, stop);
        if (!space) return std::nullopt;
        const auto first = static_cast<int>(std::ranges::find(space->hasSeed, 1) - space->hasSeed.begin());
        if (first == seed) return seed;
        seed = first;
    }
}

std::shared_ptr<const GroupReach> LightSpaces::ofGroup(const Scene& scene, const LightSampler& lights, int group,
                                                       Workers& workers, const std::stop_token& stop) const
{
    std::lock_guard lock(mutex_);
    Lit lit;
    if (!shine(scene, lights, group, workers, stop, lit)) return nullptr;
    const std::size_t all = lit.hits.size();
    auto reach = std::make_shared<GroupReach>();
    std::vector<OpenPoint> around;
    const auto look = [&] {
        around.clear();
        for (const auto& wander : lit.wanders) around.insert(around.end(), wander.begin(), wander.end());
    };
    look();
    const auto isKnown = [&](int seed) {
        return std::ranges::any_of(reach->spaces,
                                   [&](int s) { return spaces_.at(s)->hasSeed[static_cast<std::size_t>(seed)] != 0; });
    };
    for (int seed = 0; seed < static_cast<int>(seeds_.size()) && !lit.hits.empty(); ++seed) {
        if (isKnown(seed) || !isSeedSeen(seed, around)) continue;
        const std::optional<int> space = spaceOf(seed, workers, stop);
        if (!space) return nullptr;
        if (std::ranges::find(reach->spaces, *space) != reach->spaces.end()) continue;
        reach->spaces.push_back(*space);
        Lit left; // what does not lie in it
        for (std::size_t i = 0; i < lit.hits.size(); ++i) {
            if (spaces_.at(*space)->joins(*rays_, lit.wanders[i], Rng(0, hashName("light in space"), i))) continue;
            left.hits.push_back(lit.hits[i]);
            left.wanders.push_back(std::move(lit.wanders[i]));
        }
        lit = std::move(left);
        look();
    }
    std::ranges::sort(reach->spaces);
    if (lit.hits.size() * kFewPart > all && !addOutside(scene, lights, group, workers, stop, *reach)) return nullptr;
    return reach;
}

bool LightSpaces::addOutside(const Scene& scene, const LightSampler& lights, int group, Workers& workers,
                             const std::stop_token& stop, GroupReach& reach) const
{
    std::vector<std::uint8_t> inside(elements_->count(), 0);
    for (const int space : reach.spaces) {
        const std::vector<std::uint8_t>& reached = spaces_.at(space)->flooded->isReached;
        std::ranges::transform(inside, reached, inside.begin(), std::bit_or<>());
    }
    std::vector<OpenPoint> starts;
    const LampLight lamps(*rays_, *elements_, scene, lights, group);
    if (!lamps.findOutside(inside, workers, stop, starts)) return false;
    const auto outside = floodFrom(*rays_, *elements_, starts, detail_.walks, workers, stop);
    if (!outside) return false;
    for (std::uint32_t e = 0; e < elements_->count(); ++e) {
        if (outside->isReached[e] && !inside[e]) reach.elements.push_back(e);
    }
    return true;
}

std::vector<std::uint8_t> LightSpaces::united(std::span<const std::shared_ptr<const GroupReach>> groups,
                                              Workers& workers, const std::stop_token& stop) const
{
    std::lock_guard lock(mutex_);
    std::vector<std::uint8_t> reached(elements_->count(), 0);
    std::vector<int> spaces;
    for (const auto& group : groups) {
        spaces.insert(spaces.end(), group->spaces.begin(), group->spaces.end());
        for (const std::uint32_t e : group->elements) reached[e] = 1;
    }
    std::ranges::sort(spaces);
    spaces.erase(std::unique(spaces.begin(), spaces.end()), spaces.end());
    for (const int space : spaces) {
        const Space* all = flooded(space, workers, stop);
        if (!all) return {};
        std::ranges::transform(reached, all->flooded->isReached, reached.begin(), std::bit_or<>());
    }
    return reached;
}

} // namespace lightloom
