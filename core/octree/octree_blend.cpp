// SPDX-License-Identifier: Apache-2.0
#include "core/octree/octree_blend.h"
#include "core/octree/entry_side.h"
#include "shaders/common.h"

namespace lightloom {
namespace {

/// Whether a cell of a level is covered by a larger one that is not split and answers for `n`.
bool isAnsweredAbove(const OctreeGeometry& base, const LampDetail& detail, std::size_t level, glm::ivec3 cell,
                     glm::vec3 n)
{
    while (true) {
        cell = cell >> 1;
        if (detail[level].geometry->splits(cell)) return false; // the cell asked for is a void between its siblings
        const OctreeGeometry& above = level == 0 ? base : *detail[level - 1].geometry;
        if (const std::int64_t leaf = above.leafAt(cell); leaf >= 0) return entryFor(above, leaf, n) >= 0;
        if (level-- == 0) return false;
    }
}

/// Of corner number `i`.
void add(Answers& answers, const OctreeGeometry& geometry, std::int64_t leaf, const Corners& corners, std::size_t i,
         glm::vec3 n)
{
    const auto [entry, isBeyond] = entryFor(geometry, leaf, n, corners.at - glm::vec3(corners.cells[i]));
    if (entry < 0) return;
    const float weight = isBeyond ? shader::kBeyondCounts * corners.weights[i] : corners.weights[i];
    answers.entries[static_cast<std::size_t>(answers.count)] = static_cast<std::size_t>(entry);
    answers.weights[static_cast<std::size_t>(answers.count)] = weight;
    ++answers.count;
    answers.sum += weight;
}

} // namespace

std::int64_t entryFor(const OctreeGeometry& geometry, std::int64_t leaf, glm::vec3 n)
{
    std::int64_t best = -1;
    float bestCosine = kCompatibleCosine;
    const auto i = static_cast<std::size_t>(leaf);
    for (std::uint32_t e = geometry.firstEntry[i]; e < geometry.firstEntry[i + 1]; ++e) {
        const float cosine = glm::dot(geometry.entries[e].normal, n);
        if (cosine > bestCosine) bestCosine = cosine, best = e; // the first of equals: the one with more surface
    }
    return best;
}

EntryThere entryFor(const OctreeGeometry& geometry, std::int64_t leaf, glm::vec3 n, glm::vec3 fromMiddle)
{
    EntryThere best;
    float bestCosine = kCompatibleCosine;
    const auto i = static_cast<std::size_t>(leaf);
    for (std::uint32_t e = geometry.firstEntry[i]; e < geometry.firstEntry[i + 1]; ++e) {
        const float cosine = glm::dot(geometry.entries[e].normal, n);
        if (cosine <= kCompatibleCosine) continue;
        const bool beyond = isBeyond(geometry.entries[e], fromMiddle);
        if (beyond < best.isBeyond || (beyond == best.isBeyond && cosine > bestCosine))
            bestCosine = cosine, best = {e, beyond};
    }
    return best;
}

Corners cornersAround(const OctreeGeometry& lattice, glm::vec3 p)
{
    Corners corners;
    const glm::vec3 at = (p - lattice.lowest) / lattice.cellSize() - 0.5f;
    const glm::vec3 base = glm::floor(at), part = at - base;
    // far outside the lattice (or NaN) no neighbour exists, and a cast to int would overflow
    if (!(glm::length(base) < 4e6f)) return corners;
    corners.at = at;
    const glm::ivec3 cell(base);
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 step(i & 1, i >> 1 & 1, i >> 2 & 1);
        const float weight =
            (step.x ? part.x : 1.0f - part.x) * (step.y ? part.y : 1.0f - part.y) * (step.z ? part.z : 1.0f - part.z);
        if (!(weight > 0.0f)) continue;
        corners.cells[static_cast<std::size_t>(corners.count)] = cell + step;
        corners.weights[static_cast<std::size_t>(corners.count)] = weight;
        ++corners.count;
    }
    return corners;
}

Answers answersAround(const OctreeGeometry& geometry, glm::vec3 p, glm::vec3 n)
{
    Answers answers;
    const Corners corners = cornersAround(geometry, p);
    for (std::size_t i = 0; i < static_cast<std::size_t>(corners.count); ++i) {
        const std::int64_t leaf = geometry.leafAt(corners.cells[i]);
        if (leaf >= 0) add(answers, geometry, leaf, corners, i, n);
    }
    return answers;
}

Answers answersAround(const OctreeGeometry& base, const LampDetail& detail, std::size_t level, glm::vec3 p, glm::vec3 n)
{
    Answers answers;
    const OctreeGeometry& geometry = *detail[level].geometry;
    const Corners corners = cornersAround(geometry, p);
    for (std::size_t i = 0; i < static_cast<std::size_t>(corners.count); ++i) {
        const std::int64_t leaf = geometry.leafAt(corners.cells[i]);
        if (leaf >= 0) {
            add(answers, geometry, leaf, corners, i, n);
        } else if (isAnsweredAbove(base, detail, level, corners.cells[i], n)) {
            answers.above += corners.weights[i];
        }
    }
    return answers;
}

} // namespace lightloom
