// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.h"
#include "core/base/rng.h"
#include "core/base/units.h"
#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <set>

namespace lightloom {
namespace {

Bounds boundsOf(const Scene& scene)
{
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
        for (const glm::uvec3 t : mesh.triangles) {
            for (const unsigned v : {t.x, t.y, t.z}) {
                const glm::vec3 p(instance.toWorld * glm::vec4(mesh.positions[v], 1.0f));
                low = glm::min(low, p);
                high = glm::max(high, p);
            }
        }
    }
    if (low.x > high.x) return {};
    return {low, high};
}

/// Diffuse and metallic reflectance share the base colour: clamping it clamps both. Textures are clamped at lookup.
void clampAlbedos(Scene& scene)
{
    for (Material& material : scene.materials) {
        // clear glass takes nothing: what meets it finds its way out by itself
        if (material.transmission >= 1.0f && material.metallic <= 0.0f) continue;
        glm::vec4& c = material.baseColor;
        const glm::vec4 clamped(glm::clamp(glm::vec3(c.x, c.y, c.z), 0.0f, kLargestAlbedo), c.w);
        const float most = maxChannel({c.x, c.y, c.z});
        // 1 with a texture is the ordinary factor, not a white wall
        if (most > kLargestAlbedo && !(material.baseColorTexture.isSet() && most <= 1.0f)) {
            scene.warnings.push_back(
                fmt::format("material \"{}\": reflects {:.3g}, taken as {}", material.name, most, kLargestAlbedo));
        }
        if (!material.baseColorTexture.isSet() && !mayTransmit(material))
            c = clamped; // else at lookup: the tint is not
    }
}

class GroupMaker {
public:
    explicit GroupMaker(Scene& scene) : scene_(scene) {}

    int of(const std::string& joined, const std::string& node, const std::string& label)
    {
        if (!joined.empty()) {
            const auto found = joined_.find(joined);
            if (found != joined_.end()) return found->second;
            return joined_[joined] = add(joined, joined);
        }
        return add(node, label.empty() ? node : label);
    }

private:
    int add(const std::string& wanted, const std::string& label)
    {
        std::string id = wanted;
        for (int n = 2; !ids_.insert(id).second; ++n) id = fmt::format("{}#{}", wanted, n);
        scene_.groups.push_back({id, label});
        return static_cast<int>(scene_.groups.size()) - 1;
    }

    Scene& scene_;
    std::map<std::string, int> joined_;
    std::set<std::string> ids_;
};

} // namespace

std::uint64_t LightGroup::key() const { return hashName(id); }

void finishScene(Scene& scene, const std::vector<std::string>& groupNames)
{
    scene.groups.clear();
    GroupMaker groups(scene);
    const auto joined = [&](std::size_t i) { return i < groupNames.size() ? groupNames[i] : std::string(); };
    std::map<std::string, int> ofNode; // the primitives of one node glow together
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        Instance& instance = scene.instances[i];
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
        instance.group = -1;
        if (!scene.materials[static_cast<std::size_t>(mesh.material)].isEmissive()) continue;
        const auto known = ofNode.find(instance.node);
        if (known != ofNode.end() && joined(i).empty()) {
            instance.group = known->second;
            continue;
        }
        const std::string leaf = instance.node.substr(instance.node.rfind('/') + 1);
        instance.group = groups.of(joined(i), instance.node, leaf);
        if (joined(i).empty()) ofNode[instance.node] = instance.group;
    }
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        PunctualLight& light = scene.lights[i];
        const std::string leaf = light.node.substr(light.node.rfind('/') + 1);
        light.group = groups.of(joined(scene.instances.size() + i), light.node, leaf.empty() ? light.name : leaf);
    }
    clampAlbedos(scene);
    scene.bounds = boundsOf(scene);
}

} // namespace lightloom
