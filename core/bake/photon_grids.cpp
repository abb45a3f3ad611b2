// SPDX-License-Identifier: Apache-2.0
#include "core/bake/bake_grids.h"
#include <array>
#include <fmt/format.h>

namespace lightloom {
namespace {

struct Quantity {
    const char* name;
    glm::vec3 Photon::*field;
};
constexpr std::array kQuantities{Quantity{"position", &Photon::position}, Quantity{"to_light", &Photon::toLight},
                                 Quantity{"flux", &Photon::flux}, Quantity{"normal", &Photon::normal}};
constexpr const char *kIrradiance = "irradiance", *kNoise = "noise"; ///< of Christensen's cache

std::string gridName(const std::string& group, const char* quantity)
{
    return fmt::format("photon-map/d0/{}/{}/0/0", group, quantity);
}
std::string shotKey(const std::string& group) { return "lightloom.shot/" + group; }

/// Voxels of photons 0 .. count - 1.
std::vector<glm::ivec3> placesOf(std::size_t count)
{
    std::vector<glm::ivec3> places;
    places.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        places.emplace_back(static_cast<int>(i & 127), static_cast<int>(i >> 7 & 127), static_cast<int>(i >> 14));
    }
    return places;
}

} // namespace

void storePhotons(const PhotonMapField& field, const Scene& scene, VdbFile& file)
{
    for (std::size_t g = 0; g < field.layers().size(); ++g) {
        const auto& map = field.layers()[g].map;
        if (!map) continue;
        const std::string group = escaped(scene.groups[g].id);
        file.set(shotKey(group), static_cast<std::int64_t>(map->paths().shot));
        const std::vector<glm::ivec3> places = placesOf(map->size());
        std::vector<glm::vec3> values(places.size());
        const std::vector<std::uint32_t> order = map->listOrder();
        for (const Quantity& quantity : kQuantities) {
            for (std::size_t i = 0; i < values.size(); ++i) values[i] = map->photon(order[i]).*quantity.field;
            file.add(gridName(group, quantity.name), {}, places, values);
        }
        const auto& cache = field.layers()[g].cache;
        if (!cache) continue;
        const ChristensenCache::Values& kept = cache->values();
        file.add(gridName(group, kIrradiance), {}, placesOf(kept.lux.size()), std::span(kept.lux));
        file.add(gridName(group, kNoise), {}, placesOf(kept.noise.size()), std::span(kept.noise));
    }
}

ChristensenCache::Values readCache(const VdbFile& file, const Scene& scene, int group)
{
    const std::string id = escaped(scene.groups[static_cast<std::size_t>(group)].id);
    ChristensenCache::Values values;
    if (!file.contains(gridName(id, kIrradiance))) return values;
    const std::vector<glm::ivec3> places = placesOf(file.cells(gridName(id, kIrradiance)).size());
    values.lux = file.vectors(gridName(id, kIrradiance), places);
    values.noise = file.numbers(gridName(id, kNoise), places);
    return values;
}

std::shared_ptr<const PhotonPaths> readPhotons(const VdbFile& file, const Scene& scene, int group)
{
    auto paths = std::make_shared<PhotonPaths>();
    const std::string id = escaped(scene.groups[static_cast<std::size_t>(group)].id);
    paths->group = group;
    paths->shot = static_cast<std::uint64_t>(file.integer(shotKey(id)));
    const std::vector<glm::ivec3> places = placesOf(file.cells(gridName(id, kQuantities[0].name)).size());
    paths->photons.resize(places.size());
    for (const Quantity& quantity : kQuantities) {
        const std::vector<glm::vec3> values = file.vectors(gridName(id, quantity.name), places);
        for (std::size_t i = 0; i < values.size(); ++i) paths->photons[i].*quantity.field = values[i];
    }
    return paths;
}

} // namespace lightloom
