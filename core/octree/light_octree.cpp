// SPDX-License-Identifier: Apache-2.0
#include "core/octree/light_octree.h"
#include "core/base/units.h"
#include "core/field/solver.h"
#include "core/octree/vdl_cluster.h"
#include "core/trace/cell_clip.h"
#include <algorithm>
#include <cmath>

namespace lightloom {

std::int64_t OctreeGeometry::leafAt(glm::ivec3 cell) const
{
    const int side = 1 << depth;
    const bool inside = cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < side && cell.y < side && cell.z < side;
    if (!inside) return -1;
    const std::uint64_t code = mortonCode(glm::uvec3(cell));
    const auto at = std::ranges::lower_bound(cells, code);
    return at != cells.end() && *at == code ? at - cells.begin() : -1;
}

LightOctree::LightOctree(std::shared_ptr<const OctreeGeometry> geometry,
                         std::vector<std::shared_ptr<const VdlLayer>> layers, VdlForm form, Mix mix, OctreeShow show)
    : geometry_(std::move(geometry)), layers_(std::move(layers)), form_(form), mix_(std::move(mix)), show_(show)
{
}

namespace {

/// Entry of a leaf whose normal is nearest `n`, or -1 where none is compatible.
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

/// Visits the compatible entries around `p` with their trilinear weights. Gives the sum of the weights, 0 if there are
/// none.
template<class Visit>
float visitNeighbours(const OctreeGeometry& geometry, glm::vec3 p, glm::vec3 n, const Visit& visit)
{
    const glm::vec3 at = (p - geometry.lowest) / geometry.cellSize() - 0.5f;
    const glm::vec3 base = glm::floor(at), part = at - base;
    // far outside the lattice (or NaN) no neighbour exists, and a cast to int would overflow
    if (!(glm::length(base) < 4e6f)) return 0.0f;
    const glm::ivec3 cell(base);
    float weights = 0.0f;
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 step(i & 1, i >> 1 & 1, i >> 2 & 1);
        const float weight =
            (step.x ? part.x : 1.0f - part.x) * (step.y ? part.y : 1.0f - part.y) * (step.z ? part.z : 1.0f - part.z);
        if (!(weight > 0.0f)) continue;
        const std::int64_t leaf = geometry.leafAt(cell + step);
        if (leaf < 0) continue;
        const std::int64_t entry = entryFor(geometry, leaf, n);
        if (entry < 0) continue;
        weights += weight;
        visit(static_cast<std::size_t>(entry), weight);
    }
    return weights;
}

} // namespace

bool LightOctree::lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const
{
    glm::vec3 sum(0.0f);
    const float weights = visitNeighbours(*geometry_, p, n, [&](std::size_t entry, float weight) {
        sum += weight * (show_ == OctreeShow::lights ? illuminanceOf(entry, n) : mixedColour(entry));
    });
    lux = weights > 0.0f ? sum / weights : glm::vec3(0.0f);
    return weights > 0.0f;
}

glm::vec3 LightOctree::illuminanceOf(std::size_t entry, glm::vec3 n) const
{
    glm::vec3 sum(0.0f);
    for (const auto& layer : layers_) {
        if (!layer) continue;
        const Vdl* vdls = layer->vdls.data() + entry * static_cast<std::size_t>(layer->count);
        glm::vec3 e(0.0f);
        for (int j = 0; j < layer->count; ++j) e += vdls[j].colour * glm::max(0.0f, glm::dot(n, vdls[j].toLight));
        sum += gainOf(mix_, layer->group) * e;
    }
    return sum;
}

glm::vec3 LightOctree::mixedColour(std::size_t e) const
{
    glm::vec3 sum(0.0f);
    for (const auto& layer : layers_) {
        if (layer) sum += gainOf(mix_, layer->group) * layer->scalar[e];
    }
    return sum;
}

std::optional<float> LightOctree::noise(glm::vec3 p, glm::vec3 n) const
{
    float sum = 0.0f;
    const float weights =
        visitNeighbours(*geometry_, p, n, [&](std::size_t entry, float weight) { sum += weight * noiseOf(entry); });
    if (!(weights > 0.0f)) return {};
    return sum / weights;
}

float LightOctree::noiseOf(std::size_t entry) const
{
    float variance = 0.0f;
    for (const auto& layer : layers_) {
        if (!layer) continue;
        const glm::vec3 scalar = layer->scalar[entry];
        const float baked = luminance(scalar);
        const glm::vec3 gain = gainOf(mix_, layer->group); // moves light and noise alike
        const float share = baked > 0.0f ? luminance(gain * scalar) / baked : luminance(gain);
        const float noise = layer->noise[entry] * share;
        variance += noise * noise;
    }
    return std::sqrt(variance);
}

std::shared_ptr<const IndirectField> LightOctree::withMix(Mix mix) const
{
    return std::make_shared<LightOctree>(geometry_, layers_, form_, std::move(mix), show_);
}

std::shared_ptr<const LightOctree> LightOctree::showing(OctreeShow show) const
{
    return std::make_shared<LightOctree>(geometry_, layers_, form_, mix_, show);
}

std::size_t LightOctree::memoryBytes() const
{
    std::size_t sum = geometry_->cells.size() * (sizeof(std::uint64_t) + sizeof(std::uint32_t)) +
                      geometry_->entries.size() * sizeof(OctreeEntry);
    for (const auto& layer : layers_) {
        if (layer) sum += layer->vdls.size() * sizeof(Vdl) + layer->scalar.size() * (sizeof(glm::vec3) + sizeof(float));
    }
    return sum;
}

std::vector<Vdl> LightOctree::mixed(std::uint32_t e, int most) const
{
    std::vector<LightVector> lights;
    for (const auto& layer : layers_) {
        if (!layer) continue;
        const glm::vec3 gain = gainOf(mix_, layer->group);
        for (int j = 0; j < layer->count; ++j) {
            const Vdl& vdl =
                layer->vdls[std::size_t(e) * static_cast<std::size_t>(layer->count) + static_cast<std::size_t>(j)];
            const glm::vec3 colour = gain * vdl.colour;
            const float luma = luminance(colour);
            if (luma > 0.0f) lights.push_back({vdl.toLight, colour, luma});
        }
    }
    std::vector<Vdl> out(static_cast<std::size_t>(most));
    if (lights.size() <= out.size()) { // nothing to merge: as they are
        for (std::size_t i = 0; i < lights.size(); ++i) out[i] = {lights[i].colour, lights[i].toLight};
        return out;
    }
    ClusterScratch scratch;
    const glm::vec3 n = geometry_->entries[e].normal;
    fitVdls(lights, n, form_, out, scratch);
    if (form_ == VdlForm::corrected) { // lights from behind the entry's plane take nothing away from it
        glm::vec3 lux(0.0f);
        for (const LightVector& light : lights) lux += light.colour * glm::max(0.0f, glm::dot(light.toLight, n));
        scaleTo(lux, n, out);
    }
    return out;
}

OctreeGeometry leavesRead(const OctreeGeometry& geometry, std::span<const ProbePoint> points)
{
    std::vector<std::size_t> leaves;
    for (const ProbePoint& point : points) {
        static_cast<void>(visitNeighbours(geometry, point.position, point.normal, [&](std::size_t entry, float) {
            const auto next = std::ranges::upper_bound(geometry.firstEntry, entry);
            leaves.push_back(static_cast<std::size_t>(next - geometry.firstEntry.begin()) - 1);
        }));
    }
    std::ranges::sort(leaves);
    const auto doubled = std::ranges::unique(leaves);
    leaves.erase(doubled.begin(), doubled.end());
    OctreeGeometry part{geometry.depth, geometry.lowest, geometry.rootSize, {}, {}, {}};
    for (const std::size_t leaf : leaves) {
        part.cells.push_back(geometry.cells[leaf]);
        part.firstEntry.push_back(static_cast<std::uint32_t>(part.entries.size()));
        for (std::uint32_t e = geometry.firstEntry[leaf]; e < geometry.firstEntry[leaf + 1]; ++e)
            part.entries.push_back(geometry.entries[e]);
    }
    part.firstEntry.push_back(static_cast<std::uint32_t>(part.entries.size()));
    return part;
}

} // namespace lightloom
