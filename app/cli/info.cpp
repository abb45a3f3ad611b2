// SPDX-License-Identifier: Apache-2.0
#include "app/cli/commands.h"
#include "core/ivg/grid_advice.h"
#include "core/ivg/ivg_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/gltf_reader.h"
#include "core/scene/scene_features.h"
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {
namespace {

using Json = nlohmann::json;

Json asJson(glm::dvec3 v) { return {v.x, v.y, v.z}; }
Json asJson(const std::optional<LightRange>& range)
{
    return range ? Json{{"least", range->least}, {"most", range->most}} : Json();
}

Json asJson(const std::string& file, const Scene& scene, const SceneFeatures& f)
{
    Json json{
        {"file", file},
        {"name", scene.name},
        {"triangles", f.triangles},
        {"storedTriangles", f.storedTriangles},
        {"instances", f.instances},
        {"meshes", f.meshes},
        {"materials", f.materials},
        {"images", f.images},
        {"areaM2", f.area},
        {"bounds",
         {{"low", asJson(scene.toFile(f.bounds.low))},
          {"high", asJson(scene.toFile(f.bounds.high))},
          {"size", asJson(glm::dvec3(f.bounds.size()))}}},
        {"bodies", {{"count", f.bodies}, {"closed", f.closedBodies}}},
        {"watertight", f.isWatertight ? Json(*f.isWatertight) : Json()},
        {"lamps", {{"point", f.pointLamps}, {"spot", f.spotLamps}, {"directional", f.suns}, {"dark", f.darkLamps}}},
        {"glowingInstances", f.glowingInstances},
        {"candela", asJson(f.candela)},
        {"lux", asJson(f.lux)},
        {"luminance", asJson(f.luminance)},
        {"mirrors", f.hasMirrors},
        {"metal", f.hasGlossyMetal},
        {"glass", f.hasGlass},
        {"panes", f.hasPanes},
        {"textures", f.hasTextures},
        {"cutouts", f.hasCutouts},
        {"exposure", scene.exposureEv ? Json(*scene.exposureEv) : Json()},
        {"follows", f.follows},
        {"warnings", scene.warnings},
    };
    json["thinnestWall"] = {{"rays", f.walls.samples}};
    if (const auto& wall = f.walls.thinnest) {
        json["thinnestWall"]["thickness"] = wall->thickness;
        json["thinnestWall"]["at"] = asJson(scene.toFile(wall->at));
    }
    json["groups"] = Json::array();
    for (const LightGroup& group : scene.groups) json["groups"].push_back({{"id", group.id}, {"label", group.label}});
    json["cameras"] = Json::array();
    for (const Camera& camera : scene.cameras) json["cameras"].push_back(camera.name);
    return json;
}

void line(std::string_view label, const std::string& text) { fmt::print("  {:<15}{}\n", label, text); }

std::string counted(std::uint64_t n, std::string_view one, std::string_view many)
{
    return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::string rangeText(const LightRange& range, std::string_view unit)
{
    if (range.least == range.most) return fmt::format("{:.4g} {}", range.least, unit);
    return fmt::format("{:.4g} to {:.4g} {}", range.least, range.most, unit);
}

std::string wallText(const Scene& scene, const ThinWallSearch& walls)
{
    if (walls.samples == 0) return "not looked for: too many triangles";
    if (!walls.thinnest) return fmt::format("none met by {} rays", walls.samples);
    const glm::dvec3 at = scene.toFile(walls.thinnest->at);
    return fmt::format("{:.3g} m at ({:.3g}, {:.3g}, {:.3g}); {} rays", walls.thinnest->thickness, at.x, at.y, at.z,
                       walls.samples);
}

void printGeometry(const Scene& scene, const SceneFeatures& f)
{
    const glm::vec3 size = f.bounds.size();
    line("Size", fmt::format("{:.4g} x {:.4g} x {:.4g} m, {:.4g} m2 of surface", size.x, size.y, size.z, f.area));
    std::string triangles = counted(f.triangles, "triangle", "triangles");
    if (f.storedTriangles != f.triangles) triangles += fmt::format(" ({} stored)", f.storedTriangles);
    line("Geometry", fmt::format("{} in {} of {}", triangles, counted(f.instances, "instance", "instances"),
                                 counted(f.meshes, "mesh", "meshes")));
    const std::string whole = !f.isWatertight   ? "too many triangles to say more"
                              : *f.isWatertight ? "the scene as a whole is watertight"
                                                : "the scene as a whole is open";
    line("Closed", fmt::format("{} of {}; {}", f.closedBodies, counted(f.bodies, "body", "bodies"), whole));
    line("Thinnest wall", wallText(scene, f.walls));
}

void printSurfaces(const SceneFeatures& f)
{
    std::vector<std::string> traits;
    if (f.hasMirrors) traits.emplace_back("mirrors");
    if (f.hasGlossyMetal) traits.emplace_back("metal");
    if (f.hasGlass) traits.emplace_back("solid glass");
    if (f.hasPanes) traits.emplace_back("thin panes");
    if (f.hasTextures) traits.push_back(counted(f.images, "image", "images"));
    if (f.hasCutouts) traits.emplace_back("cut-outs");
    const std::string rest = traits.empty() ? "all diffuse, no textures" : fmt::format("{}", fmt::join(traits, ", "));
    line("Materials", fmt::format("{}: {}", f.materials, rest));
}

void printLight(const Scene& scene, const SceneFeatures& f)
{
    if (f.pointLamps + f.spotLamps > 0) {
        std::vector<std::string> kinds;
        if (f.pointLamps > 0) kinds.push_back(fmt::format("{} point", f.pointLamps));
        if (f.spotLamps > 0) kinds.push_back(fmt::format("{} spot", f.spotLamps));
        line("Lamps", fmt::format("{}{}", fmt::join(kinds, ", "),
                                  f.candela ? ": " + rangeText(*f.candela, "cd") : ", all dark"));
    }
    if (f.suns > 0) line("Suns", fmt::format("{}{}", f.suns, f.lux ? ": " + rangeText(*f.lux, "lux") : ", all dark"));
    if (f.luminance && f.glowingInstances > 0) {
        line("Glowing", fmt::format("{}: {}", counted(f.glowingInstances, "surface", "surfaces"),
                                    rangeText(*f.luminance, "cd/m2")));
    }
    std::string label = "Light groups";
    for (const LightGroup& group : scene.groups) {
        line(label, group.id);
        label.clear();
    }
    label = "Cameras";
    for (const Camera& camera : scene.cameras) {
        line(label, camera.name);
        label.clear();
    }
    if (scene.exposureEv) line("Exposure", fmt::format("EV {:.3g}", *scene.exposureEv));
}

void printList(std::string_view title, const std::vector<std::string>& lines)
{
    if (lines.empty()) return;
    fmt::print("\n{}\n", title);
    for (const std::string& text : lines) fmt::print("  - {}\n", text);
}

/// What an irradiance grid of this scene wants: cells by how far walls lie apart, photons by noise.
struct GridWish {
    int size = 0;
    std::uint64_t photons = 0; ///< per light group, for kWishedNoise
    float cell = 0.0f, wallSpacing = 0.0f, thinnest = 0.0f;
    bool isCut = false;
};
constexpr float kWishedNoise = 0.02f;

Result<GridWish> gridWish(const Context& context, const std::shared_ptr<const Scene>& scene)
{
    BakeJob job{scene, {}, {}};
    job.params.gridSize = 0;
    job.params.gridNoise = kWishedNoise;
    BakeProducts products;
    BakeControl control(*context.workers, {}, context.stop);
    const Result<SceneProducts> at = sceneProducts(job, products, control);
    if (!at) return at.error();
    const Result<BakeParams> settled = settledGridParams(job, *at, products, control);
    if (!settled) return settled.error();
    const GridAdvice advice = adviseGridSize(*at, {}, 0.0f);
    const float cell = placeGrid(*at->rays, {settled->gridSize, glm::ivec3(0)}, 0.0f).cellSize.x;
    return GridWish{settled->gridSize,  static_cast<std::uint64_t>(settled->photonCount), cell,
                    advice.wallSpacing, cell * leastWallCells(GridFilter::trilinear),     advice.isCut};
}

Json asJson(const GridWish& wish)
{
    return {{"size", wish.size},
            {"cellSize", wish.cell},
            {"wallSpacing", wish.wallSpacing},
            {"isCut", wish.isCut},
            {"noise", kWishedNoise},
            {"photonsPerGroup", wish.photons},
            {"thinnestWallParted", wish.thinnest}};
}

} // namespace

int info(const Context& context, const std::string& file)
{
    const auto scene = readScene(file); // warnings are part of what is printed
    if (!scene) return fail(scene.error());
    const SceneFeatures features = findFeatures(**scene);
    const Result<GridWish> grid = gridWish(context, *scene);
    if (!grid) return fail(grid.error());
    if (context.json) {
        Json json = asJson(file, **scene, features);
        json["grid"] = asJson(*grid);
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
        return kDone;
    }
    fmt::print("{}{}\n", file, (*scene)->name.empty() ? "" : fmt::format(" - {}", (*scene)->name));
    printGeometry(**scene, features);
    printSurfaces(features);
    printLight(**scene, features);
    line("Irradiance grid",
         fmt::format("{} cells of {:.3g} m ({} walls {:.3g} m apart), walls from {:.2g} m parted; {} photons per light "
                     "group for {:.0f} % noise",
                     grid->size, grid->cell, grid->isCut ? "memory's limit;" : "for", grid->wallSpacing, grid->thinnest,
                     grid->photons, 100.0f * kWishedNoise));
    printList("What follows", features.follows);
    printList("Read differently", (*scene)->warnings);
    return kDone;
}

} // namespace lightloom::cli
