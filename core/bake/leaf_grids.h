// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/vdb_file.h"
#include "core/octree/light_octree.h"

/// Leaves of an octree and numbers of their entries as named grids of a bake file. Entry number e of a leaf has its
/// value in the voxel of the leaf, in the grid <prefix><name>/<e>.
namespace lightloom {

/// Leaves that have an entry number `e`, and where these entries stand among all: one grid's voxels.
struct LeafSlot {
    std::vector<glm::ivec3> cells;
    std::vector<std::uint32_t> entries;
};
[[nodiscard]] std::vector<LeafSlot> leafSlots(const OctreeGeometry& geometry);

class LeafWriter {
public:
    LeafWriter(const OctreeGeometry& geometry, std::string prefix, const Scene& scene, VdbFile& file);

    void geometry(); ///< of the entries
    /// valueOf(entry): float or glm::vec3.
    template<class ValueOf>
    void values(const std::string& name, const ValueOf& valueOf)
    {
        for (std::size_t e = 0; e < slots_.size(); ++e) {
            std::vector<decltype(valueOf(0u))> values;
            for (const std::uint32_t entry : slots_[e].entries) values.push_back(valueOf(entry));
            add(name + "/" + std::to_string(e), slots_[e].cells, values);
        }
    }
    /// Of some leaves only; nothing for none.
    template<class Value>
    void add(const std::string& name, std::span<const glm::ivec3> cells, const std::vector<Value>& values)
    {
        if (!cells.empty()) file_.add(prefix_ + name, lattice_, cells, std::span(values));
    }
    [[nodiscard]] const std::vector<LeafSlot>& slots() const { return slots_; }

private:
    const OctreeGeometry& geometry_;
    std::string prefix_;
    VdbFile& file_;
    VdbFile::Lattice lattice_;
    std::vector<LeafSlot> slots_;
};

/// Throws as VdbFile does, and where leaves and entries do not go together.
class LeafReader {
public:
    /// `depth` and root as the file says them.
    LeafReader(const VdbFile& file, int depth, std::string prefix);
    /// Whether the file holds leaves under that prefix.
    [[nodiscard]] static bool isThere(const VdbFile& file, const std::string& prefix);

    [[nodiscard]] const std::shared_ptr<OctreeGeometry>& geometry() const { return geometry_; }
    [[nodiscard]] const std::vector<LeafSlot>& slots() const { return slots_; }
    /// use(entry, value) for each entry.
    template<class Use>
    void vectors(const std::string& name, const Use& use) const
    {
        for (std::size_t e = 0; e < slots_.size(); ++e) each(file_.vectors(nameOf(name, e), slots_[e].cells), e, use);
    }
    template<class Use>
    void numbers(const std::string& name, const Use& use) const
    {
        for (std::size_t e = 0; e < slots_.size(); ++e) numbersOf(name, e, use);
    }
    [[nodiscard]] std::string nameOf(const std::string& name, std::size_t e) const
    {
        return prefix_ + name + "/" + std::to_string(e);
    }

private:
    void readCells();
    void readEntries();
    void readSides(std::size_t e);
    template<class Use>
    void numbersOf(const std::string& name, std::size_t e, const Use& use) const
    {
        each(file_.numbers(nameOf(name, e), slots_[e].cells), e, use);
    }
    template<class Values, class Use>
    void each(const Values& values, std::size_t e, const Use& use) const
    {
        for (std::size_t i = 0; i < values.size(); ++i) use(slots_[e].entries[i], values[i]);
    }

    const VdbFile& file_;
    std::string prefix_;
    std::shared_ptr<OctreeGeometry> geometry_;
    std::vector<LeafSlot> slots_;
};

/// The root cell, as all levels of a file share it.
void storeRoot(const OctreeGeometry& geometry, VdbFile& file);

} // namespace lightloom
