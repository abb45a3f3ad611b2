// SPDX-License-Identifier: Apache-2.0
#include "core/bake/bake_file.h"
#include "core/bake/vdb_seal.h"
#include "core/base/atomic_file.h"
#include "core/octree/light_octree.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/trace/cell_clip.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <sstream>

namespace lightloom {
namespace {

using Vec3Grid = openvdb::Vec3SGrid;
using FloatGrid = openvdb::FloatGrid;

constexpr std::uint64_t kMostBytes = 64ull << 30;

openvdb::Coord coordOf(std::uint64_t cell)
{
    const glm::uvec3 c = mortonCell(cell);
    return {static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z)};
}
openvdb::Vec3s toVdb(glm::vec3 v) { return {v.x, v.y, v.z}; }
glm::vec3 fromVdb(const openvdb::Vec3s& v) { return {v.x(), v.y(), v.z()}; }

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

std::string parameterText(const BakeParams& params)
{
    std::string text;
    for (const ParamSpec& spec : kParams) text += fmt::format("{}={}\n", spec.key, paramText(params, spec));
    return text;
}

std::vector<std::string> lines(const std::string& text)
{
    std::vector<std::string> found;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) found.push_back(line);
    return found;
}

/// Ids are free text: a line break in one would make two.
std::string joined(const std::vector<std::string>& ids)
{
    std::string text;
    for (const std::string& id : ids) text += escaped(id) + "\n";
    return text;
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

struct PhotonQuantity {
    const char* name;
    glm::vec3 Photon::*field;
};
constexpr std::array kPhotonQuantities{
    PhotonQuantity{"position", &Photon::position}, PhotonQuantity{"to_light", &Photon::toLight},
    PhotonQuantity{"flux", &Photon::flux}, PhotonQuantity{"normal", &Photon::normal}};

openvdb::Coord placeOf(std::size_t photon)
{
    return {static_cast<int>(photon & 127), static_cast<int>(photon >> 7 & 127), static_cast<int>(photon >> 14)};
}

std::string photonGridName(const std::string& group, const PhotonQuantity& quantity)
{
    return fmt::format("photon-map/d0/{}/{}/0/0", group, quantity.name);
}

openvdb::GridPtrVec photonGrids(const PhotonMapField& field, const Scene& scene)
{
    openvdb::GridPtrVec grids;
    for (std::size_t g = 0; g < field.layers().size(); ++g) {
        const auto& map = field.layers()[g].map;
        if (!map) continue;
        for (const PhotonQuantity& quantity : kPhotonQuantities) {
            const auto grid = Vec3Grid::create();
            grid->setName(photonGridName(escaped(scene.groups[g].id), quantity));
            grid->insertMeta("shot", openvdb::Int64Metadata(static_cast<std::int64_t>(map->paths().shot)));
            auto access = grid->getAccessor();
            for (std::size_t i = 0; i < map->size(); ++i) {
                access.setValueOn(placeOf(i), toVdb(map->photon(static_cast<std::uint32_t>(i)).*quantity.field));
            }
            grids.push_back(grid);
        }
    }
    return grids;
}

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

openvdb::MetaMap metadata(const BakeInfo& info)
{
    openvdb::MetaMap meta;
    meta.insertMeta("lightloom.format", openvdb::Int32Metadata(kBakeFormat));
    meta.insertMeta("lightloom.method", openvdb::StringMetadata(std::string(methodName(info.method))));
    meta.insertMeta("lightloom.program", openvdb::StringMetadata(info.program));
    meta.insertMeta("lightloom.parameters", openvdb::StringMetadata(parameterText(info.params)));
    meta.insertMeta("lightloom.isa", openvdb::StringMetadata(info.isa));
    meta.insertMeta("lightloom.scene", openvdb::StringMetadata(toHex(info.sceneHash)));
    meta.insertMeta("lightloom.groups", openvdb::StringMetadata(joined(info.groups)));
    meta.insertMeta("lightloom.off", openvdb::StringMetadata(joined(info.off)));
    return meta;
}

/// Grids by name, and the values of one at the cells in order.
class Reader {
public:
    Reader(const openvdb::GridPtrVec& grids, const openvdb::MetaMap& meta) : meta_(meta)
    {
        for (const auto& grid : grids) grids_[grid->getName()] = grid;
    }

    [[nodiscard]] std::string text(const char* key) const { return meta_.metaValue<std::string>(key); }

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

    std::shared_ptr<const PhotonPaths> photons(const std::string& group, int number) const
    {
        auto paths = std::make_shared<PhotonPaths>();
        paths->group = number;
        for (const PhotonQuantity& quantity : kPhotonQuantities) {
            const auto grid = get<Vec3Grid>(photonGridName(group, quantity));
            paths->photons.resize(grid->activeVoxelCount());
            paths->shot = static_cast<std::uint64_t>(grid->metaValue<std::int64_t>("shot"));
            const auto access = grid->getConstAccessor();
            for (std::size_t i = 0; i < paths->photons.size(); ++i) {
                paths->photons[i].*quantity.field = fromVdb(access.getValue(placeOf(i)));
            }
        }
        return paths;
    }

    std::shared_ptr<VdlLayer> layer(const OctreeGeometry& geometry, const std::string& group, int number)
    {
        auto layer = std::make_shared<VdlLayer>();
        layer->group = number;
        layer->count = meta_.metaValue<std::int32_t>("lightloom.vdls");
        const auto count = static_cast<std::size_t>(layer->count);
        layer->scalar.resize(geometry.entries.size());
        layer->vdls.resize(geometry.entries.size() * count);
        for (std::uint32_t e = 0; e < mostEntries_; ++e) {
            each<Vec3Grid>(geometry, fmt::format("{}/scalar/{}", group, e), e,
                           [&](std::size_t n, const openvdb::Vec3s& v) { layer->scalar[n] = fromVdb(v); });
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
        const auto found = grids_.find(prefix_ + name);
        const auto grid = found == grids_.end() ? nullptr : openvdb::gridConstPtrCast<Grid>(found->second);
        if (!grid) throw std::runtime_error("the grid " + prefix_ + name + " is missing");
        return grid;
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

    std::map<std::string, openvdb::GridBase::Ptr> grids_;
    const openvdb::MetaMap& meta_;
    std::string prefix_;
    std::uint32_t mostEntries_ = 0;
};

/// What must hold before grids are looked at.
Result<BakeInfo> checkInfo(const openvdb::MetaMap& meta, const Scene& scene)
{
    const auto bad = [](std::string why) { return Error{Error::Kind::badInput, std::move(why)}; };
    const int format = meta.metaValue<std::int32_t>("lightloom.format");
    if (format > kBakeFormat) {
        return bad(fmt::format("the bake has format {}, this program reads up to {}; use a newer Lightloom", format,
                               kBakeFormat));
    }
    BakeInfo info;
    const Result<Method> method = methodNamed(meta.metaValue<std::string>("lightloom.method"));
    if (!method) return method.error();
    info.method = *method;
    for (const std::string& line : lines(meta.metaValue<std::string>("lightloom.parameters"))) {
        Result<BakeParams> params = withAssignment(info.params, line);
        if (!params) return params.error();
        info.params = *params;
    }
    info.isa = meta.metaValue<std::string>("lightloom.isa");
    info.program = meta.metaValue<std::string>("lightloom.program");
    info.sceneHash = sceneHash(scene);
    if (toHex(info.sceneHash) != meta.metaValue<std::string>("lightloom.scene")) {
        return bad("the bake was made for another scene (or the scene has changed since); bake again");
    }
    const std::vector<std::string> off = lines(meta.metaValue<std::string>("lightloom.off"));
    for (const LightGroup& group : scene.groups) {
        info.groups.push_back(group.id);
        if (std::ranges::find(off, escaped(group.id)) != off.end()) info.off.push_back(group.id);
    }
    return info;
}

} // namespace

Result<std::vector<std::uint8_t>> bakeBytes(const IndirectField& field, const BakeInfo& info, const Scene& scene)
try {
    openvdb::initialize();
    std::ostringstream stream(std::ios_base::binary);
    stream.exceptions(std::ios_base::failbit | std::ios_base::badbit);
    openvdb::MetaMap meta = metadata(info);
    openvdb::GridPtrVec grids;
    if (const auto* octree = dynamic_cast<const LightOctree*>(&field)) {
        describe(*octree, meta);
        grids = Writer(*octree, scene).grids(scene);
    } else if (const auto* map = dynamic_cast<const PhotonMapField*>(&field)) {
        grids = photonGrids(*map, scene);
    } else {
        return Error{Error::Kind::unsupported, fmt::format("{} keeps nothing that a file could hold", field.method())};
    }
    openvdb::io::Stream(stream).write(grids, meta);
    return sealVdb(std::move(stream).str());
} catch (const std::exception& failure) {
    return Error{Error::Kind::io, fmt::format("the bake could not be put into a file: {}", failure.what())};
}

Result<Done> writeBake(const std::filesystem::path& path, const IndirectField& field, const BakeInfo& info,
                       const Scene& scene)
{
    const Result<std::vector<std::uint8_t>> bytes = bakeBytes(field, info, scene);
    if (!bytes) return bytes.error();
    return writeFile(path, *bytes);
}

Result<BakeFile> bakeFromBytes(std::span<const std::uint8_t> file, const Scene& scene)
try {
    const Result<std::span<const std::uint8_t>> content = openSeal(file);
    if (!content) return content.error();
    openvdb::initialize();
    std::istringstream stream(std::string(content->begin(), content->end()), std::ios_base::binary);
    openvdb::io::Stream vdb(stream, false);
    const openvdb::MetaMap::ConstPtr meta = vdb.getMetadata(); // a copy, made anew at each call: kept for the reader
    const Result<BakeInfo> info = checkInfo(*meta, scene);
    if (!info) return info.error();
    Reader reader(*vdb.getGrids(), *meta);
    BakeFile bake{*info, nullptr, {}};
    const auto isOn = [&](const LightGroup& group) {
        return std::ranges::find(info->off, group.id) == info->off.end();
    };
    const int groups = static_cast<int>(scene.groups.size());
    if (info->method == Method::photonMap) {
        for (int g = 0; g < groups; ++g) {
            const LightGroup& group = scene.groups[static_cast<std::size_t>(g)];
            bake.photons.push_back(isOn(group) ? reader.photons(escaped(group.id), g) : nullptr);
        }
        return bake;
    }
    const std::shared_ptr<const OctreeGeometry> geometry = reader.geometry();
    std::vector<std::shared_ptr<const VdlLayer>> layers;
    for (int g = 0; g < groups; ++g) {
        const LightGroup& group = scene.groups[static_cast<std::size_t>(g)];
        layers.push_back(isOn(group) ? reader.layer(*geometry, escaped(group.id), g) : nullptr);
    }
    bake.octree = std::make_shared<LightOctree>(geometry, std::move(layers), info->params.vdlForm, Mix{});
    return bake;
} catch (const std::exception& failure) {
    return Error{Error::Kind::badInput, fmt::format("not a Lightloom bake: {}", failure.what())};
}

Result<BakeFile> readBake(const std::filesystem::path& path, const Scene& scene)
{
    const Result<std::vector<std::uint8_t>> bytes = readFile(path, kMostBytes);
    if (!bytes) return bytes.error();
    Result<BakeFile> file = bakeFromBytes(*bytes, scene);
    if (!file) return file.error().in(path.string());
    return file;
}

} // namespace lightloom
