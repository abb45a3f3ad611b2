// SPDX-License-Identifier: Apache-2.0
#include "core/bake/vdb_file.h"
#include <cassert>
#include <map>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <sstream>
#include <stdexcept>

namespace lightloom {
namespace {

using Vec3Grid = openvdb::Vec3SGrid;
using FloatGrid = openvdb::FloatGrid;

openvdb::Coord toVdb(glm::ivec3 c) { return {c.x, c.y, c.z}; }
openvdb::Vec3s toVdb(glm::vec3 v) { return {v.x, v.y, v.z}; }
float toVdb(float v) { return v; }
glm::vec3 fromVdb(const openvdb::Vec3s& v) { return {v.x(), v.y(), v.z()}; }
float fromVdb(float v) { return v; }

template<class Grid, class Value>
openvdb::GridBase::Ptr makeGrid(const std::string& name, const VdbFile::Lattice& lattice,
                                std::span<const glm::ivec3> cells, std::span<const Value> values)
{
    assert(cells.size() == values.size());
    const auto grid = Grid::create();
    grid->setName(name);
    // cubes by one number: a file's map says so, and other programs treat it as such
    const glm::dvec3 cell = lattice.cell;
    const bool isCube = cell.x == cell.y && cell.y == cell.z;
    const auto transform = openvdb::math::Transform::createLinearTransform(isCube ? cell.x : 1.0);
    if (!isCube) transform->preScale({cell.x, cell.y, cell.z});
    const glm::dvec3 centre = lattice.corner + 0.5 * cell; // OpenVDB's voxels are centred
    transform->postTranslate({centre.x, centre.y, centre.z});
    grid->setTransform(transform);
    auto access = grid->getAccessor();
    for (std::size_t i = 0; i < cells.size(); ++i) access.setValueOn(toVdb(cells[i]), toVdb(values[i]));
    return grid;
}

template<class Grid>
auto valuesAt(const Grid& grid, std::span<const glm::ivec3> cells)
{
    const auto access = grid.getConstAccessor();
    std::vector<decltype(fromVdb(access.getValue(openvdb::Coord())))> values;
    values.reserve(cells.size());
    for (const glm::ivec3 cell : cells) values.push_back(fromVdb(access.getValue(toVdb(cell))));
    return values;
}

} // namespace

struct VdbFile::Content {
    openvdb::MetaMap meta;
    openvdb::GridPtrVec grids; // in the order they were added
    std::map<std::string, openvdb::GridBase::Ptr> named;

    void add(const openvdb::GridBase::Ptr& grid)
    {
        grids.push_back(grid);
        named[grid->getName()] = grid;
    }
    template<class Grid>
    [[nodiscard]] typename Grid::ConstPtr get(const std::string& name) const
    {
        const auto found = named.find(name);
        const auto grid = found == named.end() ? nullptr : openvdb::gridConstPtrCast<Grid>(found->second);
        if (!grid) throw std::runtime_error("the grid " + name + " is missing");
        return grid;
    }
};

VdbFile::VdbFile() : content_(std::make_unique<Content>()) { openvdb::initialize(); }

VdbFile::VdbFile(const std::string& stream) : VdbFile()
{
    std::istringstream in(stream, std::ios_base::binary);
    openvdb::io::Stream stored(in, false);
    content_->meta = *stored.getMetadata();
    for (const auto& grid : *stored.getGrids()) content_->add(grid);
}

VdbFile::~VdbFile() = default;

std::string VdbFile::bytes() const
{
    std::ostringstream out(std::ios_base::binary);
    out.exceptions(std::ios_base::failbit | std::ios_base::badbit);
    openvdb::io::Stream(out).write(content_->grids, content_->meta);
    return std::move(out).str();
}

void VdbFile::set(const std::string& key, const std::string& text)
{
    content_->meta.insertMeta(key, openvdb::StringMetadata(text));
}
void VdbFile::set(const std::string& key, std::int64_t number)
{
    content_->meta.insertMeta(key, openvdb::Int64Metadata(number));
}
void VdbFile::set(const std::string& key, float number)
{
    content_->meta.insertMeta(key, openvdb::FloatMetadata(number));
}
void VdbFile::set(const std::string& key, glm::vec3 vector)
{
    content_->meta.insertMeta(key, openvdb::Vec3SMetadata(toVdb(vector)));
}

std::string VdbFile::text(const std::string& key) const { return content_->meta.metaValue<std::string>(key); }
std::int64_t VdbFile::integer(const std::string& key) const { return content_->meta.metaValue<std::int64_t>(key); }
float VdbFile::number(const std::string& key) const { return content_->meta.metaValue<float>(key); }
glm::vec3 VdbFile::vector(const std::string& key) const
{
    return fromVdb(content_->meta.metaValue<openvdb::Vec3s>(key));
}

void VdbFile::add(const std::string& name, const Lattice& lattice, std::span<const glm::ivec3> cells,
                  std::span<const float> values)
{
    content_->add(makeGrid<FloatGrid>(name, lattice, cells, values));
}
void VdbFile::add(const std::string& name, const Lattice& lattice, std::span<const glm::ivec3> cells,
                  std::span<const glm::vec3> values)
{
    content_->add(makeGrid<Vec3Grid>(name, lattice, cells, values));
}

bool VdbFile::contains(const std::string& grid) const { return content_->named.contains(grid); }

std::vector<glm::ivec3> VdbFile::cells(const std::string& grid) const
{
    std::vector<glm::ivec3> cells;
    const auto found = content_->get<Vec3Grid>(grid);
    for (auto value = found->cbeginValueOn(); value; ++value) {
        const openvdb::Coord c = value.getCoord();
        cells.emplace_back(c.x(), c.y(), c.z());
    }
    return cells;
}

std::vector<float> VdbFile::numbers(const std::string& grid, std::span<const glm::ivec3> cells) const
{
    return valuesAt(*content_->get<FloatGrid>(grid), cells);
}
std::vector<glm::vec3> VdbFile::vectors(const std::string& grid, std::span<const glm::ivec3> cells) const
{
    return valuesAt(*content_->get<Vec3Grid>(grid), cells);
}

} // namespace lightloom
