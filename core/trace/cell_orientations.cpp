// SPDX-License-Identifier: Apache-2.0
#include "core/trace/cell_orientations.h"
#include <algorithm>
#include <numeric>

namespace lightloom {

std::size_t CellOrientations::add(const CellPiece& piece, glm::vec3 normal)
{
    const std::size_t number = bestFor(normal);
    Gathering& to = open_[number];
    const double area = static_cast<double>(piece.area);
    to.normal += area * glm::dvec3(normal);
    to.moment += area * (glm::dvec3(piece.centroid) - glm::dvec3(lowest_));
    to.area += area;
    return number;
}

std::size_t CellOrientations::bestFor(glm::vec3 normal)
{
    std::size_t best = open_.size();
    double bestCosine = -2.0;
    for (std::size_t i = 0; i < open_.size(); ++i) {
        // sums within 53 degrees of their mean never cancel: the length is positive
        const double cosine = glm::dot(glm::normalize(open_[i].normal), glm::dvec3(normal));
        if (cosine > bestCosine) bestCosine = cosine, best = i;
    }
    const bool joins =
        !open_.empty() && (bestCosine >= static_cast<double>(kSameOrientation) || open_.size() >= kMostOrientations);
    if (!joins) open_.emplace_back(), best = open_.size() - 1;
    return best;
}

std::span<const std::size_t> CellOrientations::finish(std::vector<Orientation>& out)
{
    order_.resize(open_.size());
    std::iota(order_.begin(), order_.end(), std::size_t(0));
    std::ranges::stable_sort(order_, [&](std::size_t a, std::size_t b) { return open_[a].area > open_[b].area; });
    for (const std::size_t number : order_) {
        const Gathering& g = open_[number];
        const glm::dvec3 centroid = glm::dvec3(lowest_) + g.moment / g.area;
        out.push_back({glm::vec3(centroid), glm::vec3(glm::normalize(g.normal)), static_cast<float>(g.area)});
    }
    open_.clear();
    return order_;
}

} // namespace lightloom
