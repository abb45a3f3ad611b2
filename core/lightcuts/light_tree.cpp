// SPDX-License-Identifier: Apache-2.0
#include "core/lightcuts/light_tree.h"
#include "core/base/rng.h"
#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

namespace lightloom {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNormalScale = 0.25f;  ///< of the diagonal of all positions: METHODS 5, by measurement
constexpr float kMostFlux = 1e30f;     ///< lm of one light: sums of many stay finite
constexpr float kConeSlack = 0x1p-21f; ///< of a cone's cosine: more than rounding takes away

/// A light as a point in six dimensions.
struct Place {
    std::array<float, 6> at;
    std::uint32_t light;
};

bool isSound(const DiscLight& light)
{
    return isFinite(light.position) && isFinite(light.normal) && light.area > 0.0f && light.area < kInfinity;
}

/// Parts `places` in two, neither empty, halfway along the longest side of their box; where all are at one place, in
/// the middle of the list. Where the second part begins.
std::size_t part(std::span<Place> places)
{
    std::array<float, 6> low = places[0].at, high = low;
    for (const Place& place : places.subspan(1)) {
        for (std::size_t k = 0; k < 6; ++k) {
            low[k] = std::min(low[k], place.at[k]);
            high[k] = std::max(high[k], place.at[k]);
        }
    }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 6; ++k) {
        if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    }
    const float middle = 0.5f * low[axis] + 0.5f * high[axis];
    const auto second =
        std::partition(places.begin(), places.end(), [&](const Place& place) { return place.at[axis] < middle; });
    const auto found = static_cast<std::size_t>(second - places.begin());
    return found == 0 || found == places.size() ? places.size() / 2 : found;
}

} // namespace

std::shared_ptr<const LightTree::Split> LightTree::splitUp(std::span<const DiscLight> lights, float cellSize,
                                                           std::uint64_t seed)
{
    auto split = std::make_shared<Split>();
    split->cellSize = cellSize;
    split->seed = seed;
    glm::vec3 low(kInfinity), high(-kInfinity);
    for (const DiscLight& light : lights) {
        if (isSound(light)) low = glm::min(low, light.position), high = glm::max(high, light.position);
    }
    const float scale = lights.empty() ? 0.0f : kNormalScale * glm::length(high - low);
    std::vector<Place> places;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const DiscLight& light = lights[i];
        const glm::vec3 p = isSound(light) ? light.position : glm::vec3(0.0f);
        const glm::vec3 n = isSound(light) ? scale * light.normal : glm::vec3(0.0f);
        places.push_back({{p.x, p.y, p.z, n.x, n.y, n.z}, i});
    }
    if (!places.empty()) {
        split->ranges.push_back({0, static_cast<std::uint32_t>(places.size())});
        split->children.push_back(0);
    }
    for (std::size_t node = 0; node < split->ranges.size(); ++node) {
        const Range range = split->ranges[node];
        if (range.last - range.first < 2) continue;
        const auto first = static_cast<std::uint32_t>(
            range.first + part(std::span(places).subspan(range.first, range.last - range.first)));
        split->children[node] = static_cast<std::uint32_t>(split->ranges.size());
        split->ranges.push_back({range.first, first});
        split->ranges.push_back({first, range.last});
        split->children.insert(split->children.end(), 2, 0);
    }
    for (const Place& place : places) {
        split->order.push_back(place.light);
        split->lights.push_back(lights[place.light]);
    }
    return split;
}

std::shared_ptr<const LightTree> LightTree::build(std::span<const DiscLight> lights,
                                                  std::span<const glm::vec3> exitance, float cellSize,
                                                  std::uint64_t seed)
{
    std::shared_ptr<LightTree> tree(new LightTree(splitUp(lights, cellSize, seed)));
    tree->light(exitance);
    return tree;
}

std::shared_ptr<const LightTree> LightTree::withExitance(std::span<const glm::vec3> exitance) const
{
    std::shared_ptr<LightTree> tree(new LightTree(split_));
    tree->light(exitance);
    return tree;
}

void LightTree::light(std::span<const glm::vec3> exitance)
{
    assert(exitance.size() == lights().size());
    flux_.resize(lights().size());
    for (std::size_t i = 0; i < flux_.size(); ++i) {
        const glm::vec3 flux = lights()[i].area * glm::max(exitance[split_->order[i]], glm::vec3(0.0f));
        flux_[i] = isSound(lights()[i]) && isFinite(flux) ? glm::min(flux, kMostFlux) : glm::vec3(0.0f);
    }
    nodes_.resize(split_->children.size());
    means_.resize(nodes_.size());
    for (std::size_t node = nodes_.size(); node-- > 0;) {
        const std::uint32_t child = split_->children[node], light = split_->ranges[node].first;
        nodes_[node] = child == 0 ? leaf(light) : joined(node);
        means_[node] = child == 0 ? lights()[light] : meanOf(child);
    }
}

DiscLight LightTree::meanOf(std::uint32_t child) const
{
    const float one = luminance(nodes_[child].flux), other = luminance(nodes_[child + 1].flux);
    const DiscLight &a = means_[child], &b = means_[child + 1];
    if (!(other > 0.0f)) return a;
    if (!(one > 0.0f)) return b;
    const float t = other / (one + other), s = 1.0f - t;
    // a square has six times the mean squared distance from its middle; that of both is of each, and of their middles
    const glm::vec3 apart = b.position - a.position;
    const float area = s * a.area + t * b.area + 6.0f * s * t * glm::dot(apart, apart);
    return {s * a.position + t * b.position, area, s * a.normal + t * b.normal};
}

LightNode LightTree::leaf(std::uint32_t light) const
{
    const DiscLight& l = lights()[light];
    if (flux_[light] == glm::vec3(0.0f))
        return {glm::vec3(kInfinity),
                glm::vec3(-kInfinity),
                glm::vec3(0.0f),
                {0.0f, 0.0f, 1.0f},
                1.0f,
                kInfinity,
                0,
                light};
    return {l.position, l.position, flux_[light], l.normal, 1.0f - kConeSlack, l.area, 0, light};
}

LightNode LightTree::joined(std::size_t node) const
{
    const std::uint32_t child = split_->children[node];
    const LightNode &one = nodes_[child], &other = nodes_[child + 1];
    LightNode both = one;
    both.low = glm::min(one.low, other.low);
    both.high = glm::max(one.high, other.high);
    both.flux = one.flux + other.flux;
    both.leastArea = std::min(one.leastArea, other.leastArea);
    both.child = child;
    const float first = luminance(one.flux), all = first + luminance(other.flux);
    const float drawn = Rng(split_->seed, hashName("light tree"), node).uniform();
    both.chosen = drawn * all < first ? one.chosen : other.chosen;
    if (!(all > 0.0f)) return both;

    const Range range = split_->ranges[node];
    glm::vec3 sum(0.0f);
    for (std::uint32_t i = range.first; i < range.last; ++i) {
        if (flux_[i] != glm::vec3(0.0f)) sum += lights()[i].normal;
    }
    const float length = glm::length(sum);
    both.axis = length > 0.0f ? sum / length : glm::vec3(0.0f, 0.0f, 1.0f);
    float cosine = 1.0f;
    for (std::uint32_t i = range.first; i < range.last; ++i) {
        if (flux_[i] != glm::vec3(0.0f)) cosine = std::min(cosine, glm::dot(both.axis, lights()[i].normal));
    }
    both.cosine = cosine - kConeSlack;
    return both;
}

std::size_t LightTree::memoryBytes() const
{
    return nodes_.size() * (sizeof(LightNode) + sizeof(DiscLight) + sizeof(std::uint32_t) + sizeof(Range)) +
           flux_.size() * (sizeof(glm::vec3) + sizeof(DiscLight) + sizeof(std::uint32_t));
}

} // namespace lightloom
