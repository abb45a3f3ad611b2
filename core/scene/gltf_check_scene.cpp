// SPDX-License-Identifier: Apache-2.0
// Everything that is not bytes: nodes and scenes, lamps and cameras, materials and their textures.
#include "core/scene/gltf_check_parts.h"
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace lightloom::detail {
namespace {

constexpr double kAny = std::numeric_limits<float>::max(); ///< any number a float holds
constexpr const char* kLampExtension = "KHR_lights_punctual";

const Json& lampList(const GltfFile& file)
{
    const JsonObject root(file.root, "glTF", -1, file.faults);
    return root.object("extensions").object(kLampExtension).array("lights", file.limits.entries);
}

/// Sets `parents` and finds a second parent; a node under two parents would stand in two places, or in its own shadow.
void findParents(const GltfFile& file, std::vector<std::int64_t>& parents)
{
    for (std::uint64_t i = 0; i < parents.size(); ++i) {
        const JsonObject node = file.entry("nodes", i);
        for (const Json& child : node.array("children", file.limits.entries)) {
            const double at = child.is_number() ? child.get<double>() : -1.0;
            if (!(at >= 0.0 && at < static_cast<double>(parents.size()) && at == std::floor(at))) {
                node.fault("children names a node that does not exist");
                return;
            }
            std::int64_t& parent = parents[static_cast<std::size_t>(at)];
            if (parent >= 0) {
                node.fault(fmt::format("nodes[{}] is already a child of nodes[{}]", at, parent));
                return;
            }
            parent = static_cast<std::int64_t>(i);
        }
    }
}

/// Walks up from each node. With one parent each, more steps than the limit means a cycle or a tower.
void checkDepths(const GltfFile& file, const std::vector<std::int64_t>& parents)
{
    for (std::size_t i = 0; i < parents.size(); ++i) {
        int steps = 0;
        for (std::int64_t at = parents[i]; at >= 0; at = parents[static_cast<std::size_t>(at)]) {
            if (at == static_cast<std::int64_t>(i)) {
                file.entry("nodes", i).fault("it is its own ancestor");
                return;
            }
            if (++steps > file.limits.nodeDepth) {
                file.entry("nodes", i).fault(fmt::format("it lies more than {} levels deep", file.limits.nodeDepth));
                return;
            }
        }
    }
}

void checkScenes(const GltfFile& file, const std::vector<std::int64_t>& parents)
{
    std::vector<std::uint64_t> seenIn(parents.size(), 0); // number of the scene that last named the node, from 1
    for (std::uint64_t s = 0; s < file.size("scenes"); ++s) {
        const JsonObject scene = file.entry("scenes", s);
        static_cast<void>(scene.text("name"));
        for (const Json& root : scene.array("nodes", file.limits.entries)) {
            const double at = root.is_number() ? root.get<double>() : -1.0;
            if (!(at >= 0.0 && at < static_cast<double>(parents.size()) && at == std::floor(at))) {
                scene.fault("nodes names a node that does not exist");
                return;
            }
            const auto index = static_cast<std::size_t>(at);
            if (parents[index] >= 0) scene.fault(fmt::format("nodes[{}] is no root: it has a parent", index));
            if (seenIn[index] == s + 1) scene.fault(fmt::format("nodes[{}] occurs twice", index));
            seenIn[index] = s + 1;
        }
    }
    const JsonObject root(file.root, "glTF", -1, file.faults);
    static_cast<void>(root.index("scene", "scenes", file.size("scenes")));
}

void checkTextureInfo(const GltfFile& file, const JsonObject& owner, const char* key)
{
    if (!owner.has(key)) return;
    const JsonObject info = owner.object(key);
    if (!info.has("index")) info.fault("index is missing");
    static_cast<void>(info.index("index", "textures", file.size("textures")));
    static_cast<void>(info.whole("texCoord", 1000));
    info.numbers("scale", 0, -kAny, kAny); // of a normal texture
    const JsonObject transform = info.object("extensions").object("KHR_texture_transform");
    transform.numbers("offset", 2, -kAny, kAny);
    transform.numbers("scale", 2, -kAny, kAny);
    transform.numbers("rotation", 0, -kAny, kAny);
    static_cast<void>(transform.whole("texCoord", 1000));
}

void checkMaterial(const GltfFile& file, const JsonObject& material)
{
    static_cast<void>(material.text("name"));
    material.flag("doubleSided");
    const std::string alpha = material.text("alphaMode");
    if (!alpha.empty() && alpha != "OPAQUE" && alpha != "MASK" && alpha != "BLEND") {
        material.fault(fmt::format("alphaMode \"{}\" is unknown", plainName(alpha)));
    }
    material.numbers("alphaCutoff", 0, 0.0, kAny);
    material.numbers("emissiveFactor", 3, 0.0, kAny);
    for (const char* key : {"normalTexture", "occlusionTexture", "emissiveTexture"}) {
        checkTextureInfo(file, material, key);
    }
    const JsonObject pbr = material.object("pbrMetallicRoughness");
    pbr.numbers("baseColorFactor", 4, 0.0, kAny);
    pbr.numbers("metallicFactor", 0, 0.0, 1.0);
    pbr.numbers("roughnessFactor", 0, 0.0, 1.0);
    checkTextureInfo(file, pbr, "baseColorTexture");
    checkTextureInfo(file, pbr, "metallicRoughnessTexture");
    const JsonObject extensions = material.object("extensions");
    extensions.object("KHR_materials_emissive_strength").numbers("emissiveStrength", 0, 0.0, kAny);
    extensions.object("KHR_materials_transmission").numbers("transmissionFactor", 0, 0.0, 1.0);
    extensions.object("KHR_materials_ior").numbers("ior", 0, 0.0, 1000.0);
    const JsonObject volume = extensions.object("KHR_materials_volume");
    volume.numbers("thicknessFactor", 0, 0.0, kAny);
    volume.numbers("attenuationDistance", 0, 0.0, kAny);
    volume.numbers("attenuationColor", 3, 0.0, 1.0);
}

void checkLamp(const JsonObject& lamp)
{
    static_cast<void>(lamp.text("name"));
    const std::string type = lamp.text("type");
    if (type != "point" && type != "spot" && type != "directional") {
        lamp.fault(fmt::format("type \"{}\" is not one of point, spot, directional", plainName(type)));
    }
    lamp.numbers("color", 3, 0.0, kAny);
    lamp.numbers("intensity", 0, 0.0, kAny);
    lamp.numbers("range", 0, 0.0, kAny);
    constexpr double kRightAngle = 1.5707964; // pi / 2 rounded up to float
    const JsonObject spot = lamp.object("spot");
    spot.numbers("innerConeAngle", 0, 0.0, kRightAngle);
    spot.numbers("outerConeAngle", 0, 0.0, kRightAngle);
}

} // namespace

void checkNodes(const GltfFile& file)
{
    const std::uint64_t lamps = lampList(file).size();
    for (std::uint64_t i = 0; i < file.size("nodes") && !file.faults.any(); ++i) {
        const JsonObject node = file.entry("nodes", i);
        static_cast<void>(node.text("name"));
        static_cast<void>(node.index("mesh", "meshes", file.size("meshes")));
        static_cast<void>(node.index("camera", "cameras", file.size("cameras")));
        node.numbers("matrix", 16, -kAny, kAny);
        node.numbers("translation", 3, -kAny, kAny);
        node.numbers("rotation", 4, -kAny, kAny);
        node.numbers("scale", 3, -kAny, kAny);
        const JsonObject lamp = node.object("extensions").object(kLampExtension);
        static_cast<void>(lamp.index("light", "lights", lamps));
    }
    if (file.faults.any()) return;
    std::vector<std::int64_t> parents(file.size("nodes"), -1);
    findParents(file, parents);
    if (!file.faults.any()) checkDepths(file, parents);
    if (!file.faults.any()) checkScenes(file, parents);
}

void checkLampsAndCameras(const GltfFile& file)
{
    std::int64_t number = 0;
    for (const Json& lamp : lampList(file)) checkLamp(JsonObject(lamp, "lights", number++, file.faults));
    for (std::uint64_t i = 0; i < file.size("cameras"); ++i) {
        const JsonObject camera = file.entry("cameras", i);
        static_cast<void>(camera.text("name"));
        if (camera.text("type") != "perspective") continue;
        const JsonObject lens = camera.object("perspective");
        if (!lens.has("yfov")) lens.fault("yfov is missing");
        lens.numbers("yfov", 0, 1e-4, 3.1415);
        lens.numbers("znear", 0, 0.0, kAny);
    }
}

void checkMaterials(const GltfFile& file)
{
    for (std::uint64_t i = 0; i < file.size("textures"); ++i) {
        const JsonObject texture = file.entry("textures", i);
        static_cast<void>(texture.index("source", "images", file.size("images")));
        static_cast<void>(texture.index("sampler", "samplers", file.size("samplers")));
    }
    for (std::uint64_t i = 0; i < file.size("samplers"); ++i) {
        const JsonObject sampler = file.entry("samplers", i);
        static_cast<void>(sampler.whole("magFilter", 1 << 16));
        for (const char* key : {"wrapS", "wrapT"}) {
            const auto mode = sampler.whole(key, 1 << 16);
            if (mode && *mode != 10497 && *mode != 33071 && *mode != 33648) {
                sampler.fault(fmt::format("{} {} is unknown", key, *mode));
            }
        }
    }
    for (std::uint64_t i = 0; i < file.size("materials") && !file.faults.any(); ++i) {
        checkMaterial(file, file.entry("materials", i));
    }
}

} // namespace lightloom::detail
