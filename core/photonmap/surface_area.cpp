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

constexpr float kTiny = 0.25f; ///< facets that reach this far are no longer cut by screens
constexpr float kSmall = 0.5f; ///< facets that reach this far, against the smallest radius, are no longer cut

using Triangle = std::array<glm::dvec3, 3>;
Triangle fromCentre(const ReachedFacet& f, glm::dvec3 centre)
{
    return {glm::dvec3(f.a) - centre, glm::dvec3(f.b) - centre, glm::dvec3(f.c) - centre};
}

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

    void add(const ReachedFacet& f) { add(fromCentre(f, centre_), 1.0); }

    /// A convex flat polygon, counted `times`.
    void add(std::span<const glm::dvec3> corners, double times)
    {
        assert(corners.size() <= FacetPart::kMost);
        if (corners.empty()) return;
        // stretching along the normal turns the ellipsoid into a ball; tangential coordinates stay
        std::array<glm::dvec3, FacetPart::kMost> grown;
        double far = 0.0;
        glm::dvec3 across(0.0), real(0.0);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            grown[i] = stretched(corners[i]);
            far = std::max(far, glm::dot(grown[i], grown[i]));
            if (i < 2) continue;
            across += glm::cross(grown[i - 1] - grown[0], grown[i] - grown[0]);
            real += glm::cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
        }
        const double size = times * glm::length(real);
        if (!(std::abs(size) > 0.0)) return;
        std::size_t whole = radii_.size();
        while (whole > 0 && squared(whole - 1) >= far) --whole;
        if (whole < radii_.size()) whole_[whole] += momentsOf(corners, times);
        if (whole > 0) cut(std::span(grown).first(corners.size()), across, size, whole);
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
    [[nodiscard]] double squared(std::size_t j) const
    {
        return static_cast<double>(radii_[j]) * static_cast<double>(radii_[j]);
    }
    [[nodiscard]] glm::dvec3 stretched(glm::dvec3 d) const
    {
        return d + normal_ * ((stretch_ - 1.0) * glm::dot(normal_, d));
    }
    [[nodiscard]] glm::dvec2 flat(glm::dvec3 d) const { return {glm::dot(d, tangent_), glm::dot(d, bitangent_)}; }

    [[nodiscard]] AreaMoments momentsOf(std::span<const glm::dvec3> corners, double times) const
    {
        AreaMoments sum;
        for (std::size_t i = 2; i < corners.size(); ++i) {
            const glm::dvec3 a = corners[0], b = corners[i - 1], c = corners[i];
            const double area = 0.5 * times * glm::length(glm::cross(b - a, c - a));
            sum += momentsOfTriangle(flat(a), flat(b), flat(c), area);
        }
        return sum;
    }

    /// The part within radii below number `whole`. `across`: twice the area as it is stretched, along its normal;
    /// `size`: what stands for it.
    void cut(std::span<const glm::dvec3> at, glm::dvec3 across, double size, std::size_t whole)
    {
        const double grown = glm::length(across);
        if (!(grown > 0.0)) return;
        const glm::dvec3 n = across / grown, aside = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        const glm::dvec3 x = glm::normalize(glm::cross(n, aside)), y = glm::cross(n, x);
        const double height = glm::dot(at[0], n);
        if (height * height >= squared(whole - 1)) return;
        std::array<glm::dvec2, FacetPart::kMost> corners;
        for (std::size_t i = 0; i < at.size(); ++i) corners[i] = glm::dvec2(glm::dot(at[i], x), glm::dot(at[i], y));
        const glm::dvec2 tx = flat(x), ty = flat(y), shift = flat(height * n);
        for (std::size_t j = whole; j-- > 0;) {
            const double disc = squared(j) - height * height;
            if (!(disc > 0.0)) return;
            const AreaMoments part = momentsInDisc(std::span(corners).first(at.size()), std::sqrt(disc));
            if (!(part.area > 0.0)) return; // smaller discs have nothing either
            out_[j] += part.moved({tx, ty}, shift).scaled(size / grown);
        }
    }

    std::span<const float> radii_;
    std::span<AreaMoments> out_;
    std::array<AreaMoments, SurfaceArea::kMostRadii> whole_{};
    glm::dvec3 centre_, normal_, tangent_{0.0}, bitangent_{0.0};
    double stretch_;
};

/// Adds what no screen hides of a facet.
void addSeen(const ReachedFacet& facet, const KernelPlace& place, KernelSum& sum)
{
    const std::array corners{facet.a - place.centre, facet.b - place.centre, facet.c - place.centre};
    FacetPart part(fromCentre(facet, place.centre));
    for (const Screen& screen : place.screens) {
        const Screen::Part hidden = screen.partOf(corners);
        if (hidden == Screen::Part::all) return;
        if (hidden == Screen::Part::some && screen.isInAllDirections()) part.dropBeyond(screen);
    }
    sum.add(part.corners(), 1.0);
    for (const Screen& wall : place.screens) {
        if (wall.isInAllDirections() || wall.partOf(corners) == Screen::Part::none) continue;
        FacetPart hidden = part;
        hidden.keepHidden(wall);
        sum.add(hidden.corners(), -1.0);
    }
}

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

bool SurfaceArea::mayHide(const KernelPlace& place, std::size_t block) const
{
    const BoxGroups::Box box = boxes_.box(block);
    return std::ranges::any_of(place.screens, [&](const Screen& screen) {
        return screen.mayHide(box.low - place.centre, box.high - place.centre);
    });
}

void SurfaceArea::under(const KernelPlace& place, std::span<const float> radii, std::span<AreaMoments> out) const
{
    assert(radii.size() <= kMostRadii && out.size() == radii.size());
    KernelSum sum(place, radii, out);
    if (blocks_.empty() || radii.empty()) return;
    const Frame frame(place.normal);
    const float least = kSmall * radii.front();
    BlockSums small(place.centre, place.normal, frame.tangent, frame.bitangent, place.stretch, place.leastCosine, least,
                    radii);
    thread_local BoxGroups::Near near;
    // the ellipsoid lies within the ball
    for (const std::uint64_t key : boxes_.within(place.centre, radii.back() * radii.back(), near)) {
        const auto number = static_cast<std::uint32_t>(key);
        const std::uint32_t first = number * FacetBlock::kCount;
        std::uint32_t large[FacetBlock::kCount];
        const FacetBlock& block = blocks_[number];
        const auto addLarge = [&](std::size_t count) {
            for (std::size_t i = 0; i < count; ++i) sum.add(facets_[large[i]]);
        };
        const auto addWhole = [&](const FacetBlock& facets) { addLarge(small.add(facets, first, large)); };
        if (!mayHide(place, number)) {
            addWhole(block);
            continue;
        }
        const FacetsSeen seen(block, place.screens, place.centre, place.normal, place.leastCosine,
                              kTiny * radii.front());
        if (seen.touched == 0) {
            addWhole(block);
            continue;
        }
        FacetBlock left = block;
        seen.keepSeen(left);
        addWhole(left);
        for (unsigned bits = seen.cut; bits != 0; bits &= bits - 1)
            addSeen(facets_[first + static_cast<std::uint32_t>(std::countr_zero(bits))], place, sum);
    }
    sum.finish();
    for (std::size_t j = 0; j < radii.size(); ++j) out[j] += small.sum(j);
}

bool SurfaceArea::isAnyHidden(const KernelPlace& place, float radius) const
{
    const auto hides = [&](const Screen& screen, const ReachedFacet& facet) {
        const std::array at{facet.a - place.centre, facet.b - place.centre, facet.c - place.centre};
        if (screen.partOf(at) == Screen::Part::none) return false;
        FacetPart hidden(fromCentre(facet, place.centre));
        hidden.keepHidden(screen);
        if (hidden.corners().empty()) return false;
        glm::dvec3 low = hidden.corners()[0], high = low;
        for (const glm::dvec3 corner : hidden.corners()) low = glm::min(low, corner), high = glm::max(high, corner);
        return glm::length(glm::max(glm::max(low, -high), glm::dvec3(0.0))) < static_cast<double>(radius);
    };
    const auto may = [&](glm::vec3 low, glm::vec3 high) {
        low -= place.centre, high -= place.centre;
        const glm::vec3 gap = glm::max(glm::max(low, -high), glm::vec3(0.0f));
        return glm::dot(gap, gap) <= radius * radius &&
               std::ranges::any_of(place.screens, [&](const Screen& screen) { return screen.mayHide(low, high); });
    };
    return boxes_.any(may, [&](std::size_t number) {
        const FacetsSeen seen(blocks_[number], place.screens, place.centre, place.normal, place.leastCosine, 0.0f);
        for (unsigned bits = seen.touched; bits != 0; bits &= bits - 1) {
            const ReachedFacet& facet =
                facets_[number * FacetBlock::kCount + static_cast<std::size_t>(std::countr_zero(bits))];
            if (std::ranges::any_of(place.screens, [&](const Screen& screen) { return hides(screen, facet); }))
                return true;
        }
        return false;
    });
}

double SurfaceArea::under(const KernelPlace& place, float radius) const
{
    AreaMoments moments;
    under(place, std::span(&radius, 1), std::span(&moments, 1));
    return moments.area;
}

} // namespace lightloom
