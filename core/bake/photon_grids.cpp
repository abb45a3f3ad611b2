// SPDX-License-Identifier: Apache-2.0
#include "core/bake/vdb_grids.h"
#include <array>
#include <fmt/format.h>

namespace lightloom::vdb {
namespace {

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

} // namespace

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

std::shared_ptr<const PhotonPaths> readPhotons(const NamedGrids& grids, const Scene& scene, int group)
{
    auto paths = std::make_shared<PhotonPaths>();
    paths->group = group;
    const std::string id = escaped(scene.groups[static_cast<std::size_t>(group)].id);
    for (const PhotonQuantity& quantity : kPhotonQuantities) {
        const auto grid = grids.get<Vec3Grid>(photonGridName(id, quantity));
        paths->photons.resize(grid->activeVoxelCount());
        paths->shot = static_cast<std::uint64_t>(grid->metaValue<std::int64_t>("shot"));
        const auto access = grid->getConstAccessor();
        for (std::size_t i = 0; i < paths->photons.size(); ++i) {
            paths->photons[i].*quantity.field = fromVdb(access.getValue(placeOf(i)));
        }
    }
    return paths;
}

} // namespace lightloom::vdb
