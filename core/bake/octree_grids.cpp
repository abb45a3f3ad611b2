// SPDX-License-Identifier: Apache-2.0
#include "core/bake/bake_grids.h"
#include "core/bake/leaf_grids.h"
#include "core/trace/cell_clip.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <unordered_map>

namespace lightloom {
namespace {

std::string prefixOf(int depth) { return fmt::format("light-octree/d{}/", depth); }
constexpr const char* kDeeper = "light"; ///< in place of the group, which stands in the prefix
/// Of a light group's deeper leaves.
std::string prefixOf(int depth, const std::string& group) { return fmt::format("light-octree/d{}/{}/", depth, group); }
std::string vdlName(const std::string& group, const char* quantity, std::size_t e, std::size_t slot)
{
    return fmt::format("{}/{}/{}/{}", group, quantity, e, slot);
}

/// Light number `j` of entries number `e` that have as many.
void storeLights(const VdlLayer& layer, const std::string& group, std::size_t e, std::size_t j, LeafWriter& leaves)
{
    const LeafSlot& slot = leaves.slots()[e];
    std::vector<glm::ivec3> cells;
    std::vector<glm::vec3> colours, directions;
    for (std::size_t i = 0; i < slot.entries.size(); ++i) {
        const std::span<const Vdl> some = layer.of(slot.entries[i]);
        if (j >= some.size()) continue;
        cells.push_back(slot.cells[i]);
        colours.push_back(some[j].colour), directions.push_back(some[j].toLight);
    }
    leaves.add(vdlName(group, "colour", e, j), cells, colours);
    leaves.add(vdlName(group, "direction", e, j), cells, directions);
}

void storeLayer(const VdlLayer& layer, const std::string& group, LeafWriter& leaves)
{
    leaves.values(group + "/scalar", [&](std::uint32_t n) { return layer.scalar[n]; });
    leaves.values(group + "/noise", [&](std::uint32_t n) { return layer.noise[n]; });
    for (std::size_t e = 0; e < leaves.slots().size(); ++e)
        for (std::size_t j = 0; j < static_cast<std::size_t>(layer.count); ++j) storeLights(layer, group, e, j, leaves);
}

/// Reads layers of light over the leaves of one level.
class Reader {
public:
    Reader(const VdbFile& file, int depth, std::string prefix)
        : file_(file), prefix_(std::move(prefix)), leaves_(file, depth, prefix_)
    {
    }

    [[nodiscard]] std::shared_ptr<const OctreeGeometry> geometry() const { return leaves_.geometry(); }

    [[nodiscard]] std::shared_ptr<VdlLayer> layer(const std::string& group, int number, float tolerance) const
    {
        auto layer = std::make_shared<VdlLayer>();
        layer->group = number;
        layer->count = static_cast<int>(file_.integer("lightloom.vdls"));
        layer->tolerance = tolerance;
        layer->scalar.resize(geometry()->entries.size());
        layer->noise.resize(geometry()->entries.size());
        leaves_.vectors(group + "/scalar", [&](std::size_t n, glm::vec3 v) { layer->scalar[n] = v; });
        leaves_.numbers(group + "/noise", [&](std::size_t n, float v) { layer->noise[n] = v; });
        lights(*layer, group);
        return layer;
    }

private:
    void lights(VdlLayer& layer, const std::string& group) const
    {
        const auto count = static_cast<std::size_t>(layer.count);
        if (layer.tolerance > 0.0f) { // entries have as many as there are grids with a voxel of theirs
            std::vector<std::uint32_t> counts(geometry()->entries.size(), 0);
            forLights(group, count, [&](std::size_t n, std::size_t j) {
                if (counts[n]++ != j) throw std::runtime_error("an entry lacks a light before its last");
            });
            layer.first.push_back(0);
            for (const std::uint32_t some : counts) layer.first.push_back(layer.first.back() + some);
        }
        layer.vdls.resize(layer.first.empty() ? geometry()->entries.size() * count : layer.first.back());
        for (std::size_t e = 0; e < leaves_.slots().size(); ++e) {
            const LeafSlot& slot = leaves_.slots()[e];
            for (std::size_t j = 0; j < count; ++j) {
                std::vector<glm::ivec3> cells;
                std::vector<std::size_t> places;
                for (std::size_t i = 0; i < slot.entries.size(); ++i) {
                    const std::size_t n = slot.entries[i];
                    const bool has = layer.first.empty() || layer.first[n] + j < layer.first[n + 1];
                    if (!has) continue;
                    cells.push_back(slot.cells[i]);
                    places.push_back(layer.first.empty() ? n * count + j : layer.first[n] + j);
                }
                if (cells.empty()) continue;
                const auto colours = file_.vectors(prefix_ + vdlName(group, "colour", e, j), cells);
                const auto directions = file_.vectors(prefix_ + vdlName(group, "direction", e, j), cells);
                for (std::size_t i = 0; i < places.size(); ++i) layer.vdls[places[i]] = {colours[i], directions[i]};
            }
        }
    }

    template<class Use>
    void forLights(const std::string& group, std::size_t count, const Use& use) const
    {
        const OctreeGeometry& leaves = *geometry();
        for (std::uint32_t e = 0; e < leaves_.slots().size(); ++e) {
            for (std::size_t j = 0; j < count; ++j) {
                const std::string name = prefix_ + vdlName(group, "colour", e, j);
                if (!file_.contains(name)) break;
                for (const glm::ivec3 cell : file_.cells(name)) {
                    const std::int64_t leaf = leaves.leafAt(cell);
                    if (leaf < 0) throw std::runtime_error("a light without a leaf");
                    const std::uint32_t first = leaves.firstEntry[static_cast<std::size_t>(leaf)];
                    if (first + e >= leaves.firstEntry[static_cast<std::size_t>(leaf) + 1])
                        throw std::runtime_error("a light without an entry");
                    use(first + e, j);
                }
            }
        }
    }

    const VdbFile& file_;
    std::string prefix_;
    LeafReader leaves_;
};

} // namespace

void storeOctree(const LightOctree& octree, const Scene& scene, VdbFile& file)
{
    const OctreeGeometry& geometry = octree.geometry();
    int vdls = 1;
    for (const auto& layer : octree.layers()) vdls = layer ? layer->count : vdls;
    file.set("lightloom.depth", std::int64_t(geometry.depth));
    file.set("lightloom.vdls", std::int64_t(vdls));
    storeRoot(geometry, file);
    LeafWriter writer(geometry, prefixOf(geometry.depth), scene, file);
    writer.geometry();
    for (std::size_t g = 0; g < octree.layers().size(); ++g) {
        if (!octree.layers()[g]) continue;
        const VdlLayer& layer = *octree.layers()[g];
        const std::string group = escaped(scene.groups[static_cast<std::size_t>(layer.group)].id);
        storeLayer(layer, group, writer);
        for (const DetailLevel& level : octree.detail(g)) {
            LeafWriter deeper(*level.geometry, prefixOf(level.geometry->depth, group), scene, file);
            deeper.geometry();
            storeLayer(*level.layer, kDeeper, deeper);
        }
    }
}

namespace {

constexpr int kMostDeeper = 3; ///< levels, as octree.detail allows

std::shared_ptr<const LampDetail> readDetail(const VdbFile& file, int depth, const std::string& group, int number,
                                             float tolerance)
{
    auto detail = std::make_shared<LampDetail>();
    for (int d = depth + 1; LeafReader::isThere(file, prefixOf(d, group)); ++d) {
        if (d > depth + kMostDeeper) throw std::runtime_error("leaves that are split too often");
        const Reader reader(file, d, prefixOf(d, group));
        detail->push_back({reader.geometry(), reader.layer(kDeeper, number, tolerance)});
    }
    return detail;
}

/// A file's seal tells damage, not intent: what the union of all lamps' leaves takes for granted is checked here.
void checkTogether(const OctreeGeometry& base, const std::vector<std::shared_ptr<const LampDetail>>& details)
{
    std::array<std::unordered_map<std::uint64_t, std::uint32_t>, kMostDeeper> entries; // of each cell, by level
    for (const auto& detail : details) {
        const OctreeGeometry* above = &base;
        for (std::size_t level = 0; detail && level < detail->size(); ++level) {
            const OctreeGeometry& g = *(*detail)[level].geometry;
            for (std::size_t i = 0; i < g.cells.size(); ++i) {
                if (!std::ranges::binary_search(above->cells, g.cells[i] >> 3))
                    throw std::runtime_error("a deeper leaf below none");
                const std::uint32_t count = g.firstEntry[i + 1] - g.firstEntry[i];
                if (entries[level].try_emplace(g.cells[i], count).first->second != count)
                    throw std::runtime_error("lamps that disagree about a leaf");
            }
            above = &g;
        }
    }
}

} // namespace

std::shared_ptr<const LightOctree> readOctree(const VdbFile& file, const Scene& scene, const std::vector<bool>& isOn,
                                              const BakeParams& params)
{
    const int depth = static_cast<int>(file.integer("lightloom.depth"));
    const Reader reader(file, depth, prefixOf(depth));
    std::vector<std::shared_ptr<const VdlLayer>> layers;
    std::vector<std::shared_ptr<const LampDetail>> details;
    for (std::size_t g = 0; g < isOn.size(); ++g) {
        const std::string group = escaped(scene.groups[g].id);
        const int number = static_cast<int>(g);
        layers.push_back(isOn[g] ? reader.layer(group, number, params.vdlTolerance) : nullptr);
        details.push_back(isOn[g] ? readDetail(file, depth, group, number, params.vdlTolerance) : nullptr);
    }
    checkTogether(*reader.geometry(), details);
    return std::make_shared<LightOctree>(reader.geometry(), std::move(layers), params.vdlForm, Mix{},
                                         OctreeShow::lights, std::move(details));
}

} // namespace lightloom
