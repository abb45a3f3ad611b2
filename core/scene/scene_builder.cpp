// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene_builder.h"
#include "core/base/units.h"
#include <cassert>
#include <cmath>

namespace lightloom {

glm::vec3 tinted(glm::vec3 colour, float value) { return colour * (value / luminance(colour)); }

int SceneBuilder::addMaterial(Material material)
{
    scene_.materials.push_back(std::move(material));
    return static_cast<int>(scene_.materials.size()) - 1;
}

int SceneBuilder::addMaterial(const std::string& name, glm::vec3 albedo)
{
    Material material;
    material.name = name;
    material.baseColor = glm::vec4(albedo, 1.0f);
    material.metallic = 0.0f;
    return addMaterial(std::move(material));
}

int SceneBuilder::addMetal(const std::string& name, glm::vec3 reflectance, float roughness)
{
    Material material;
    material.name = name;
    material.baseColor = glm::vec4(reflectance, 1.0f);
    material.metallic = 1.0f;
    material.roughness = roughness;
    return addMaterial(std::move(material));
}

int SceneBuilder::addGlass(const std::string& name, float ior, glm::vec3 attenuation, float distance)
{
    const int index = addPane(name, glm::vec3(1.0f), ior);
    Material& glass = scene_.materials[static_cast<std::size_t>(index)];
    glass.thickness = 1.0f; // its meshes tell the real one
    glass.attenuationColor = attenuation;
    glass.attenuationDistance = distance;
    return index;
}

int SceneBuilder::addPane(const std::string& name, glm::vec3 tint, float ior)
{
    const int index = addMaterial(name, tint);
    Material& pane = scene_.materials[static_cast<std::size_t>(index)];
    pane.roughness = 0.0f;
    pane.transmission = 1.0f;
    pane.ior = ior;
    return index;
}

int SceneBuilder::addEmitter(const std::string& name, glm::vec3 luminance, glm::vec3 albedo)
{
    const int index = addMaterial(name, albedo);
    scene_.materials[static_cast<std::size_t>(index)].emission = luminance;
    return index;
}

int SceneBuilder::addImage(Image image)
{
    scene_.images.push_back(std::move(image));
    return static_cast<int>(scene_.images.size()) - 1;
}

int SceneBuilder::addMesh(Mesh mesh, int material)
{
    mesh.material = material;
    scene_.meshes.push_back(std::move(mesh));
    return static_cast<int>(scene_.meshes.size()) - 1;
}

void SceneBuilder::place(const std::string& node, int mesh, const glm::mat4& toScene, const std::string& group)
{
    scene_.instances.push_back({mesh, toScene, node, -1});
    instanceGroups_.push_back(group);
}

void SceneBuilder::add(const std::string& node, Mesh mesh, int material, const std::string& group)
{
    if (mesh.name.empty()) mesh.name = node.substr(node.rfind('/') + 1);
    place(node, addMesh(std::move(mesh), material), glm::mat4(1.0f), group);
}

void SceneBuilder::add(const std::string& node, std::vector<Mesh> meshes, const std::string& group)
{
    for (Mesh& mesh : meshes) {
        const int material = mesh.material;
        add(node, std::move(mesh), material, group);
    }
}

void SceneBuilder::addLight(PunctualLight light, const std::string& node, const std::string& group)
{
    light.node = node;
    light.name = node.substr(node.rfind('/') + 1);
    scene_.lights.push_back(std::move(light));
    lightGroups_.push_back(group);
}

void SceneBuilder::addPoint(const std::string& node, glm::vec3 position, glm::vec3 candela, const std::string& group)
{
    PunctualLight light;
    light.position = position;
    light.intensity = candela;
    addLight(std::move(light), node, group);
}

void SceneBuilder::addSpot(const std::string& node, glm::vec3 position, glm::vec3 aim, glm::vec3 candela,
                           float innerCone, float outerCone, const std::string& group)
{
    assert(innerCone < outerCone);
    PunctualLight light;
    light.kind = PunctualLight::Kind::spot;
    light.position = position;
    light.travel = glm::normalize(aim - position);
    light.intensity = candela;
    light.innerCone = innerCone;
    light.outerCone = outerCone;
    addLight(std::move(light), node, group);
}

void SceneBuilder::addDirectional(const std::string& node, glm::vec3 travel, glm::vec3 lux, const std::string& group)
{
    PunctualLight light;
    light.kind = PunctualLight::Kind::directional;
    light.travel = glm::normalize(travel);
    light.intensity = lux;
    addLight(std::move(light), node, group);
}

void SceneBuilder::addCamera(const std::string& name, glm::vec3 position, glm::vec3 target, float yFovDeg)
{
    Camera camera;
    camera.name = name;
    camera.position = position;
    const glm::vec3 forward = glm::normalize(target - position);
    assert(std::abs(forward.y) < 0.999f);
    const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0.0f, 1.0f, 0.0f)));
    camera.orientation = glm::normalize(glm::quat_cast(glm::mat3(right, glm::cross(right, forward), -forward)));
    camera.yFov = glm::radians(yFovDeg);
    scene_.cameras.push_back(camera);
}

Scene SceneBuilder::finish()
{
    std::vector<std::string> groups = std::move(instanceGroups_);
    groups.insert(groups.end(), lightGroups_.begin(), lightGroups_.end());
    finishScene(scene_, groups);
    Scene done = std::move(scene_);
    scene_ = {};
    instanceGroups_.clear();
    lightGroups_.clear();
    return done;
}

} // namespace lightloom
