// SPDX-License-Identifier: Apache-2.0
#include "core/trace/light_reach.h"
#include "core/base/sampling.h"
#include "core/trace/direct_light.h"
#include "core/trace/light_spaces.h"
#include <algorithm>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint32_t kOpenBounces = 128; ///< a walk out of a narrow gap behind furniture takes many
constexpr float kFar = std::numeric_limits<float>::infinity();

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
            if (isLit(rays_, lights_, e, origin, n, {u1, u2})) return true;
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
    const Scene& scene = rays.scene();
    // borrowed: the spaces end with this function
    const std::shared_ptr<const RayScene> borrowed(std::shared_ptr<const RayScene>(), &rays);
    const std::shared_ptr<const LightSpaces> spaces = LightSpaces::build(borrowed, {}, workers, stop);
    if (!spaces) return nullptr;
    std::vector<std::shared_ptr<const GroupReach>> groups;
    for (int g = 0; g < static_cast<int>(scene.groups.size()); ++g) {
        groups.push_back(spaces->ofGroup(scene, lights, g, workers, stop));
        if (!groups.back()) return nullptr;
    }
    const std::vector<std::uint8_t> isReached =
        groups.empty() ? everything(spaces->elements()) : spaces->united(groups, workers, stop);
    if (stop.stop_requested()) return nullptr;
    return of(spaces->elements(), isReached, stop);
}

std::vector<std::uint8_t> LightReach::everything(const SideElements& elements)
{
    return std::vector<std::uint8_t>(elements.count(), 1);
}

std::shared_ptr<const LightReach>
LightReach::of(const SideElements& elements, const std::vector<std::uint8_t>& isReached, const std::stop_token& stop)
{
    auto reach = std::make_shared<LightReach>();
    const auto listed = [&](std::uint32_t e) { return isReached[e] != 0; };
    if (!elements.listFacets(listed, stop, reach->facets_, reach->joined_)) return nullptr;
    for (const ReachedFacet& f : reach->facets_) reach->area_ += areaOf(f);
    return reach;
}

std::vector<ReachedFacet> LightReach::fewerFacets() const
{
    std::vector<ReachedFacet> fewer;
    auto next = joined_.begin();
    for (std::size_t i = 0; i < facets_.size(); ++i) {
        const std::uint32_t side = facets_[i].side;
        if (next == joined_.end() || next->side != side) {
            fewer.push_back(facets_[i]);
            continue;
        }
        for (; next != joined_.end() && next->side == side; ++next) fewer.push_back(*next);
        while (i + 1 < facets_.size() && facets_[i + 1].side == side) ++i;
    }
    return fewer;
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
