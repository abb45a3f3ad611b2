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
        if (inside * inside >= squared(whole - 1) && inside < 0.0) return; // all beyond one of its edges
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

SurfaceArea::SurfaceArea(const LightReach& reach) : facets_(reach.fewerFacets()), total_(reach.area()) {}

std::shared_ptr<const SurfaceArea> SurfaceArea::build(const LightReach& reach, const std::stop_token& stop)
{
    const std::shared_ptr<SurfaceArea> made(new SurfaceArea(reach));
    const auto count = static_cast<std::uint32_t>(made->facets_.size());
    if (count > 0) made->order(0, count, stop);
    if (stop.stop_requested()) return nullptr;
    made->blocks_.reserve((count + FacetBlock::kCount - 1) / FacetBlock::kCount);
    std::vector<BoxGroups::Box> boxes;
    for (std::uint32_t first = 0; first < count; first += FacetBlock::kCount) {
        const auto facets =
            std::span(made->facets_).subspan(first).first(std::min<std::size_t>(FacetBlock::kCount, count - first));
        made->blocks_.emplace_back(facets);
        BoxGroups::Box box;
        for (const ReachedFacet& f : facets) box.add(f.a), box.add(f.b), box.add(f.c);
        boxes.push_back(box);
    }
    made->boxes_ = BoxGroups(boxes);
    return made;
}

/// Parts lists at the median of their longest side, between blocks, so that all blocks but the last are full.
void SurfaceArea::order(std::uint32_t first, std::uint32_t last, const std::stop_token& stop)
{
    constexpr std::uint32_t kBlock = FacetBlock::kCount, kLong = 16'384; // a long list looks at the stop
    const std::uint32_t blocks = (last - first + kBlock - 1) / kBlock;
    if (blocks <= 1 || (last - first > kLong && stop.stop_requested())) return;
    BoxGroups::Box centres;
    for (std::uint32_t i = first; i < last; ++i) centres.add((facets_[i].a + facets_[i].b + facets_[i].c) / 3.0f);
    const glm::vec3 size = centres.high - centres.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::uint32_t middle = first + BoxGroups::firstPart(blocks) * kBlock;
    const auto isBefore = [axis](const ReachedFacet& a, const ReachedFacet& b) {
        return a.a[axis] + a.b[axis] + a.c[axis] < b.a[axis] + b.b[axis] + b.c[axis];
    };
    const auto at = [this](std::uint32_t i) { return facets_.begin() + i; };
    if (!selectNth(at(first), at(middle), at(last), isBefore, stop)) return;
    order(first, middle, stop);
    order(middle, last, stop);
}

void SurfaceArea::under(const KernelPlace& place, std::span<const float> radii, std::span<AreaMoments> out) const
{
    assert(radii.size() <= kMostRadii && out.size() == radii.size());
    KernelSum sum(place, radii, out);
    if (blocks_.empty() || radii.empty()) return;
    const Frame frame(place.normal);
    BlockSums small(place.centre, place.normal, frame.tangent, frame.bitangent, place.stretch, place.leastCosine,
                    kSmall * radii.front(), radii);
    thread_local BoxGroups::Near near;
    // the ellipsoid lies within the ball
    for (const std::uint64_t key : boxes_.within(place.centre, radii.back() * radii.back(), near)) {
        const auto block = static_cast<std::uint32_t>(key);
        std::uint32_t large[FacetBlock::kCount];
        const std::size_t count = small.add(blocks_[block], block * FacetBlock::kCount, large);
        for (std::size_t i = 0; i < count; ++i) sum.add(facets_[large[i]]);
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
