// SPDX-License-Identifier: Apache-2.0
#include "core/bake/vdb_grids.h"
#include "core/trace/cell_clip.h"
#include <algorithm>
#include <fmt/format.h>

namespace lightloom::vdb {
namespace {

openvdb::Coord coordOf(std::uint64_t cell)
{
    const glm::uvec3 c = mortonCell(cell);
    return {static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z)};
}

class Writer {
public:
    Writer(const LightOctree& octree, const Scene& scene) : octree_(octree), geometry_(octree.geometry())
    {
        const double h = static_cast<double>(geometry_.cellSize());
        const glm::dvec3 corner = scene.toFile(geometry_.lowest) + glm::dvec3(0.5 * h); // OpenVDB's voxels are centred
        transform_ = openvdb::math::Transform::createLinearTransform(h);
        transform_->postTranslate({corner.x, corner.y, corner.z});
        prefix_ = fmt::format("light-octree/d{}/", geometry_.depth);
        for (std::size_t i = 0; i < geometry_.cells.size(); ++i) {
            mostEntries_ = std::max(mostEntries_, geometry_.firstEntry[i + 1] - geometry_.firstEntry[i]);
        }
    }

    openvdb::GridPtrVec grids(const Scene& scene)
    {
        for (std::uint32_t e = 0; e < mostEntries_; ++e) {
            vectors(fmt::format("geometry/normal/{}", e), e,
                    [&](std::uint32_t n) { return geometry_.entries[n].normal; });
            vectors(fmt::format("geometry/centroid/{}", e), e,
                    [&](std::uint32_t n) { return geometry_.entries[n].centroid; });
            scalars(fmt::format("geometry/area/{}", e), e, [&](std::uint32_t n) { return geometry_.entries[n].area; });
        }
        for (const auto& layer : octree_.layers()) {
            if (layer) add(*layer, escaped(scene.groups[static_cast<std::size_t>(layer->group)].id));
        }
        return std::move(grids_);
    }

private:
    void add(const VdlLayer& layer, const std::string& group)
    {
        const auto count = static_cast<std::size_t>(layer.count);
        for (std::uint32_t e = 0; e < mostEntries_; ++e) {
            vectors(fmt::format("{}/scalar/{}", group, e), e, [&](std::uint32_t n) { return layer.scalar[n]; });
            scalars(fmt::format("{}/noise/{}", group, e), e, [&](std::uint32_t n) { return layer.noise[n]; });
            for (std::size_t j = 0; j < count; ++j) {
                const auto vdl = [&, j](std::uint32_t n) -> const Vdl& { return layer.vdls[n * count + j]; };
                vectors(fmt::format("{}/colour/{}/{}", group, e, j), e, [&](std::uint32_t n) { return vdl(n).colour; });
                vectors(fmt::format("{}/direction/{}/{}", group, e, j), e,
                        [&](std::uint32_t n) { return vdl(n).toLight; });
            }
        }
    }

    template<class Value>
    void vectors(const std::string& name, std::uint32_t slot, Value value)
    {
        fill<Vec3Grid>(name, slot, [&](std::uint32_t n) { return toVdb(value(n)); });
    }
    template<class Value>
    void scalars(const std::string& name, std::uint32_t slot, Value value)
    {
        fill<FloatGrid>(name, slot, value);
    }

    template<class Grid, class Value>
    void fill(const std::string& name, std::uint32_t slot, Value value)
    {
        const auto grid = Grid::create();
        grid->setName(prefix_ + name);
        grid->setTransform(transform_->copy());
        auto access = grid->getAccessor();
        for (std::size_t i = 0; i < geometry_.cells.size(); ++i) {
            const std::uint32_t entry = geometry_.firstEntry[i] + slot;
            if (entry < geometry_.firstEntry[i + 1]) access.setValueOn(coordOf(geometry_.cells[i]), value(entry));
        }
        grids_.push_back(grid);
    }

    const LightOctree& octree_;
    const OctreeGeometry& geometry_;
    openvdb::math::Transform::Ptr transform_;
    std::string prefix_;
    std::uint32_t mostEntries_ = 0;
    openvdb::GridPtrVec grids_;
};

void describe(const LightOctree& octree, openvdb::MetaMap& meta)
{
    const OctreeGeometry& geometry = octree.geometry();
    int vdls = 1;
    for (const auto& layer : octree.layers()) vdls = layer ? layer->count : vdls;
    meta.insertMeta("lightloom.depth", openvdb::Int32Metadata(geometry.depth));
    meta.insertMeta("lightloom.vdls", openvdb::Int32Metadata(vdls));
    meta.insertMeta("lightloom.lowest", openvdb::Vec3SMetadata(toVdb(geometry.lowest)));
    meta.insertMeta("lightloom.root_size", openvdb::FloatMetadata(geometry.rootSize));
}

/// The values of grids at the cells in order.
class Reader {
public:
    Reader(const NamedGrids& grids, const openvdb::MetaMap& meta) : grids_(grids), meta_(meta) {}

    std::shared_ptr<OctreeGeometry> geometry()
    {
        auto geometry = std::make_shared<OctreeGeometry>();
        geometry->depth = meta_.metaValue<std::int32_t>("lightloom.depth");
        geometry->lowest = fromVdb(meta_.metaValue<openvdb::Vec3s>("lightloom.lowest"));
        geometry->rootSize = meta_.metaValue<float>("lightloom.root_size");
        prefix_ = fmt::format("light-octree/d{}/", geometry->depth);
        while (grids_.contains(prefix_ + fmt::format("geometry/normal/{}", mostEntries_))) ++mostEntries_;
        if (mostEntries_ > 0) {
            const auto grid = get<Vec3Grid>("geometry/normal/0");
            for (auto value = grid->cbeginValueOn(); value; ++value) {
                const openvdb::Coord c = value.getCoord();
                geometry->cells.push_back(mortonCode(glm::uvec3(c.x(), c.y(), c.z())));
            }
            std::ranges::sort(geometry->cells);
        }
        entries(*geometry);
        return geometry;
    }

    std::shared_ptr<VdlLayer> layer(const OctreeGeometry& geometry, const std::string& group, int number)
    {
        auto layer = std::make_shared<VdlLayer>();
        layer->group = number;
        layer->count = meta_.metaValue<std::int32_t>("lightloom.vdls");
        const auto count = static_cast<std::size_t>(layer->count);
        layer->scalar.resize(geometry.entries.size());
        layer->noise.resize(geometry.entries.size());
        layer->vdls.resize(geometry.entries.size() * count);
        for (std::uint32_t e = 0; e < mostEntries_; ++e) {
            each<Vec3Grid>(geometry, fmt::format("{}/scalar/{}", group, e), e,
                           [&](std::size_t n, const openvdb::Vec3s& v) { layer->scalar[n] = fromVdb(v); });
            each<FloatGrid>(geometry, fmt::format("{}/noise/{}", group, e), e,
                            [&](std::size_t n, float v) { layer->noise[n] = v; });
            for (std::size_t j = 0; j < count; ++j) {
                each<Vec3Grid>(
                    geometry, fmt::format("{}/colour/{}/{}", group, e, j), e,
                    [&](std::size_t n, const openvdb::Vec3s& v) { layer->vdls[n * count + j].colour = fromVdb(v); });
                each<Vec3Grid>(
                    geometry, fmt::format("{}/direction/{}/{}", group, e, j), e,
                    [&](std::size_t n, const openvdb::Vec3s& v) { layer->vdls[n * count + j].toLight = fromVdb(v); });
            }
        }
        return layer;
    }

private:
    template<class Grid>
    typename Grid::ConstPtr get(const std::string& name) const
    {
        return grids_.get<Grid>(prefix_ + name);
    }

    void entries(OctreeGeometry& geometry)
    {
        std::vector<typename Vec3Grid::ConstPtr> normals;
        for (std::uint32_t e = 0; e < mostEntries_; ++e)
            normals.push_back(get<Vec3Grid>(fmt::format("geometry/normal/{}", e)));
        for (const std::uint64_t cell : geometry.cells) {
            geometry.firstEntry.push_back(static_cast<std::uint32_t>(geometry.entries.size()));
            for (const auto& grid : normals) {
                if (!grid->tree().isValueOn(coordOf(cell))) break;
                geometry.entries.push_back({glm::vec3(0.0f), fromVdb(grid->tree().getValue(coordOf(cell))), 0.0f});
            }
        }
        geometry.firstEntry.push_back(static_cast<std::uint32_t>(geometry.entries.size()));
        for (std::uint32_t e = 0; e < mostEntries_; ++e) {
            each<Vec3Grid>(geometry, fmt::format("geometry/centroid/{}", e), e,
                           [&](std::size_t n, const openvdb::Vec3s& v) { geometry.entries[n].centroid = fromVdb(v); });
            each<FloatGrid>(geometry, fmt::format("geometry/area/{}", e), e,
                            [&](std::size_t n, float v) { geometry.entries[n].area = v; });
        }
    }

    template<class Grid, class Use>
    void each(const OctreeGeometry& geometry, const std::string& name, std::uint32_t slot, Use use) const
    {
        const auto grid = get<Grid>(name);
        const auto access = grid->getConstAccessor();
        for (std::size_t i = 0; i < geometry.cells.size(); ++i) {
            const std::uint32_t entry = geometry.firstEntry[i] + slot;
            if (entry < geometry.firstEntry[i + 1]) use(entry, access.getValue(coordOf(geometry.cells[i])));
        }
    }

    const NamedGrids& grids_;
    const openvdb::MetaMap& meta_;
    std::string prefix_;
    std::uint32_t mostEntries_ = 0;
};

} // namespace

std::string escaped(const std::string& id)
{
    std::string out;
    for (const char c : id) {
        if (c == '/' || c == '%' || static_cast<unsigned char>(c) < 32) {
            out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
        } else {
            out += c;
        }
    }
    return out;
}

openvdb::GridPtrVec octreeGrids(const LightOctree& octree, const Scene& scene, openvdb::MetaMap& meta)
{
    describe(octree, meta);
    return Writer(octree, scene).grids(scene);
}

std::shared_ptr<const LightOctree> readOctree(const NamedGrids& grids, const openvdb::MetaMap& meta, const Scene& scene,
                                              const std::vector<bool>& isOn, VdlForm form)
{
    Reader reader(grids, meta);
    const std::shared_ptr<const OctreeGeometry> geometry = reader.geometry();
    std::vector<std::shared_ptr<const VdlLayer>> layers;
    for (std::size_t g = 0; g < isOn.size(); ++g) {
        const std::string id = escaped(scene.groups[g].id);
        layers.push_back(isOn[g] ? reader.layer(*geometry, id, static_cast<int>(g)) : nullptr);
    }
    return std::make_shared<LightOctree>(geometry, std::move(layers), form, Mix{});
}

} // namespace lightloom::vdb
