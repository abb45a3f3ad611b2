// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.h"
#include <algorithm>

namespace lightloom {
namespace {

void addVec3(Sha256& sum, glm::vec3 v) { sum.add(v.x).add(v.y).add(v.z); }

void addTexture(Sha256& sum, const Texture& t)
{
    sum.add(t.image).add(t.uvSet).add(t.wrapS).add(t.wrapT).add(t.smooth ? 1 : 0);
    sum.add(t.offset.x).add(t.offset.y).add(t.scale.x).add(t.scale.y).add(t.rotation);
}

/// All of a material; the order is that of bake files from before lamps were told from surfaces.
void addMaterial(Sha256& sum, const Material& m, bool withEmission)
{
    addVec3(sum, {m.baseColor.x, m.baseColor.y, m.baseColor.z});
    sum.add(m.baseColor.w).add(m.metallic).add(m.roughness).add(m.alpha).add(m.alphaCutoff);
    sum.add(m.doubleSided ? 1 : 0).add(m.transmission).add(m.ior).add(m.thickness).add(m.attenuationDistance);
    if (withEmission) addVec3(sum, m.emission);
    addVec3(sum, m.attenuationColor);
    addTexture(sum, m.baseColorTexture);
    addTexture(sum, m.metallicRoughnessTexture);
    if (withEmission) addTexture(sum, m.emissionTexture);
}

void addLight(Sha256& sum, const PunctualLight& light)
{
    sum.add(light.kind).add(light.innerCone).add(light.outerCone).add(light.group);
    addVec3(sum, light.position);
    addVec3(sum, light.travel);
    addVec3(sum, light.intensity);
}

/// Everything but punctual lights and the names of groups.
void addMeshes(Sha256& sum, const Scene& scene, bool withEmission)
{
    sum.add(scene.origin.x).add(scene.origin.y).add(scene.origin.z);
    for (const Image& image : scene.images) sum.add(image.width).add(image.height).add(image.rgba);
    for (const Material& m : scene.materials) addMaterial(sum, m, withEmission);
    for (const Mesh& mesh : scene.meshes) {
        sum.add(mesh.positions).add(mesh.triangles).add(mesh.uv[0]).add(mesh.uv[1]).add(mesh.colors).add(mesh.material);
    }
    for (const Instance& instance : scene.instances) {
        sum.add(instance.mesh);
        if (withEmission) sum.add(instance.group);
        for (int c = 0; c < 4; ++c) addVec3(sum, glm::vec3(instance.toWorld[c]));
    }
}

const Material& materialOf(const Scene& scene, const Instance& instance)
{
    return scene.materials[static_cast<std::size_t>(scene.meshes[static_cast<std::size_t>(instance.mesh)].material)];
}

Sha256::Digest reflectionOf(const Material& material)
{
    Sha256 sum;
    addMaterial(sum, material, false);
    return sum.finish();
}

} // namespace

Sha256::Digest surfaceHash(const Scene& scene)
{
    Sha256 sum;
    addMeshes(sum, scene, false);
    return sum.finish();
}

Sha256::Digest lampHash(const Scene& scene, int group)
{
    Sha256 sum;
    sum.add(group).add(scene.groups[static_cast<std::size_t>(group)].id);
    for (const PunctualLight& light : scene.lights) {
        if (light.group == group) addLight(sum, light);
    }
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (scene.instances[i].group != group) continue;
        sum.add(static_cast<std::uint64_t>(i));
        const Material& material = materialOf(scene, scene.instances[i]);
        addVec3(sum, material.emission);
        addTexture(sum, material.emissionTexture);
    }
    return sum.finish();
}

Sha256::Digest sceneHash(const Scene& scene)
{
    Sha256 sum;
    addMeshes(sum, scene, true);
    for (const PunctualLight& light : scene.lights) addLight(sum, light);
    for (const LightGroup& group : scene.groups) sum.add(group.id);
    return sum.finish();
}

bool isSameSurface(const Scene& a, const Scene& b)
{
    const auto isSamePlace = [](const Instance& x, const Instance& y) {
        return x.mesh == y.mesh && x.toWorld == y.toWorld;
    };
    const auto reflectsAlike = [](const Material& x, const Material& y) { return reflectionOf(x) == reflectionOf(y); };
    return a.origin == b.origin && a.meshes.isSharedWith(b.meshes) && a.images.isSharedWith(b.images) &&
           std::ranges::equal(a.instances, b.instances, isSamePlace) &&
           std::ranges::equal(a.materials, b.materials, reflectsAlike);
}

} // namespace lightloom
