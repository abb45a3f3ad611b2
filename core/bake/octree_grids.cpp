// SPDX-License-Identifier: Apache-2.0
#include "core/bake/bake_grids.h"
#include "core/octree/octree_build.h"
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
std::string normalName(std::uint32_t e) { return fmt::format("geometry/normal/{}", e); }
std::string centroidName(std::uint32_t e) { return fmt::format("geometry/centroid/{}", e); }
std::string areaName(std::uint32_t e) { return fmt::format("geometry/area/{}", e); }
std::string sideName(std::uint32_t e) { return fmt::format("geometry/side/{}", e); }
std::string scalarName(const std::string& group, std::uint32_t e) { return fmt::format("{}/scalar/{}", group, e); }
std::string noiseName(const std::string& group, std::uint32_t e) { return fmt::format("{}/noise/{}", group, e); }
std::string vdlName(const std::string& group, const char* quantity, std::uint32_t e, std::size_t slot)
{
    return fmt::format("{}/{}/{}/{}", group, quantity, e, slot);
}

/// Leaves that have an entry number `e`, and where these entries stand among all: one grid's voxels.
struct Slot {
    std::vector<glm::ivec3> cells;
    std::vector<std::uint32_t> entries;
};

std::vector<Slot> slotsOf(const OctreeGeometry& geometry)
{
    std::vector<Slot> slots;
    for (std::size_t i = 0; i < geometry.cells.size(); ++i) {
        const std::uint32_t first = geometry.firstEntry[i], count = geometry.firstEntry[i + 1] - first;
        if (slots.size() < count) slots.resize(count);
        for (std::uint32_t e = 0; e < count; ++e) {
            slots[e].cells.emplace_back(mortonCell(geometry.cells[i]));
            slots[e].entries.push_back(first + e);
        }
    }
    return slots;
}

class Writer {
public:
    Writer(const OctreeGeometry& geometry, std::string prefix, const Scene& scene, VdbFile& file)
        : geometry_(geometry), prefix_(std::move(prefix)),
          file_(file), lattice_{scene.toFile(geometry.lowest), glm::dvec3(double(geometry.cellSize()))},
          slots_(slotsOf(geometry))
    {
    }

    void geometry()
    {
        for (std::uint32_t e = 0; e < slots_.size(); ++e) {
            grid(normalName(e), e, [&](std::uint32_t n) { return geometry_.entries[n].normal; });
            grid(centroidName(e), e, [&](std::uint32_t n) { return geometry_.entries[n].centroid; });
            grid(areaName(e), e, [&](std::uint32_t n) { return geometry_.entries[n].area; });
            const auto side = [&](std::uint32_t n) { return static_cast<float>(geometry_.entries[n].side); };
            if (std::ranges::any_of(slots_[e].entries, [&](std::uint32_t n) { return side(n) > 0.0f; }))
                grid(sideName(e), e, side);
        }
    }

    void layer(const VdlLayer& layer, const std::string& group)
    {
        const auto count = static_cast<std::size_t>(layer.count);
        for (std::uint32_t e = 0; e < slots_.size(); ++e) {
            grid(scalarName(group, e), e, [&](std::uint32_t n) { return layer.scalar[n]; });
            grid(noiseName(group, e), e, [&](std::uint32_t n) { return layer.noise[n]; });
            for (std::size_t j = 0; j < count; ++j) lights(layer, group, e, j);
        }
    }

private:
    /// Light number `j` of entries number `e` that have as many.
    void lights(const VdlLayer& layer, const std::string& group, std::uint32_t e, std::size_t j)
    {
        std::vector<glm::ivec3> cells;
        std::vector<glm::vec3> colours, directions;
        for (std::size_t i = 0; i < slots_[e].entries.size(); ++i) {
            const std::span<const Vdl> some = layer.of(slots_[e].entries[i]);
            if (j >= some.size()) continue;
            cells.push_back(slots_[e].cells[i]);
            colours.push_back(some[j].colour), directions.push_back(some[j].toLight);
        }
        if (cells.empty()) return;
        file_.add(prefix_ + vdlName(group, "colour", e, j), lattice_, cells, std::span(std::as_const(colours)));
        file_.add(prefix_ + vdlName(group, "direction", e, j), lattice_, cells, std::span(std::as_const(directions)));
    }

    template<class ValueOf>
    void grid(const std::string& name, std::uint32_t e, const ValueOf& valueOf)
    {
        std::vector<decltype(valueOf(0))> values;
        for (const std::uint32_t entry : slots_[e].entries) values.push_back(valueOf(entry));
        file_.add(prefix_ + name, lattice_, slots_[e].cells, std::span(std::as_const(values)));
    }

    const OctreeGeometry& geometry_;
    std::string prefix_;
    VdbFile& file_;
    VdbFile::Lattice lattice_;
    std::vector<Slot> slots_;
};

class Reader {
public:
    Reader(const VdbFile& file, int depth, std::string prefix)
        : file_(file), prefix_(std::move(prefix)), geometry_(std::make_shared<OctreeGeometry>())
    {
        geometry_->depth = depth;
        geometry_->lowest = file.vector("lightloom.lowest");
        geometry_->rootSize = file.number("lightloom.root_size");
        cells();
        entries();
    }

    [[nodiscard]] std::shared_ptr<const OctreeGeometry> geometry() const { return geometry_; }

    [[nodiscard]] std::shared_ptr<VdlLayer> layer(const std::string& group, int number, float tolerance) const
    {
        auto layer = std::make_shared<VdlLayer>();
        layer->group = number;
        layer->count = static_cast<int>(file_.integer("lightloom.vdls"));
        layer->tolerance = tolerance;
        layer->scalar.resize(geometry_->entries.size());
        layer->noise.resize(geometry_->entries.size());
        for (std::uint32_t e = 0; e < slots_.size(); ++e) {
            vectors(scalarName(group, e), e, [&](std::size_t n, glm::vec3 v) { layer->scalar[n] = v; });
            numbers(noiseName(group, e), e, [&](std::size_t n, float v) { layer->noise[n] = v; });
        }
        lights(*layer, group);
        return layer;
    }

private:
    void lights(VdlLayer& layer, const std::string& group) const
    {
        const auto count = static_cast<std::size_t>(layer.count);
        if (layer.tolerance > 0.0f) { // entries have as many as there are grids with a voxel of theirs
            std::vector<std::uint32_t> counts(geometry_->entries.size(), 0);
            forLights(group, count, [&](std::size_t n, std::size_t j) {
                if (counts[n]++ != j) throw std::runtime_error("an entry lacks a light before its last");
            });
            layer.first.push_back(0);
            for (const std::uint32_t some : counts) layer.first.push_back(layer.first.back() + some);
        }
        layer.vdls.resize(layer.first.empty() ? geometry_->entries.size() * count : layer.first.back());
        for (std::uint32_t e = 0; e < slots_.size(); ++e) {
            for (std::size_t j = 0; j < count; ++j) {
                std::vector<glm::ivec3> cells;
                std::vector<std::size_t> places;
                for (std::size_t i = 0; i < slots_[e].entries.size(); ++i) {
                    const std::size_t n = slots_[e].entries[i];
                    const bool has = layer.first.empty() || layer.first[n] + j < layer.first[n + 1];
                    if (!has) continue;
                    cells.push_back(slots_[e].cells[i]);
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
        for (std::uint32_t e = 0; e < slots_.size(); ++e) {
            for (std::size_t j = 0; j < count; ++j) {
                const std::string name = prefix_ + vdlName(group, "colour", e, j);
                if (!file_.contains(name)) break;
                for (const glm::ivec3 cell : file_.cells(name)) {
                    const std::int64_t leaf = geometry_->leafAt(cell);
                    if (leaf < 0) throw std::runtime_error("a light without a leaf");
                    const std::uint32_t first = geometry_->firstEntry[static_cast<std::size_t>(leaf)];
                    if (first + e >= geometry_->firstEntry[static_cast<std::size_t>(leaf) + 1])
                        throw std::runtime_error("a light without an entry");
                    use(first + e, j);
                }
            }
        }
    }

    void cells()
    {
        if (!file_.contains(prefix_ + normalName(0))) return; // a scene without any reached surface
        for (const glm::ivec3 cell : file_.cells(prefix_ + normalName(0))) {
            geometry_->cells.push_back(mortonCode(glm::uvec3(cell)));
        }
        std::ranges::sort(geometry_->cells);
    }

    void entries()
    {
        OctreeGeometry& g = *geometry_;
        std::vector<std::uint32_t> counts(g.cells.size(), 0); // entries of each leaf
        for (std::uint32_t e = 0; file_.contains(prefix_ + normalName(e)); ++e) {
            for (const glm::ivec3 cell : file_.cells(prefix_ + normalName(e))) {
                const std::int64_t leaf = g.leafAt(cell);
                if (leaf < 0 || counts[static_cast<std::size_t>(leaf)]++ != e) {
                    throw std::runtime_error("an entry without a leaf of its own");
                }
            }
        }
        g.firstEntry.push_back(0);
        for (const std::uint32_t count : counts) g.firstEntry.push_back(g.firstEntry.back() + count);
        g.entries.resize(g.firstEntry.back());
        slots_ = slotsOf(g);
        for (std::uint32_t e = 0; e < slots_.size(); ++e) {
            vectors(normalName(e), e, [&](std::size_t n, glm::vec3 v) { g.entries[n].normal = v; });
            vectors(centroidName(e), e, [&](std::size_t n, glm::vec3 v) { g.entries[n].centroid = v; });
            numbers(areaName(e), e, [&](std::size_t n, float v) { g.entries[n].area = v; });
            if (!file_.contains(prefix_ + sideName(e))) continue;
            numbers(sideName(e), e, [&](std::size_t n, float v) {
                if (!(v >= 0.0f && v < 65536.0f)) throw std::runtime_error("a side that is none");
                g.entries[n].side = static_cast<std::uint32_t>(v);
            });
        }
    }

    template<class Use>
    void vectors(const std::string& name, std::uint32_t e, const Use& use) const
    {
        each(file_.vectors(prefix_ + name, slots_[e].cells), e, use);
    }
    template<class Use>
    void numbers(const std::string& name, std::uint32_t e, const Use& use) const
    {
        each(file_.numbers(prefix_ + name, slots_[e].cells), e, use);
    }
    template<class Values, class Use>
    void each(const Values& values, std::uint32_t e, const Use& use) const
    {
        for (std::size_t i = 0; i < values.size(); ++i) use(slots_[e].entries[i], values[i]);
    }

    const VdbFile& file_;
    std::string prefix_;
    std::shared_ptr<OctreeGeometry> geometry_;
    std::vector<Slot> slots_;
};

} // namespace

void storeOctree(const LightOctree& octree, const Scene& scene, VdbFile& file)
{
    const OctreeGeometry& geometry = octree.geometry();
    int vdls = 1;
    for (const auto& layer : octree.layers()) vdls = layer ? layer->count : vdls;
    file.set("lightloom.depth", std::int64_t(geometry.depth));
    file.set("lightloom.vdls", std::int64_t(vdls));
    file.set("lightloom.lowest", geometry.lowest);
    file.set("lightloom.root_size", geometry.rootSize);
    Writer writer(geometry, prefixOf(geometry.depth), scene, file);
    writer.geometry();
    for (std::size_t g = 0; g < octree.layers().size(); ++g) {
        if (!octree.layers()[g]) continue;
        const VdlLayer& layer = *octree.layers()[g];
        const std::string group = escaped(scene.groups[static_cast<std::size_t>(layer.group)].id);
        writer.layer(layer, group);
        for (const DetailLevel& level : octree.detail(g)) {
            Writer deeper(*level.geometry, prefixOf(level.geometry->depth, group), scene, file);
            deeper.geometry();
            deeper.layer(*level.layer, kDeeper);
        }
    }
}

namespace {

constexpr int kMostDeeper = 3; ///< levels, as octree.detail allows

std::shared_ptr<const LampDetail> readDetail(const VdbFile& file, int depth, const std::string& group, int number,
                                             float tolerance)
{
    auto detail = std::make_shared<LampDetail>();
    for (int d = depth + 1; file.contains(prefixOf(d, group) + normalName(0)); ++d) {
        if (d > depth + kMostDeeper) throw std::runtime_error("leaves that are split too often");
        const Reader reader(file, d, prefixOf(d, group));
        detail->push_back({reader.geometry(), reader.layer(kDeeper, number, tolerance)});
    }
    return detail;
}

void checkLeaves(const OctreeGeometry& geometry)
{
    for (std::size_t i = 0; i < geometry.cells.size(); ++i) {
        if (geometry.firstEntry[i + 1] - geometry.firstEntry[i] > kMostEntries)
            throw std::runtime_error("a leaf with more orientations than there can be");
    }
}

/// A file's seal tells damage, not intent: what the union of all lamps' leaves takes for granted is checked here.
void checkTogether(const OctreeGeometry& base, const std::vector<std::shared_ptr<const LampDetail>>& details)
{
    checkLeaves(base);
    std::array<std::unordered_map<std::uint64_t, std::uint32_t>, kMostDeeper> entries; // of each cell, by level
    for (const auto& detail : details) {
        const OctreeGeometry* above = &base;
        for (std::size_t level = 0; detail && level < detail->size(); ++level) {
            const OctreeGeometry& g = *(*detail)[level].geometry;
            checkLeaves(g);
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
