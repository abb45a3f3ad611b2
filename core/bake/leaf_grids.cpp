// SPDX-License-Identifier: Apache-2.0
#include "core/bake/leaf_grids.h"
#include "core/octree/octree_build.h"
#include "core/trace/cell_clip.h"
#include <algorithm>
#include <stdexcept>

namespace lightloom {
namespace {

constexpr const char *kNormal = "geometry/normal", *kCentroid = "geometry/centroid", *kArea = "geometry/area",
                     *kSide = "geometry/side";
constexpr const char *kLowest = "lightloom.lowest", *kRootSize = "lightloom.root_size";

} // namespace

std::vector<LeafSlot> leafSlots(const OctreeGeometry& geometry)
{
    std::vector<LeafSlot> slots;
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

LeafWriter::LeafWriter(const OctreeGeometry& geometry, std::string prefix, const Scene& scene, VdbFile& file)
    : geometry_(geometry), prefix_(std::move(prefix)),
      file_(file), lattice_{scene.toFile(geometry.lowest), glm::dvec3(double(geometry.cellSize()))},
      slots_(leafSlots(geometry))
{
}

void LeafWriter::geometry()
{
    values(kNormal, [&](std::uint32_t n) { return geometry_.entries[n].normal; });
    values(kCentroid, [&](std::uint32_t n) { return geometry_.entries[n].centroid; });
    values(kArea, [&](std::uint32_t n) { return geometry_.entries[n].area; });
    for (std::size_t e = 0; e < slots_.size(); ++e) {
        std::vector<float> sides;
        for (const std::uint32_t n : slots_[e].entries) sides.push_back(static_cast<float>(geometry_.entries[n].side));
        if (std::ranges::any_of(sides, [](float side) { return side > 0.0f; }))
            add(std::string(kSide) + "/" + std::to_string(e), slots_[e].cells, sides);
    }
}

LeafReader::LeafReader(const VdbFile& file, int depth, std::string prefix)
    : file_(file), prefix_(std::move(prefix)), geometry_(std::make_shared<OctreeGeometry>())
{
    geometry_->depth = depth;
    geometry_->lowest = file.vector(kLowest);
    geometry_->rootSize = file.number(kRootSize);
    readCells();
    readEntries();
}

bool LeafReader::isThere(const VdbFile& file, const std::string& prefix)
{
    return file.contains(prefix + kNormal + "/0");
}

void LeafReader::readCells()
{
    if (!isThere(file_, prefix_)) return; // a scene without any reached surface
    for (const glm::ivec3 cell : file_.cells(nameOf(kNormal, 0)))
        geometry_->cells.push_back(mortonCode(glm::uvec3(cell)));
    std::ranges::sort(geometry_->cells);
}

void LeafReader::readEntries()
{
    OctreeGeometry& g = *geometry_;
    std::vector<std::uint32_t> counts(g.cells.size(), 0); // entries of each leaf
    for (std::uint32_t e = 0; file_.contains(nameOf(kNormal, e)); ++e) {
        for (const glm::ivec3 cell : file_.cells(nameOf(kNormal, e))) {
            const std::int64_t leaf = g.leafAt(cell);
            if (leaf < 0 || counts[static_cast<std::size_t>(leaf)]++ != e)
                throw std::runtime_error("an entry without a leaf of its own");
        }
    }
    g.firstEntry.push_back(0);
    for (const std::uint32_t count : counts) {
        if (count > kMostEntries) throw std::runtime_error("a leaf with more orientations than there can be");
        g.firstEntry.push_back(g.firstEntry.back() + count);
    }
    g.entries.resize(g.firstEntry.back());
    slots_ = leafSlots(g);
    vectors(kNormal, [&](std::size_t n, glm::vec3 v) { g.entries[n].normal = v; });
    vectors(kCentroid, [&](std::size_t n, glm::vec3 v) { g.entries[n].centroid = v; });
    numbers(kArea, [&](std::size_t n, float v) { g.entries[n].area = v; });
    for (std::size_t e = 0; e < slots_.size(); ++e) readSides(e);
}

void LeafReader::readSides(std::size_t e)
{
    if (!file_.contains(nameOf(kSide, e))) return;
    numbersOf(kSide, e, [&](std::size_t n, float v) {
        if (!(v >= 0.0f && v < 65536.0f)) throw std::runtime_error("a side that is none");
        geometry_->entries[n].side = static_cast<std::uint32_t>(v);
    });
}

void storeRoot(const OctreeGeometry& geometry, VdbFile& file)
{
    file.set(kLowest, geometry.lowest);
    file.set(kRootSize, geometry.rootSize);
}

} // namespace lightloom
