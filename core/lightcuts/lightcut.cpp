// SPDX-License-Identifier: Apache-2.0
#include "core/lightcuts/lightcut.h"
#include "core/base/rng.h"
#include "core/base/sampling.h"
#include "core/lightcuts/cluster_bound.h"
#include <algorithm>
#include <bit>
#include <cmath>

namespace lightloom {
namespace {

/// Cells: rays alone up to here, discs alone from there. Between 1.5 to 2.5 and 2 to 4 nothing depends on it.
constexpr float kNearFrom = 1.5f, kNearTo = 3.0f;
/// Errors of clusters add up by the root of their number. In larger cuts each may be off by so much less. Those along
/// shadows' edges are wrong together: where more than kManyEdges were parted there, each may be off by less once more.
constexpr int kFewNodes = 400, kManyEdges = 115;
/// Where one of two halves is hidden and the other is not a shadow's edge falls into the cluster, and what stands for
/// either may be wrong for it all: their bounds count so many times, that of their own halves kSettling of it, and so
/// on. Clusters in half shadow are what a cut's error is made of.
constexpr float kHalfShadow = 4.0f, kSettling = 0.8f;

bool isPlace(const Receiver& at)
{
    return isFinite(at.position) && isFinite(at.normal) && at.normal != glm::vec3(0.0f);
}

/// A place in the plane of a light, drawn by where it is: within a square of side 1 around it.
glm::vec3 asideOf(const DiscLight& light)
{
    const auto bits = [](float v) { return std::uint64_t{std::bit_cast<std::uint32_t>(v)}; };
    const glm::vec3 p = light.position;
    Rng rng(bits(p.x) << 32 | bits(p.y), hashName("end of a shadow ray"), bits(p.z));
    const float u = rng.uniform() - 0.5f, v = rng.uniform() - 0.5f;
    return Frame(light.normal).toWorld({u, v, 0.0f});
}

} // namespace

/// A cut for one receiver: a heap of clusters by their bounds, the largest of which is parted first.
class CutWalk {
public:
    CutWalk(const Lightcuts& cuts, const Receiver& at, std::vector<CutLight>* seen)
        : cuts_(cuts), at_(at), origin_(cuts.rays_->leave(at.position, at.normal)),
          seen_(seen), surface_{cuts.surface_.get(), cuts.near_, ClusterBound(at, cuts.near_)},
          lamps_{cuts.lamps_.get(), NearRange{}, ClusterBound(at, NearRange{})}
    {
        heap_.reserve(512);
    }

    /// `near`: what near rays have found already.
    Lightcut refine(glm::vec3 near, const LightcutParams& params)
    {
        result_.illuminance = near;
        total_ = static_cast<double>(luminance(near));
        for (const Lights* lights : {&surface_, &lamps_}) {
            if (lights->tree && !lights->tree->nodes().empty()) add(look(*lights, 0, {}));
        }
        while (!heap_.empty() && !isFine(params)) {
            std::ranges::pop_heap(heap_, {}, &Cluster::doubted);
            const Cluster cluster = heap_.back();
            heap_.pop_back();
            part(cluster);
        }
        return finish();
    }

private:
    struct Lights {
        const LightTree* tree;
        NearRange near;
        ClusterBound bounds;
    };
    /// What is known of the light that stands for a cluster, and stays true for the half that keeps it.
    struct Standing {
        bool isLookedFor = false, isHidden = false; // by a shadow ray
        bool isInView = false;                      // all of the cluster
        float doubt = 1.0f;                         // by which its bound counts
    };
    struct Cluster {
        float bound;    // lux of luminance
        float transfer; // lux per lumen
        std::uint32_t node;
        bool isLamp;
        Standing standing;
        [[nodiscard]] float doubted() const { return bound * standing.doubt; }
    };
    [[nodiscard]] const Lights& lightsOf(const Cluster& cluster) const { return cluster.isLamp ? lamps_ : surface_; }

    [[nodiscard]] bool isFine(const LightcutParams& params) const
    {
        if (params.mostNodes > 0 && result_.nodes >= params.mostNodes) return true;
        const double few = kFewNodes, many = kManyEdges;
        const double share =
            std::sqrt(std::min(1.0, few / std::max(1, result_.nodes))) * std::min(1.0, many / std::max(1, edges_));
        return static_cast<double>(heap_.front().doubted()) <= share * static_cast<double>(params.threshold) * total_;
    }

    void part(const Cluster& cluster)
    {
        const Lights& lights = lightsOf(cluster);
        const std::span<const LightNode> nodes = lights.tree->nodes();
        const LightNode& node = nodes[cluster.node];
        total_ -= static_cast<double>(luminance(node.flux)) * static_cast<double>(cluster.transfer);
        --result_.nodes;
        const auto half = [&](std::uint32_t child) {
            Standing standing = cluster.standing;
            if (nodes[child].chosen != node.chosen) standing.isLookedFor = false;
            return look(lights, child, standing);
        };
        Cluster one = half(node.child), other = half(node.child + 1);
        const Standing &a = one.standing, &b = other.standing;
        const bool isHalfShadow = a.isLookedFor && b.isLookedFor && a.isHidden != b.isHidden;
        edges_ += isHalfShadow ? 1 : 0;
        const float doubt = isHalfShadow ? kHalfShadow : glm::max(1.0f, kSettling * cluster.standing.doubt);
        for (Cluster* child : {&one, &other}) {
            child->standing.doubt = doubt;
            add(*child);
        }
    }

    /// What a cluster sends here, as far as one can tell.
    Cluster look(const Lights& lights, std::uint32_t number, Standing standing)
    {
        const LightNode& node = lights.tree->nodes()[number];
        const float most = lights.bounds.transfer(node), light = luminance(node.flux);
        if (!(most * light > 0.0f)) return {0.0f, 0.0f, number, false, {}}; // nothing of it arrives here
        standing.isInView = standing.isInView || lights.bounds.isInView(node);
        const float transfer = std::min(most, transferFrom(lights, number, standing));
        return {most * light, transfer, number, &lights == &lamps_, standing};
    }

    /// Adds a cluster to the cut.
    void add(const Cluster& cluster)
    {
        if (!(cluster.bound > 0.0f)) return;
        const LightNode& node = lightsOf(cluster).tree->nodes()[cluster.node];
        ++result_.nodes;
        total_ += static_cast<double>(luminance(node.flux)) * static_cast<double>(cluster.transfer);
        if (node.isLeaf()) {
            take(cluster);
        } else {
            heap_.push_back(cluster);
            std::ranges::push_heap(heap_, {}, &Cluster::doubted);
        }
    }

    /// A cluster that is wholly in view sends as its mean does, as far as one of its lights is not hidden; of another
    /// that light says all.
    float transferFrom(const Lights& lights, std::uint32_t number, Standing& standing)
    {
        const LightNode& node = lights.tree->nodes()[number];
        const DiscLight& stands = lights.tree->lights()[node.chosen];
        const float transfer = standing.isInView && !node.isLeaf()
                                   ? meanTransfer(at_, lights.tree->mean(number), lights.near)
                                   : discTransfer(at_, stands, lights.near);
        if (!(transfer > 0.0f)) return 0.0f;
        if (!standing.isLookedFor) {
            ++result_.shadowRays;
            standing.isLookedFor = true;
            standing.isHidden = cuts_.rays_->isBlocked(origin_, cuts_.endOfRay(*lights.tree, stands));
        }
        return standing.isHidden ? 0.0f : transfer;
    }

    void take(const Cluster& cluster)
    {
        const Lights& lights = lightsOf(cluster);
        const LightNode& node = lights.tree->nodes()[cluster.node];
        const glm::vec3 lux = node.flux * cluster.transfer;
        sum_ += glm::dvec3(lux);
        if (cluster.isLamp) result_.fromLamps += lux;
        if (seen_ && cluster.transfer > 0.0f) {
            const DiscLight& place =
                cluster.standing.isInView ? lights.tree->mean(cluster.node) : lights.tree->lights()[node.chosen];
            seen_->push_back({glm::normalize(place.position - at_.position), lux});
        }
    }

    Lightcut finish()
    {
        for (const Cluster& cluster : heap_) {
            result_.largestBound = std::max(result_.largestBound, cluster.bound);
            result_.bound += cluster.bound;
            take(cluster);
        }
        result_.illuminance += glm::vec3(sum_);
        return result_;
    }

    const Lightcuts& cuts_;
    const Receiver at_;
    const glm::vec3 origin_;
    std::vector<CutLight>* seen_;
    const Lights surface_, lamps_;
    std::vector<Cluster> heap_;
    double total_ = 0.0; // lux of luminance, as far as it is known
    int edges_ = 0;      // clusters in half shadow that were parted
    glm::dvec3 sum_{0.0};
    Lightcut result_;
};

Lightcuts::Lightcuts(std::shared_ptr<const RayScene> rays, std::shared_ptr<const LightTree> surface,
                     std::shared_ptr<const NearField> near, std::shared_ptr<const LightTree> lamps)
    : rays_(std::move(rays)), surface_(std::move(surface)), lamps_(std::move(lamps)), field_(std::move(near))
{
    if (field_ && surface_) near_ = {kNearFrom * surface_->cellSize(), kNearTo * surface_->cellSize()};
}

glm::vec3 Lightcuts::nearLight(const Receiver& at, std::uint64_t number, const LightcutParams& params,
                               std::vector<CutLight>* seen) const
{
    if (!field_) return glm::vec3(0.0f);
    return gatherNear(*rays_, *field_, at, near_, params.nearRays, params.seed, number, seen);
}

Lightcut Lightcuts::at(glm::vec3 p, glm::vec3 n, std::uint64_t number, const LightcutParams& params,
                       std::vector<CutLight>* seen) const
{
    const Receiver at{p, n};
    if (!isPlace(at)) return {};
    return CutWalk(*this, at, seen).refine(nearLight(at, number, params, seen), params);
}

float Lightcuts::visibleTransfer(const LightTree& tree, const Receiver& at, const DiscLight& light) const
{
    const float transfer = discTransfer(at, light, &tree == surface_.get() ? near_ : NearRange{});
    if (!(transfer > 0.0f)) return 0.0f;
    return rays_->isBlocked(rays_->leave(at.position, at.normal), endOfRay(tree, light)) ? 0.0f : transfer;
}

glm::vec3 Lightcuts::endOfRay(const LightTree& tree, const DiscLight& light) const
{
    const glm::vec3 end = light.position + light.normal * glm::max(0.5f * tree.cellSize(), rays_->offset());
    const float half = 0.5f * glm::min(tree.cellSize(), std::sqrt(light.area)); // 0 for lamps
    return half > 0.0f ? end + half * asideOf(light) : end;
}

glm::vec3 Lightcuts::everyLight(glm::vec3 p, glm::vec3 n, std::uint64_t number, const LightcutParams& params) const
{
    const Receiver at{p, n};
    if (!isPlace(at)) return glm::vec3(0.0f);
    glm::dvec3 sum(nearLight(at, number, params));
    for (const LightTree* tree : {surface_.get(), lamps_.get()}) {
        if (!tree) continue;
        for (std::size_t i = 0; i < tree->lights().size(); ++i) {
            if (tree->fluxOf(i) == glm::vec3(0.0f)) continue;
            const float transfer = visibleTransfer(*tree, at, tree->lights()[i]);
            if (transfer > 0.0f) sum += glm::dvec3(tree->fluxOf(i) * transfer);
        }
    }
    return glm::vec3(sum);
}

glm::vec3 Lightcuts::fromSamples(glm::vec3 p, glm::vec3 n, std::uint64_t number, const LightcutParams& params,
                                 const LightSamples& samples, std::size_t first, std::size_t last) const
{
    const Receiver at{p, n};
    if (!isPlace(at)) return glm::vec3(0.0f);
    glm::dvec3 sum(0.0);
    for (std::size_t i = first; i < last && i < samples.count(); ++i) {
        const std::uint32_t light = samples.drawn(i);
        const float transfer = visibleTransfer(*surface_, at, surface_->lights()[light]);
        if (transfer > 0.0f) sum += glm::dvec3(surface_->fluxOf(light) / surface_->lights()[light].area * transfer);
    }
    if (last > first) sum *= samples.area() / static_cast<double>(last - first);
    return nearLight(at, number, params) + glm::vec3(sum);
}

} // namespace lightloom
