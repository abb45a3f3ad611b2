// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/hash.h"
#include "core/base/shared_list.h"
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

/// A scene as light transport and the viewport want it: flat lists, indices between them, no files, no nodes.
/// Metres, right-handed, +Y up. All positions are relative to `Scene::origin`, which was subtracted in double, so that
/// a scene a thousand kilometres off the origin keeps its precision. Linear Rec.709 throughout, photometric units.
namespace lightloom {

/// 8-bit image, row 0 at the top. Values are as in the file (sRGB or linear: the use decides).
struct Image {
    std::string name;
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba; ///< width * height * 4
};

/// An image with the sampler and KHR_texture_transform it is used with.
struct Texture {
    enum class Wrap { repeat, clamp, mirror };
    int image = -1; ///< index into Scene::images; -1: no texture, the factor alone counts
    int uvSet = 0;  ///< 0 or 1
    Wrap wrapS = Wrap::repeat, wrapT = Wrap::repeat;
    bool smooth = true; ///< bilinear; false: nearest
    glm::vec2 offset{0.0f}, scale{1.0f};
    float rotation = 0.0f; ///< radians, counter-clockwise
    [[nodiscard]] bool isSet() const { return image >= 0; }
    bool operator==(const Texture&) const = default;
};

/// glTF metallic-roughness without a dielectric layer: diffuse (1 - metallic) (1 - transmission) baseColor / pi; the
/// metallic part is GGX with F0 = baseColor and alpha = roughness^2, a mirror below roughness kMirrorRoughness; the
/// clear part, (1 - metallic) transmission, is smooth glass whatever the roughness says, tinted by baseColor: with a
/// thickness the border of a solid body (its meshes tell the shape, its front is outside), without one a thin pane.
struct Material {
    enum class Alpha { opaque, mask, blend };
    std::string name;
    glm::vec4 baseColor{1.0f};
    Texture baseColorTexture; ///< sRGB; alpha linear
    float metallic = 1.0f, roughness = 1.0f;
    Texture metallicRoughnessTexture; ///< G roughness, B metallic, linear
    Texture normalTexture;            ///< linear; drawing only
    float normalScale = 1.0f;
    glm::vec3 emission{0.0f}; ///< cd/m2: emissiveFactor x KHR_materials_emissive_strength
    Texture emissionTexture;  ///< sRGB
    Alpha alpha = Alpha::opaque;
    float alphaCutoff = 0.5f;
    bool doubleSided = false; ///< drawn from behind, and emits from behind; light reflects on both sides anyway
    float transmission = 0.0f, ior = 1.5f; ///< ior 0: reflects everything
    float thickness = 0.0f;                ///< metres; only whether it is 0 counts
    glm::vec3 attenuationColor{1.0f};      ///< of white light after `attenuationDistance` of solid glass
    float attenuationDistance = 0.0f;      ///< metres; 0: no attenuation
    [[nodiscard]] bool isEmissive() const { return emission.x > 0 || emission.y > 0 || emission.z > 0; }
};
inline constexpr float kMirrorRoughness = 0.05f; ///< below this a metal is a perfect mirror
/// True if some point of the material may be a perfect mirror (a texture of roughness scales it down).
[[nodiscard]] inline bool mayMirror(const Material& m)
{
    const bool isMetal = m.metallic > 0.0f && (m.baseColor.x > 0.0f || m.baseColor.y > 0.0f || m.baseColor.z > 0.0f);
    return isMetal && (m.roughness < kMirrorRoughness || m.metallicRoughnessTexture.isSet());
}
/// True if light gets through some point of the material.
[[nodiscard]] inline bool mayTransmit(const Material& m)
{
    return m.transmission > 0.0f && (m.metallic < 1.0f || m.metallicRoughnessTexture.isSet());
}
inline constexpr float kLargestAlbedo = 0.99f; ///< albedos are clamped here: at 1 light in a closed room never ends

/// Triangles of one material, in the space of the meshes' own node.
struct Mesh {
    std::string name;
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  ///< as many as positions, unit; or none: flat shaded
    std::vector<glm::vec4> tangents; ///< as many as positions (w: handedness); or none
    std::vector<glm::vec2> uv[2];    ///< as many as positions, or none
    std::vector<glm::vec4> colors;   ///< COLOR_0, linear, multiplies baseColor; as many as positions, or none
    std::vector<glm::uvec3> triangles;
    int material = 0; ///< always valid: the reader adds glTF's default material where a file names none
};

/// A mesh in its place.
struct Instance {
    int mesh = 0;
    glm::mat4 toWorld{1.0f}; ///< to scene space; may mirror (negative determinant: winding flips)
    std::string node;        ///< node path, "Room/Lamp"
    int group = -1;          ///< light group if its material emits, else -1
    [[nodiscard]] bool isMirrored() const { return glm::determinant(glm::mat3(toWorld)) < 0.0f; }
};

/// KHR_lights_punctual.
struct PunctualLight {
    enum class Kind { point, spot, directional };
    Kind kind = Kind::point;
    std::string name, node;
    glm::vec3 position{0.0f};
    glm::vec3 travel{0.0f, 0.0f, -1.0f}; ///< unit; the direction its light goes (spot axis, sun)
    glm::vec3 intensity{1.0f};           ///< per channel: candela (point, spot), lux on a facing plane (directional)
    float innerCone = 0.0f, outerCone = 0.785398f; ///< radians from the axis, spot only
    int group = 0;
};

/// Lights that are dimmed, tinted and switched together; each has its own random streams, photon budget and layer.
/// One per punctual light node or emissive mesh node, or all that share `extras.lightloom.group`.
struct LightGroup {
    std::string id;                          ///< node path, `#n` appended where not unique; or the joined name
    std::string label;                       ///< for people
    [[nodiscard]] std::uint64_t key() const; ///< stream key, from id alone
};

struct Camera {
    std::string name;
    glm::vec3 position{0.0f};
    glm::quat orientation{1.0f, 0.0f, 0.0f, 0.0f}; ///< looks along its -Z, +Y up
    float yFov = 0.8f;                             ///< radians
    float nearPlane = 0.01f;                       ///< metres
};

struct Bounds {
    glm::vec3 low{0.0f}, high{0.0f};
    [[nodiscard]] glm::vec3 size() const { return high - low; }
    [[nodiscard]] glm::vec3 centre() const { return 0.5f * (low + high); }
    [[nodiscard]] float diagonal() const { return glm::length(size()); }
    [[nodiscard]] float longestSide() const { return glm::max(size().x, glm::max(size().y, size().z)); }
};

/// Built once, then only read, by any number of threads. A copy with another lamp is cheap: images and meshes are
/// shared.
struct Scene {
    std::string name;
    glm::dvec3 origin{0.0}; ///< added to scene positions gives the file's positions
    SharedList<Image> images;
    std::vector<Material> materials;
    SharedList<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<PunctualLight> lights;
    std::vector<LightGroup> groups;
    std::vector<Camera> cameras;
    std::optional<float> exposureEv;   ///< extras.lightloom.exposure: EV at ISO 100 that suits the scene
    Bounds bounds;                     ///< of all triangles, scene space
    std::vector<std::string> warnings; ///< what was read differently from what the file says, one line each

    [[nodiscard]] glm::vec3 toScene(glm::dvec3 filePosition) const { return glm::vec3(filePosition - origin); }
    [[nodiscard]] glm::dvec3 toFile(glm::vec3 scenePosition) const { return glm::dvec3(scenePosition) + origin; }
};

/// Puts light groups, bounds and clamped albedos in order after meshes, instances and lights have been filled in.
/// `groupNames[i]` (extras.lightloom.group of instance i, then of light i - instances) joins groups; "" joins nothing.
/// Recentring is the reader's: it happens in double, before positions become float.
void finishScene(Scene& scene, const std::vector<std::string>& groupNames);

/// SHA-256 over everything that light depends on (geometry, materials, lamps, groups), names of meshes left out.
[[nodiscard]] Sha256::Digest sceneHash(const Scene& scene);
/// The same without the lamps: punctual lights, what glows and how bright, light groups. Scenes with equal ones differ
/// in their lamps only; a lamp's mesh is surface.
[[nodiscard]] Sha256::Digest surfaceHash(const Scene& scene);
/// SHA-256 over what the photons of one light group depend on beside the surface: its number and id, and its lamps.
[[nodiscard]] Sha256::Digest lampHash(const Scene& scene, int group);
/// True if `a` and `b` surely have the same surface, found without looking at meshes and images: one is an edit of the
/// other. False says nothing.
[[nodiscard]] bool isSameSurface(const Scene& a, const Scene& b);

/// Gain per light group and channel; what the light mixer sets. Linear: 1 is the lamp as baked, 0 is off.
using Mix = std::vector<glm::vec3>;
/// Gain of a group; groups that `mix` does not name are as baked.
[[nodiscard]] inline glm::vec3 gainOf(const Mix& mix, int group)
{
    const auto g = static_cast<std::size_t>(group);
    return g < mix.size() ? mix[g] : glm::vec3(1.0f);
}
/// True if the group is off in `mix`.
[[nodiscard]] inline bool isOff(const Mix& mix, int group) { return gainOf(mix, group) == glm::vec3(0.0f); }

} // namespace lightloom
