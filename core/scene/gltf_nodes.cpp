// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf_nodes.h"
#include "core/scene/gltf_json.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <map>
#include <set>
#include <tiny_gltf.h>

namespace lightloom {
namespace {

constexpr const char* kLampExtension = "KHR_lights_punctual";

glm::dvec3 vec3Of(const std::vector<double>& v, glm::dvec3 otherwise)
{
    return v.size() == 3 ? glm::dvec3(v[0], v[1], v[2]) : otherwise;
}

glm::dmat4 localTransform(const tinygltf::Node& node, GltfWarnings& warnings)
{
    glm::dmat4 m(1.0);
    if (node.matrix.size() == 16) {
        for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)]; // both by columns
        return m;
    }
    if (node.rotation.size() == 4) {
        const glm::dvec4 q(node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]);
        const double length = glm::length(q);
        if (length > 1e-12) {
            m = glm::mat4_cast(glm::dquat(q.w / length, q.x / length, q.y / length, q.z / length));
        } else {
            warnings.add("rotations of length 0 are taken as none");
        }
    }
    const glm::dvec3 scale = vec3Of(node.scale, glm::dvec3(1.0));
    for (int c = 0; c < 3; ++c) m[c] *= scale[c];
    m[3] = glm::dvec4(vec3Of(node.translation, glm::dvec3(0.0)), 1.0);
    return m;
}

bool isFinite(const glm::dmat4& m)
{
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) {
            if (!(std::abs(m[c][r]) <= static_cast<double>(std::numeric_limits<float>::max()))) return false;
        }
    }
    return true;
}

/// Node paths, each given once.
class Paths {
public:
    std::string add(const std::string& parent, const std::string& name)
    {
        std::string path = parent.empty() ? name : parent + "/" + name;
        constexpr std::size_t kMost = 1000; // deep towers of long names would cost memory without end
        if (path.size() > kMost) path = plainName(".../" + name);
        std::string unique = path;
        int& last = lastNumber_.try_emplace(path, 1).first->second;
        while (!taken_.insert(unique).second) unique = fmt::format("{}#{}", path, ++last);
        return unique;
    }

private:
    std::set<std::string> taken_;
    std::map<std::string, int> lastNumber_; ///< so that ten thousand equal names do not try each other's numbers
};

std::vector<int> rootsOf(const tinygltf::Model& model)
{
    if (!model.scenes.empty()) return model.scenes[static_cast<std::size_t>(std::max(model.defaultScene, 0))].nodes;
    std::vector<bool> isChild(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes) {
        for (const int child : node.children) isChild[static_cast<std::size_t>(child)] = true;
    }
    std::vector<int> roots;
    for (std::size_t i = 0; i < isChild.size(); ++i) {
        if (!isChild[i]) roots.push_back(static_cast<int>(i));
    }
    return roots;
}

/// A direction of the node's own space in the world; zero where the node is scaled to nothing.
glm::dvec3 direction(const glm::dmat4& toWorld, glm::dvec3 own)
{
    const glm::dvec3 d(toWorld * glm::dvec4(own, 0.0));
    const double length = glm::length(d);
    return length > 0.0 ? d / length : glm::dvec3(0.0);
}

} // namespace

Result<std::vector<PlacedNode>> placeNodes(const tinygltf::Model& model, GltfWarnings& warnings)
{
    struct Open {
        int node;
        std::string parentPath;
        glm::dmat4 parentToWorld;
    };
    Paths paths;
    std::vector<PlacedNode> placed;
    std::vector<Open> open;
    const auto push = [&](const std::vector<int>& nodes, const std::string& path, const glm::dmat4& toWorld) {
        for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) open.push_back({*it, path, toWorld});
    };
    push(rootsOf(model), "", glm::dmat4(1.0));
    while (!open.empty()) {
        const Open next = std::move(open.back());
        open.pop_back();
        const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(next.node)];
        PlacedNode here;
        here.node = next.node;
        here.path =
            paths.add(next.parentPath, node.name.empty() ? fmt::format("node{}", next.node) : plainName(node.name));
        here.group = plainName(lightloomText(node.extras, "group"));
        here.toWorld = next.parentToWorld * localTransform(node, warnings);
        if (!isFinite(here.toWorld)) {
            return Error{Error::Kind::badInput, fmt::format("node \"{}\": its place is not finite", here.path)};
        }
        push(node.children, here.path, here.toWorld);
        placed.push_back(std::move(here));
    }
    return placed;
}

bool readLamp(const tinygltf::Model& model, const PlacedNode& placed, PunctualLight& lamp, glm::dvec3& at,
              GltfWarnings& warnings)
{
    const auto& onNode = model.nodes[static_cast<std::size_t>(placed.node)].extensions;
    const auto reference = onNode.find(kLampExtension);
    const auto list = model.extensions.find(kLampExtension);
    if (reference == onNode.end() || list == model.extensions.end()) return false;
    const double number = gltfNumber(reference->second, "light", -1.0);
    if (!(number >= 0.0)) return false;
    const tinygltf::Value& from = list->second.Get("lights").Get(static_cast<int>(number));

    lamp.node = placed.path;
    lamp.name = from.Has("name") && from.Get("name").IsString() ? plainName(from.Get("name").Get<std::string>()) : "";
    if (lamp.name.empty()) lamp.name = placed.path.substr(placed.path.rfind('/') + 1);
    const std::string& type = from.Get("type").Get<std::string>();
    lamp.kind = type == "point"  ? PunctualLight::Kind::point
                : type == "spot" ? PunctualLight::Kind::spot
                                 : PunctualLight::Kind::directional;
    const double intensity = gltfNumber(from, "intensity", 1.0);
    const tinygltf::Value& colour = from.Get("color");
    for (int c = 0; c < 3; ++c) {
        const double channel = colour.IsArray() ? colour.Get(c).GetNumberAsDouble() : 1.0;
        lamp.intensity[c] = static_cast<float>(std::min(intensity * channel, 1e30));
    }
    if (from.Has("range")) warnings.add("the range of lamps is ignored: light falls off with distance alone");
    if (lamp.kind == PunctualLight::Kind::spot) {
        const tinygltf::Value& spot = from.Get("spot");
        lamp.innerCone = static_cast<float>(gltfNumber(spot, "innerConeAngle", 0.0));
        lamp.outerCone = static_cast<float>(gltfNumber(spot, "outerConeAngle", 0.78539816339744831));
        if (!(lamp.innerCone < lamp.outerCone)) {
            warnings.add("spots whose inner cone is not inside the outer one get a sharp edge at the outer one");
            lamp.outerCone = std::max(lamp.outerCone, 1e-3f);
            lamp.innerCone = 0.999f * lamp.outerCone;
        }
    }
    const glm::dvec3 travel = direction(placed.toWorld, {0.0, 0.0, -1.0});
    if (lamp.kind != PunctualLight::Kind::point && travel == glm::dvec3(0.0)) {
        warnings.add(fmt::format("the lamp \"{}\" is left out: its node is scaled to nothing", placed.path));
        return false;
    }
    if (travel != glm::dvec3(0.0)) lamp.travel = glm::vec3(travel);
    at = glm::dvec3(placed.toWorld[3]);
    return true;
}

bool readCamera(const tinygltf::Model& model, const PlacedNode& placed, Camera& camera, glm::dvec3& at,
                GltfWarnings& warnings)
{
    const int index = model.nodes[static_cast<std::size_t>(placed.node)].camera;
    if (index < 0) return false;
    const tinygltf::Camera& from = model.cameras[static_cast<std::size_t>(index)];
    if (from.type != "perspective") {
        warnings.add("cameras without perspective are ignored");
        return false;
    }
    const glm::dvec3 back = direction(placed.toWorld, {0.0, 0.0, 1.0});
    const glm::dvec3 right = glm::cross(direction(placed.toWorld, {0.0, 1.0, 0.0}), back);
    if (!(glm::length(right) > 1e-9)) {
        warnings.add(fmt::format("the camera at \"{}\" is left out: its node is scaled to nothing", placed.path));
        return false;
    }
    // built from two axes: a mirrored or skewed node still gives a rotation
    const glm::dvec3 x = glm::normalize(right), y = glm::cross(back, x);
    camera.orientation = glm::quat(glm::normalize(glm::quat_cast(glm::dmat3(x, y, back))));
    const std::string leaf = placed.path.substr(placed.path.rfind('/') + 1);
    const std::string& nodeName = model.nodes[static_cast<std::size_t>(placed.node)].name;
    camera.name = !nodeName.empty() || from.name.empty() ? leaf : plainName(from.name);
    camera.yFov = static_cast<float>(from.perspective.yfov);
    if (from.perspective.znear > 0.0) camera.nearPlane = static_cast<float>(from.perspective.znear);
    at = glm::dvec3(placed.toWorld[3]);
    return true;
}

} // namespace lightloom
