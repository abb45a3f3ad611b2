// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/surface_area.h"
#include "core/base/ordering.h"
#include "core/base/sampling.h"
#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

constexpr float kSmall = 0.5f; ///< facets that reach this far, against the smallest radius, are no longer cut

/// Adds what facets have under a kernel. A facet that lies whole within a radius lies so within all larger ones: it is
/// added once, to the first of them, and the sums run up at the end. Only the few across a border are cut.
class KernelSum {
public:
    KernelSum(const KernelPlace& place, std::span<const float> radii, std::span<AreaMoments> out)
        : radii_(radii), out_(out), centre_(place.centre), normal_(place.normal), stretch_(place.stretch)
    {
        const Frame frame(place.normal);
        tangent_ = frame.tangent, bitangent_ = frame.bitangent;
        std::ranges::fill(out_, AreaMoments{});
    }

    void add(const ReachedFacet& f)
    {
        const glm::dvec3 a = glm::dvec3(f.a) - centre_, b = glm::dvec3(f.b) - centre_, c = glm::dvec3(f.c) - centre_;
        const double real = glm::length(glm::cross(b - a, c - a));
        if (!(real > 0.0)) return;
        // stretching along the normal turns the ellipsoid into a ball; tangential coordinates stay
        const Corners at{stretched(a), stretched(b), stretched(c)};
        const double far = std::max({glm::dot(at.a, at.a), glm::dot(at.b, at.b), glm::dot(at.c, at.c)});
        std::size_t whole = radii_.size();
        while (whole > 0 && squared(whole - 1) >= far) --whole;
        if (whole < radii_.size()) whole_[whole] += momentsOfTriangle(flat(a), flat(b), flat(c), 0.5 * real);
        cut(at, real, whole);
    }

    void finish()
    {
        AreaMoments sum;
        for (std::size_t j = 0; j < radii_.size(); ++j) {
            sum += whole_[j];
            out_[j] += sum;
        }
    }

private:
    struct Corners {
        glm::dvec3 a, b, c;
    };
    [[nodiscard]] double squared(std::size_t j) const
    {
        return static_cast<double>(radii_[j]) * static_cast<double>(radii_[j]);
    }
    [[nodiscard]] glm::dvec3 stretched(glm::dvec3 d) const
    {
        return d + normal_ * ((stretch_ - 1.0) * glm::dot(normal_, d));
    }
    [[nodiscard]] glm::dvec2 flat(glm::dvec3 d) const { return {glm::dot(d, tangent_), glm::dot(d, bitangent_)}; }

    /// The part within radii below number `whole`.
    void cut(const Corners& at, double real, std::size_t whole)
    {
        if (whole == 0) return;
        const glm::dvec3 across = glm::cross(at.b - at.a, at.c - at.a);
        const double grown = glm::length(across);
        if (!(grown > 0.0)) return;
        const glm::dvec3 n = across / grown, x = glm::normalize(at.b - at.a), y = glm::cross(n, x);
        const double height = glm::dot(at.a, n);
        const auto inPlane = [&](glm::dvec3 p) { return glm::dvec2(glm::dot(p, x), glm::dot(p, y)); };
        const std::array corners{inPlane(at.a), inPlane(at.b), inPlane(at.c)};
        const glm::dvec2 tx = flat(x), ty = flat(y), shift = flat(height * n);
        const double inside = depthInside(corners);
        for (std::size_t j = whole; j-- > 0;) {
            const double disc = squared(j) - height * height;
            if (!(disc > 0.0)) return;
            const double r = std::sqrt(disc);
            const AreaMoments part = r <= inside ? momentsOfDisc(r) : momentsInDisc(corners, r);
            if (!(part.area > 0.0)) return; // smaller discs have nothing either
            out_[j] += part.moved({tx, ty}, shift).scaled(real / grown);
        }
    }

    std::span<const float> radii_;
    std::span<AreaMoments> out_;
    std::array<AreaMoments, SurfaceArea::kMostRadii> whole_{};
    glm::dvec3 centre_, normal_, tangent_{0.0}, bitangent_{0.0};
    double stretch_;
};

} // namespace

SurfaceArea::SurfaceArea(const LightReach& reach) : facets_(reach.facets()), total_(reach.area()) {}

std::shared_ptr<const SurfaceArea> SurfaceArea::build(const LightReach& reach, const std::stop_token& stop)
{
    const std::shared_ptr<SurfaceArea> made(new SurfaceArea(reach));
    const auto count = static_cast<std::uint32_t>(made->facets_.size());
    if (count > 0) made->split(0, count, stop);
    if (stop.stop_requested()) return nullptr;
    return made;
}

std::uint32_t SurfaceArea::split(std::uint32_t first, std::uint32_t last, const std::stop_token& stop)
{
    constexpr std::uint32_t kLeaf = FacetBlock::kCount, kLong = 16'384; // a long list looks at the stop
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low), lowCentre(low), highCentre(high);
    for (std::uint32_t i = first; i < last; ++i) {
        const ReachedFacet& f = facets_[i];
        low = glm::min(low, glm::min(f.a, glm::min(f.b, f.c)));
        high = glm::max(high, glm::max(f.a, glm::max(f.b, f.c)));
        const glm::vec3 centre = (f.a + f.b + f.c) / 3.0f;
        lowCentre = glm::min(lowCentre, centre);
        highCentre = glm::max(highCentre, centre);
    }
    const auto node = static_cast<std::uint32_t>(boxes_.size());
    boxes_.push_back({low, high, first, last - first, 0});
    if (last - first <= kLeaf) {
        boxes_.back().block = static_cast<std::uint32_t>(blocks_.size());
        blocks_.emplace_back(std::span(facets_.data() + first, last - first));
        return node;
    }
    if (last - first > kLong && stop.stop_requested()) return node;

    const glm::vec3 size = highCentre - lowCentre;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::uint32_t middle = first + (last - first) / 2;
    const auto isBefore = [axis](const ReachedFacet& a, const ReachedFacet& b) {
        return a.a[axis] + a.b[axis] + a.c[axis] < b.a[axis] + b.b[axis] + b.c[axis];
    };
    const auto at = [this](std::uint32_t i) { return facets_.begin() + i; };
    if (!selectNth(at(first), at(middle), at(last), isBefore, stop)) return node;
    split(first, middle, stop);
    const std::uint32_t right = split(middle, last, stop);
    boxes_[node].first = right;
    boxes_[node].count = 0;
    return node;
}

void SurfaceArea::under(const KernelPlace& place, std::span<const float> radii, std::span<AreaMoments> out) const
{
    assert(radii.size() <= kMostRadii && out.size() == radii.size());
    KernelSum sum(place, radii, out);
    if (boxes_.empty() || radii.empty()) return;
    const Frame frame(place.normal);
    BlockSums small(place.centre, place.normal, frame.tangent, frame.bitangent, place.stretch, place.leastCosine,
                    kSmall * radii.front(), radii);
    const float r2 = radii.back() * radii.back();
    std::uint32_t stack[64];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const std::uint32_t node = stack[--depth];
        const Box& box = boxes_[node];
        // the ellipsoid lies within the ball
        const glm::vec3 gap = glm::max(glm::max(box.low - place.centre, place.centre - box.high), glm::vec3(0.0f));
        if (glm::dot(gap, gap) > r2) continue;
        if (box.count == 0) {
            stack[depth++] = box.first;
            stack[depth++] = node + 1;
            continue;
        }
        for (unsigned large = small.add(blocks_[box.block]); large != 0; large &= large - 1) {
            sum.add(facets_[box.first + static_cast<std::uint32_t>(std::countr_zero(large))]);
        }
    }
    sum.finish();
    for (std::size_t j = 0; j < radii.size(); ++j) out[j] += small.sum(j);
}

double SurfaceArea::under(const KernelPlace& place, float radius) const
{
    AreaMoments moments;
    under(place, std::span(&radius, 1), std::span(&moments, 1));
    return moments.area;
}

} // namespace lightloom
