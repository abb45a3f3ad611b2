// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene_features.h"
#include "core/base/units.h"
#include "core/scene/mesh_closed.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>

namespace lightloom {
namespace {

constexpr std::uint64_t kMostWelded = 20'000'000; ///< triangles; welding takes 50 bytes a vertex
constexpr float kWeld = 1e-5f;                    ///< of a body's size

const Mesh& meshOf(const Scene& scene, const Instance& instance)
{
    return scene.meshes[static_cast<std::size_t>(instance.mesh)];
}

void widen(std::optional<LightRange>& range, float value)
{
    if (!(value > 0.0f)) return;
    range = range ? LightRange{std::min(range->least, value), std::max(range->most, value)} : LightRange{value, value};
}

/// Points of some instances in one space, their triangles numbered through.
class Body {
public:
    void add(const Mesh& mesh, const glm::mat4& place)
    {
        const auto first = static_cast<std::uint32_t>(positions_.size());
        for (const glm::vec3 p : mesh.positions) positions_.emplace_back(place * glm::vec4(p, 1.0f));
        const bool turned = glm::determinant(glm::mat3(place)) < 0.0f;
        for (const glm::uvec3 t : mesh.triangles) {
            const glm::uvec3 corners = t + first;
            triangles_.push_back(turned ? glm::uvec3(corners.x, corners.z, corners.y) : corners);
        }
    }

    [[nodiscard]] bool isClosed() const
    {
        glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
        for (const glm::vec3 p : positions_) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        const std::vector<std::uint32_t> standIn = weldVertices(positions_, kWeld * glm::length(high - low));
        EdgeBalance edges;
        for (const glm::uvec3 t : triangles_) edges.add({standIn[t.x], standIn[t.y], standIn[t.z]});
        return !triangles_.empty() && edges.isClosed();
    }

private:
    std::vector<glm::vec3> positions_;
    std::vector<glm::uvec3> triangles_;
};

/// Bodies and whether they close. A node's parts lie side by side in the list and share their place, so that copies of
/// a body are looked at once.
void findBodies(const Scene& scene, SceneFeatures& features)
{
    std::map<std::string, std::vector<const Instance*>> byNode;
    for (const Instance& instance : scene.instances) byNode[instance.node].push_back(&instance);
    features.bodies = byNode.size();
    if (features.triangles > kMostWelded) return;
    std::map<std::vector<int>, bool> known; // by the body's meshes
    for (const auto& [node, parts] : byNode) {
        std::vector<int> meshes;
        const bool isOnePlace =
            std::all_of(parts.begin(), parts.end(), [&](const Instance* i) { return i->toWorld == parts[0]->toWorld; });
        for (const Instance* part : parts) meshes.push_back(part->mesh);
        const auto found = isOnePlace ? known.find(meshes) : known.end();
        bool isClosed = found != known.end() && found->second;
        if (found == known.end()) {
            Body body;
            for (const Instance* part : parts) {
                body.add(meshOf(scene, *part), isOnePlace ? glm::mat4(1.0f) : part->toWorld);
            }
            isClosed = body.isClosed();
            if (isOnePlace) known[meshes] = isClosed;
        }
        if (isClosed) ++features.closedBodies;
    }
    Body all;
    for (const Instance& instance : scene.instances) all.add(meshOf(scene, instance), instance.toWorld);
    features.isWatertight = all.isClosed();
}

double areaOf(const Mesh& mesh, const glm::mat4& place)
{
    double area = 0.0;
    const auto at = [&](std::uint32_t v) { return glm::dvec3(place * glm::vec4(mesh.positions[v], 1.0f)); };
    for (const glm::uvec3 t : mesh.triangles) {
        const glm::dvec3 a = at(t.x);
        area += 0.5 * glm::length(glm::cross(at(t.y) - a, at(t.z) - a));
    }
    return area;
}

void countThings(const Scene& scene, SceneFeatures& features)
{
    features.instances = scene.instances.size();
    features.meshes = scene.meshes.size();
    features.images = scene.images.size();
    features.cameras = scene.cameras.size();
    features.groups = scene.groups.size();
    features.bounds = scene.bounds;
    for (const Mesh& mesh : scene.meshes) features.storedTriangles += mesh.triangles.size();
    for (const Instance& instance : scene.instances) {
        features.triangles += meshOf(scene, instance).triangles.size();
        features.area += areaOf(meshOf(scene, instance), instance.toWorld);
        if (instance.group >= 0) ++features.glowingInstances;
    }
}

void lookAtMaterials(const Scene& scene, SceneFeatures& features)
{
    std::vector<bool> worn(scene.materials.size(), false);
    for (const Instance& instance : scene.instances) {
        worn[static_cast<std::size_t>(meshOf(scene, instance).material)] = true;
    }
    for (std::size_t i = 0; i < worn.size(); ++i) {
        if (!worn[i]) continue;
        const Material& m = scene.materials[i];
        ++features.materials;
        const bool isMetal = m.metallic > 0.0f && maxChannel({m.baseColor.x, m.baseColor.y, m.baseColor.z}) > 0.0f;
        features.hasMirrors = features.hasMirrors || mayMirror(m);
        features.hasGlossyMetal = features.hasGlossyMetal || (isMetal && m.roughness >= kMirrorRoughness);
        if (mayTransmit(m)) (m.thickness > 0.0f ? features.hasGlass : features.hasPanes) = true;
        features.hasTextures = features.hasTextures || m.baseColorTexture.isSet() ||
                               (isMetal && m.metallicRoughnessTexture.isSet()) ||
                               (m.isEmissive() && m.emissionTexture.isSet());
        features.hasCutouts = features.hasCutouts || m.alpha == Material::Alpha::mask;
        widen(features.luminance, luminance(m.emission));
    }
}

void lookAtLamps(const Scene& scene, SceneFeatures& features)
{
    for (const PunctualLight& lamp : scene.lights) {
        const float strength = luminance(lamp.intensity);
        const bool isSun = lamp.kind == PunctualLight::Kind::directional;
        ++(isSun ? features.suns : lamp.kind == PunctualLight::Kind::spot ? features.spotLamps : features.pointLamps);
        if (!(strength > 0.0f)) ++features.darkLamps;
        widen(isSun ? features.lux : features.candela, strength);
    }
}

std::vector<std::string> consequences(const SceneFeatures& f)
{
    std::vector<std::string> lines;
    const auto say = [&](bool applies, std::string line) {
        if (applies) lines.push_back(std::move(line));
    };
    say(f.emitters() == 0, "No light: nothing is shot, every bake is black.");
    say(f.darkLamps > 0, fmt::format("{} of the lamps give no light: nothing is shot for them.", f.darkLamps));
    say(f.emitters() > 0 && !f.hasSpecular(), "No mirrors, metal or glass: no caustic photons are shot.");
    say(f.hasMirrors || f.hasGlossyMetal, fmt::format("{}: light by way of it is followed as caustics.",
                                                      f.hasMirrors ? "Mirrors or smooth metal" : "Metal"));
    say(f.hasGlass, "Solid glass: bends light, which is followed as caustics and counts as indirect.");
    say(f.hasPanes, "Thin panes: light goes straight through and counts as indirect.");
    say(!f.hasTextures, "No textures: reflectance is looked up once per material.");
    say(!f.hasCutouts, "No cut-outs: rays stop at the first triangle they meet.");
    say(f.groups == 1, "One light group: one layer, nothing to mix but its own brightness.");
    say(f.groups > 1, fmt::format("{} light groups: {} layers, each dimmed without a new bake.", f.groups, f.groups));
    say(f.glowingInstances == 0 && f.emitters() > 0, "No glowing surfaces: direct light needs no area sampling.");
    say(f.isWatertight == true, "The scene is closed: no light escapes.");
    say(f.isWatertight == false, "The surfaces do not close edge to edge: light that finds a way out is gone.");
    if (const auto& wall = f.walls.thinnest) {
        const float longest = f.bounds.longestSide();
        const double cells = std::ceil(static_cast<double>(longest) / static_cast<double>(wall->thickness));
        say(true,
            fmt::format("Cells up to {:.3g} m keep the two sides of the thinnest wall or board apart: {:.0f} along the "
                        "longest side, octree depth {:.0f}.",
                        wall->thickness, cells, std::ceil(std::log2(cells))));
    }
    return lines;
}

} // namespace

SceneFeatures findFeatures(const Scene& scene)
{
    SceneFeatures features;
    countThings(scene, features);
    lookAtMaterials(scene, features);
    lookAtLamps(scene, features);
    findBodies(scene, features);
    features.walls = findThinWalls(scene);
    features.follows = consequences(features);
    return features;
}

} // namespace lightloom
