// SPDX-License-Identifier: Apache-2.0
#include "core/compare/cost_model.h"
#include <algorithm>
#include <cmath>

namespace lightloom {
namespace {

/// a + b x through the points with relative errors alike; neither below 0. Where the points do not rise: level, or, if
/// what they measure can only rise, through the origin.
struct Line {
    double a = 0, b = 0;
};
template<class Points, class X, class Y>
Line lineThrough(const Points& points, X xOf, Y yOf, bool rises = false)
{
    double n = 0, x1 = 0, x2 = 0, y1 = 0, xy = 0;
    for (const auto& p : points) {
        const double x = xOf(p), y = yOf(p);
        if (!(y > 0.0)) continue;
        const double w = 1.0 / (y * y);
        n += w, x1 += w * x, x2 += w * x * x, y1 += w * y, xy += w * x * y;
    }
    if (!(n > 0.0)) return {};
    const double determinant = n * x2 - x1 * x1;
    if (determinant > 1e-9 * n * x2) {
        const Line line{(x2 * y1 - x1 * xy) / determinant, (n * xy - x1 * y1) / determinant};
        if (line.a >= 0.0 && line.b >= 0.0) return line;
        if (line.a < 0.0 || rises) return {0.0, xy / x2};
    }
    return {y1 / n, 0.0};
}

/// How much longer a photon of `stored` is waited for than one of `measured`. A gather's time per photon rose from 73
/// to 100 ns between 38 thousand and 1.2 million; the tree's share is set so that whole bakes of up to 20 million a
/// lamp come out as foretold.
constexpr double kGatherPerDoubling = 0.07, kTreePerDoubling = 0.04;
double memoryGrowth(double stored, double measured, double perDoubling)
{
    return measured > 0.0 && stored > measured ? 1.0 + perDoubling * std::log2(stored / measured) : 1.0;
}

} // namespace

void CostModel::fitGather(std::span<const GatherSample> samples)
{
    const Line gather = lineThrough(
        samples, [](const GatherSample& s) { return s.count; }, [](const GatherSample& s) { return s.gatherSeconds; },
        true); // on a busy machine noise may say otherwise, and budgets would take any K for nothing
    const Line area = lineThrough(
        samples, [](const GatherSample& s) { return s.count / s.photons; },
        [](const GatherSample& s) { return s.areaSeconds; });
    gatherBase = gather.a, gatherPerPhoton = gather.b;
    areaBase = area.a, areaPerRatio = area.b;
}

double CostModel::seconds(int depth, double count, double photons) const
{
    const double stored = std::max(photons * storedPerPhoton, 2.0);
    const double tree = treePerNLogN * memoryGrowth(stored, measuredWith, kTreePerDoubling);
    double perGroup = shootPerPhoton * photons + tree * stored * std::log2(stored);
    double once = fixedSeconds;
    for (const Depth& d : depths) {
        if (d.depth != depth) continue;
        once += d.buildSeconds;
        const double each = gatherPerPhoton * memoryGrowth(stored, measuredWith, kGatherPerDoubling);
        perGroup += d.entries * (gatherBase + each * count + areaBase + areaPerRatio * count / std::max(photons, 1.0));
    }
    return once + groups * perGroup;
}

} // namespace lightloom
