// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_smooth.h"
#include "core/base/units.h"
#include "core/ivg/grid_openness.h"
#include <algorithm>
#include <optional>

namespace lightloom {
namespace {

constexpr std::array kReaches{1, 2};          ///< cells to the neighbours, one pass after the other
constexpr std::size_t kBlock = 1024;          ///< vertices
constexpr float kCertain = 6.0f;              ///< times its variance: a difference that is hardly noise
constexpr float kTogetherSmoothed = 2.1f;     ///< variance of a lookup over what independent vertices would have:
constexpr float kTogetherByPatches = 1.33f;   ///< neighbours hear of the same patches,
constexpr float kTogetherAcrossPlanes = 2.0f; ///< also those one behind the other

/// Two neighbours on opposite sides.
struct Pair {
    std::uint32_t a, b;
    float weight;
};
struct Pairs {
    std::array<Pair, 4> all;
    std::size_t count = 0;
    [[nodiscard]] const Pair* begin() const { return all.data(); }
    [[nodiscard]] const Pair* end() const { return all.data() + count; }
};

/// Which vertices of a plane of `axis` are smoothed with which.
class Neighbours {
public:
    Neighbours(const GridGeometry& geometry, GridEstimator estimator, int axis, int reach)
        : lattice_(geometry.lattice), openness_(geometry.openness), estimator_(estimator), axis_(axis), reach_(reach)
    {
    }
    [[nodiscard]] Pairs of(std::size_t vertex) const
    {
        Pairs pairs;
        if (share(vertex) < kLeastOpen) return pairs;
        for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(0, 1), glm::ivec2(1, 1), glm::ivec2(1, -1)}) {
            const auto a = seen(vertex, step), b = seen(vertex, -step);
            if (!a || !b) continue;
            // variances go with one over the share
            const float weight = 2.0f / (1.0f / share(*a) + 1.0f / share(*b));
            pairs.all[pairs.count++] = {static_cast<std::uint32_t>(*a), static_cast<std::uint32_t>(*b), weight};
        }
        return pairs;
    }

private:
    [[nodiscard]] float share(std::size_t v) const
    {
        if (openness_.isOpen[v] == 0) return 0.0f;
        return estimator_ == GridEstimator::tracks ? openness_.cellShare[v] : openness_.faceShare[v][axis_];
    }
    /// One vertex further along an axis, if both see each other.
    [[nodiscard]] bool goesOn(glm::ivec3& at, int along, int way) const
    {
        if (way == 0) return true;
        const std::size_t from = lattice_.index(at);
        at[along] += way;
        if (at[along] < 0 || at[along] > lattice_.cells[along]) return false;
        const std::size_t to = lattice_.index(at), ahead = static_cast<std::size_t>(2 * along + (way > 0 ? 1 : 0));
        return openness_.isOpen[to] != 0 && openness_.sight[from][ahead] >= GridOpenness::kSightUnits &&
               openness_.sight[to][ahead ^ 1] >= GridOpenness::kSightUnits;
    }
    /// The vertex `step` times the reach away, where both ways around the corner are free.
    [[nodiscard]] std::optional<std::size_t> seen(std::size_t vertex, glm::ivec2 step) const
    {
        const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
        glm::ivec3 at = lattice_.vertex(vertex), other = at;
        for (int i = 0; i < reach_; ++i) {
            if (!goesOn(at, u, step.x) || !goesOn(at, v, step.y)) return {};
            if (!goesOn(other, v, step.y) || !goesOn(other, u, step.x)) return {};
        }
        const std::size_t found = lattice_.index(at);
        return share(found) < kLeastOpen ? std::nullopt : std::optional(found);
    }

    const GridLattice& lattice_;
    const GridOpenness& openness_;
    GridEstimator estimator_;
    int axis_, reach_;
};

/// Calls visit(vertex) for all, on all threads.
template<class Visit>
void forVertices(std::size_t count, Workers& workers, const Visit& visit)
{
    workers.run((count + kBlock - 1) / kBlock, {}, [&](std::size_t block) {
        for (std::size_t v = block * kBlock; v < std::min(count, (block + 1) * kBlock); ++v) visit(v);
    });
}

/// Values of one direction at all vertices, and how they err.
template<class Value>
struct Noisy {
    std::vector<Value> values;
    std::vector<float> light, variance; ///< luminance of the values and its variance
    std::vector<float> kept;            ///< of a value itself, what smoothing left of it
    explicit Noisy(std::size_t count) : values(count), light(count), variance(count), kept(count, 1.0f) {}

    void smooth(const std::vector<Pairs>& pairs, Workers& workers)
    {
        struct Around {
            Value value{0.0f};     // mean over the pairs,
            float variance = 0.0f; // its variance
            float light = 0.0f;    // and luminance
            float own = 0.0f;      // variance of the vertex itself, as it is around: alone it goes with its own noise
            float excess = 0.0f;   // of the squared difference to the mean, over what is noise
            float certain = 0.0f;  // the same over kCertain times that
        };
        const std::size_t count = values.size();
        std::vector<Around> around(count);
        forVertices(count, workers, [&](std::size_t v) {
            if (pairs[v].count == 0) return;
            Around& a = around[v];
            float sum = 0.0f;
            a.own = variance[v];
            for (const Pair& p : pairs[v]) {
                const float w = 0.5f * p.weight;
                sum += p.weight;
                a.value += w * (values[p.a] + values[p.b]), a.light += w * (light[p.a] + light[p.b]);
                a.variance += w * w * (variance[p.a] + variance[p.b]);
                a.own += variance[p.a] + variance[p.b];
            }
            a.value /= sum, a.light /= sum, a.variance /= sum * sum;
            a.own /= static_cast<float>(1 + 2 * pairs[v].count);
            const float miss = light[v] - a.light;
            a.excess = miss * miss - a.own - a.variance;
            a.certain = miss * miss - kCertain * (a.own + a.variance);
        });
        forVertices(count, workers, [&](std::size_t v) {
            if (pairs[v].count == 0) return;
            const Around& a = around[v];
            float excess = a.excess, sum = 1.0f;
            for (const Pair& p : pairs[v]) {
                for (const std::uint32_t other : {p.a, p.b}) {
                    if (pairs[other].count == 0) continue;
                    excess += around[other].excess, sum += 1.0f;
                }
            }
            const float apart = std::max({excess / sum, a.certain, 0.0f}) + a.variance;
            if (!(apart + a.own > 0.0f)) return;
            const float keep = apart / (apart + a.own);
            values[v] = keep * values[v] + (1.0f - keep) * a.value;
            light[v] = keep * light[v] + (1.0f - keep) * a.light;
            variance[v] = keep * keep * variance[v] + (1.0f - keep) * (1.0f - keep) * a.variance;
            kept[v] *= keep;
        });
    }
};

/// Calls visit(direction, passes) for all six; passes[i] are the pairs of the i-th pass.
template<class Visit>
void forDirections(const GridGeometry& geometry, GridEstimator estimator, Workers& workers, const Visit& visit)
{
    const std::size_t count = geometry.lattice.vertexCount();
    std::array<std::vector<Pairs>, kReaches.size()> passes;
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t pass = 0; pass < passes.size(); ++pass) {
            const Neighbours neighbours(geometry, estimator, axis, kReaches[pass]);
            passes[pass].resize(count);
            forVertices(count, workers, [&](std::size_t v) { passes[pass][v] = neighbours.of(v); });
        }
        for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
            visit(2 * static_cast<std::size_t>(axis) + side, passes);
    }
}

/// Variance to be stated where `kept` is a value's own part and neighbours err together `least` times as much as
/// independent ones even then.
float stated(float variance, float kept, float least) { return variance * glm::mix(kTogetherSmoothed, least, kept); }

} // namespace

void smoothVectors(const GridGeometry& geometry, GridEstimator estimator, GridLayer& layer, Workers& workers)
{
    const std::size_t count = geometry.lattice.vertexCount();
    forDirections(geometry, estimator, workers, [&](std::size_t d, const auto& passes) {
        Noisy<glm::mat3> noisy(count);
        forVertices(count, workers, [&](std::size_t v) {
            noisy.values[v] = layer.vectors[v][d], noisy.variance[v] = layer.variance[v][d];
            noisy.light[v] = luminance(alongAxis(layer.vectors[v], d));
        });
        for (const std::vector<Pairs>& pairs : passes) noisy.smooth(pairs, workers);
        forVertices(count, workers, [&](std::size_t v) {
            layer.vectors[v][d] = noisy.values[v];
            layer.variance[v][d] = stated(noisy.variance[v], noisy.kept[v], 1.0f);
        });
    });
}

void smoothFit(const GridGeometry& geometry, GridEstimator estimator, const SurfaceFit& fit, GridLayer& layer,
               Workers& workers)
{
    const std::size_t count = geometry.lattice.vertexCount();
    layer.onSurface.resize(count);
    forDirections(geometry, estimator, workers, [&](std::size_t d, const auto& passes) {
        Noisy<glm::vec3> noisy(count);
        forVertices(count, workers, [&](std::size_t v) {
            noisy.values[v] = alongAxis(layer.vectors[v], d) + fit.correction[v][d];
            noisy.light[v] = luminance(noisy.values[v]);
            noisy.variance[v] = fit.isFitted(v, d) ? fit.variance[v][d] : layer.variance[v][d];
        });
        for (const std::vector<Pairs>& pairs : passes) noisy.smooth(pairs, workers);
        forVertices(count, workers, [&](std::size_t v) {
            if (!fit.isFitted(v, d)) return;
            layer.onSurface[v][d] = noisy.values[v] - alongAxis(layer.vectors[v], d);
            layer.variance[v][d] = kTogetherAcrossPlanes * stated(noisy.variance[v], noisy.kept[v], kTogetherByPatches);
        });
    });
}

} // namespace lightloom
