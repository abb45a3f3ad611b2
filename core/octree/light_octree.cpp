// SPDX-License-Identifier: Apache-2.0
#include "core/octree/light_octree.h"
#include "core/base/units.h"
#include "core/field/solver.h"
#include "core/octree/detail_union.h"
#include "core/octree/octree_blend.h"
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

bool OctreeGeometry::splits(glm::ivec3 parent) const
{
    const int side = 1 << (depth - 1);
    if (glm::any(glm::lessThan(parent, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(parent, glm::ivec3(side))))
        return false;
    const std::uint64_t code = mortonCode(glm::uvec3(parent));
    const auto at = std::ranges::lower_bound(cells, code << 3);
    return at != cells.end() && *at >> 3 == code;
}

LightOctree::LightOctree(std::shared_ptr<const OctreeGeometry> geometry,
                         std::vector<std::shared_ptr<const VdlLayer>> layers, VdlForm form, Mix mix, OctreeShow show,
                         std::vector<std::shared_ptr<const LampDetail>> details)
    : geometry_(std::move(geometry)), layers_(std::move(layers)), form_(form), mix_(std::move(mix)), show_(show),
      details_(std::move(details)),
      deeper_(std::make_shared<const std::vector<UnionLevel>>(uniteDetails(*geometry_, details_)))
{
}

LightOctree::LightOctree(const LightOctree& other, Mix mix, OctreeShow show)
    : geometry_(other.geometry_), layers_(other.layers_), form_(other.form_), mix_(std::move(mix)), show_(show),
      details_(other.details_), deeper_(other.deeper_)
{
}

const LampDetail& LightOctree::detail(std::size_t layer) const
{
    static const LampDetail none;
    return layer < details_.size() && details_[layer] ? *details_[layer] : none;
}

template<class ValueOf>
auto LightOctree::blended(std::size_t g, glm::vec3 p, glm::vec3 n, const Answers& coarse, const ValueOf& valueOf) const
{
    const VdlLayer& layer = *layers_[g];
    const auto own = coarse.mean([&](std::size_t entry) { return valueOf(layer, entry); }) / coarse.sum;
    return refined(own, *geometry_, detail(g), p, n, valueOf);
}

bool LightOctree::lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const
{
    lux = glm::vec3(0.0f);
    const Answers coarse = answersAround(*geometry_, p, n);
    if (!(coarse.sum > 0.0f)) return false;
    const auto value = [&](const VdlLayer& layer, std::size_t entry) { return valueOf(layer, entry, n); };
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        if (layers_[g]) lux += gainOf(mix_, layers_[g]->group) * blended(g, p, n, coarse, value);
    }
    return true;
}

glm::vec3 LightOctree::valueOf(const VdlLayer& layer, std::size_t entry, glm::vec3 n) const
{
    if (show_ == OctreeShow::colour) return layer.scalar[entry];
    glm::vec3 lux = layer.flat > 0.0f ? layer.flat * layer.scalar[entry] : glm::vec3(0.0f);
    for (const Vdl& vdl : layer.of(entry)) lux += vdl.colour * glm::max(0.0f, glm::dot(n, vdl.toLight));
    return lux;
}

float LightOctree::flatShare() const
{
    const auto layer = std::ranges::find_if(layers_, [](const auto& l) { return l != nullptr; });
    return show_ == OctreeShow::lights && layer != layers_.end() ? (*layer)->flat : 0.0f;
}

const OctreeEntry& LightOctree::surface(At at) const
{
    return at.level == 0 ? geometry_->entries[at.entry] : (*deeper_)[at.level - 1].geometry.entries[at.entry];
}

std::int64_t LightOctree::ownEntry(std::size_t g, At at) const
{
    if (at.level == 0) return static_cast<std::int64_t>(at.entry);
    const std::vector<std::int32_t>& own = (*deeper_)[at.level - 1].own[g];
    return own.empty() ? -1 : own[at.entry];
}

glm::vec3 LightOctree::mixedColour(At at) const
{
    glm::vec3 sum(0.0f);
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        if (!layers_[g]) continue;
        const glm::vec3 gain = gainOf(mix_, layers_[g]->group);
        if (const std::int64_t own = ownEntry(g, at); own >= 0) {
            const VdlLayer& layer = at.level == 0 ? *layers_[g] : *detail(g)[at.level - 1].layer;
            sum += gain * layer.scalar[static_cast<std::size_t>(own)];
        } else {
            const OctreeEntry& e = surface(at);
            const auto scalar = [](const VdlLayer& layer, std::size_t entry) { return layer.scalar[entry]; };
            const Answers coarse = answersAround(*geometry_, e.centroid, e.normal);
            if (coarse.sum > 0.0f) sum += gain * blended(g, e.centroid, e.normal, coarse, scalar);
        }
    }
    return sum;
}

/// Lights of one layer at its own intensity. Of a lamp that has no leaf there: those of its leaf that covers the place,
/// scaled to what it gives there.
std::vector<Vdl> LightOctree::lightsOf(std::size_t g, At at) const
{
    const auto copy = [](std::span<const Vdl> lights) { return std::vector<Vdl>(lights.begin(), lights.end()); };
    if (const std::int64_t own = ownEntry(g, at); own >= 0) {
        const VdlLayer& layer = at.level == 0 ? *layers_[g] : *detail(g)[at.level - 1].layer;
        return copy(layer.of(static_cast<std::size_t>(own)));
    }
    const OctreeEntry& e = surface(at);
    const Answers coarse = answersAround(*geometry_, e.centroid, e.normal);
    if (!(coarse.sum > 0.0f)) return {};
    const auto nearest = std::ranges::max_element(coarse.weights.begin(), coarse.weights.begin() + coarse.count);
    std::vector<Vdl> lights =
        copy(layers_[g]->of(coarse.entries[static_cast<std::size_t>(nearest - coarse.weights.begin())]));
    const auto value = [&](const VdlLayer& layer, std::size_t entry) {
        glm::vec3 lux(0.0f);
        for (const Vdl& vdl : layer.of(entry)) lux += vdl.colour * glm::max(0.0f, glm::dot(e.normal, vdl.toLight));
        return lux;
    };
    scaleTo(blended(g, e.centroid, e.normal, coarse, value), e.normal, lights);
    return lights;
}

namespace {

/// Standard error of an entry's luminance under a gain, which moves light and noise alike.
float noiseOf(const VdlLayer& layer, std::size_t entry, glm::vec3 gain)
{
    const glm::vec3 scalar = layer.scalar[entry];
    const float baked = luminance(scalar);
    return layer.noise[entry] * (baked > 0.0f ? luminance(gain * scalar) / baked : luminance(gain));
}

} // namespace

std::optional<float> LightOctree::noise(glm::vec3 p, glm::vec3 n) const
{
    const Answers coarse = answersAround(*geometry_, p, n);
    if (!(coarse.sum > 0.0f)) return {};
    float variance = 0.0f;
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        if (!layers_[g]) continue;
        const glm::vec3 gain = gainOf(mix_, layers_[g]->group);
        const float noise = blended(
            g, p, n, coarse, [&](const VdlLayer& layer, std::size_t entry) { return noiseOf(layer, entry, gain); });
        variance += noise * noise;
    }
    return std::sqrt(variance);
}

std::shared_ptr<const IndirectField> LightOctree::withMix(Mix mix) const
{
    return std::shared_ptr<const IndirectField>(new LightOctree(*this, std::move(mix), show_));
}

std::shared_ptr<const LightOctree> LightOctree::showing(OctreeShow show) const
{
    return std::shared_ptr<const LightOctree>(new LightOctree(*this, mix_, show));
}

std::shared_ptr<const LightOctree> LightOctree::withDetail(std::size_t levels) const
{
    std::vector<std::shared_ptr<const LampDetail>> kept;
    for (const auto& detail : details_) {
        if (detail && detail->size() > levels)
            kept.push_back(std::make_shared<LampDetail>(detail->begin(), detail->begin() + std::ptrdiff_t(levels)));
        else
            kept.push_back(detail);
    }
    return std::make_shared<LightOctree>(geometry_, layers_, form_, mix_, show_, std::move(kept));
}

namespace {

std::size_t bytesOf(const OctreeGeometry& geometry)
{
    return geometry.cells.size() * (sizeof(std::uint64_t) + sizeof(std::uint32_t)) +
           geometry.entries.size() * sizeof(OctreeEntry);
}

std::size_t bytesOf(const VdlLayer& layer)
{
    return layer.vdls.size() * sizeof(Vdl) + layer.first.size() * sizeof(std::uint32_t) +
           layer.scalar.size() * (sizeof(glm::vec3) + sizeof(float));
}

} // namespace

std::size_t LightOctree::memoryBytes() const
{
    std::size_t sum = bytesOf(*geometry_);
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        if (layers_[g]) sum += bytesOf(*layers_[g]);
        for (const DetailLevel& level : detail(g)) sum += bytesOf(*level.geometry) + bytesOf(*level.layer);
    }
    return sum;
}

std::vector<Vdl> LightOctree::mixed(At at, int most) const
{
    std::vector<LightVector> lights;
    lights.reserve(layers_.size() * static_cast<std::size_t>(most));
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        if (!layers_[g]) continue;
        const glm::vec3 gain = gainOf(mix_, layers_[g]->group);
        for (const Vdl& vdl : lightsOf(g, at)) {
            const glm::vec3 colour = gain * vdl.colour;
            const float luma = luminance(colour);
            if (luma > 0.0f) lights.push_back({vdl.toLight, colour, luma});
        }
    }
    float tolerance = 0.0f;
    for (const auto& layer : layers_) tolerance = layer ? glm::max(tolerance, layer->tolerance) : tolerance;
    const bool isAdaptive = tolerance > 0.0f;
    const auto few = static_cast<std::size_t>(most);
    std::vector<Vdl> out(few);
    if (lights.size() <= few) { // nothing to merge: as they are
        for (std::size_t i = 0; i < lights.size(); ++i) out[i] = {lights[i].colour, lights[i].toLight};
        if (isAdaptive) out.resize(lights.size());
        return out;
    }
    ClusterScratch scratch;
    const glm::vec3 n = surface(at).normal;
    fitVdls(lights, n, form_, out, scratch);
    if (form_ == VdlForm::corrected) { // lights from behind the entry's plane take nothing away from it
        glm::vec3 lux(0.0f);
        for (const LightVector& light : lights) lux += light.colour * glm::max(0.0f, glm::dot(light.toLight, n));
        scaleTo(lux, n, out);
    }
    if (isAdaptive) out.resize(spendVdls(out, n, form_, tolerance, scratch));
    return out;
}

void OctreeGeometry::take(const OctreeGeometry& from, std::size_t entry)
{
    entries.push_back(from.entries[entry]);
    if (from.firstScreen.empty()) return;
    if (firstScreen.empty()) firstScreen.push_back(0);
    const Screens some = from.screensOf(entry);
    screens.insert(screens.end(), some.begin(), some.end());
    firstScreen.push_back(static_cast<std::uint32_t>(screens.size()));
}

OctreeGeometry leavesRead(const OctreeGeometry& geometry, std::span<const ProbePoint> points)
{
    std::vector<std::size_t> leaves;
    for (const ProbePoint& point : points) {
        const Answers answers = answersAround(geometry, point.position, point.normal);
        for (std::size_t i = 0; i < static_cast<std::size_t>(answers.count); ++i) {
            const auto next = std::ranges::upper_bound(geometry.firstEntry, answers.entries[i]);
            leaves.push_back(static_cast<std::size_t>(next - geometry.firstEntry.begin()) - 1);
        }
    }
    std::ranges::sort(leaves);
    const auto doubled = std::ranges::unique(leaves);
    leaves.erase(doubled.begin(), doubled.end());
    OctreeGeometry part{geometry.depth, geometry.lowest, geometry.rootSize, {}, {}, {}, {}, {}};
    for (const std::size_t leaf : leaves) {
        part.cells.push_back(geometry.cells[leaf]);
        part.firstEntry.push_back(static_cast<std::uint32_t>(part.entries.size()));
        for (std::uint32_t e = geometry.firstEntry[leaf]; e < geometry.firstEntry[leaf + 1]; ++e)
            part.take(geometry, e);
    }
    part.firstEntry.push_back(static_cast<std::uint32_t>(part.entries.size()));
    return part;
}

} // namespace lightloom
