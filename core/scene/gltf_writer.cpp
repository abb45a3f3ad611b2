// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf_writer.h"
#include "core/base/atomic_file.h"
#include "core/base/units.h"
#include "core/scene/glb_buffer.h"
#include "core/scene/png_bytes.h"
#include <array>
#include <charconv>
#include <fmt/format.h>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace lightloom {
namespace {

using nlohmann::json;

/// The double whose decimal form is the shortest one that names `value`: 0.1f is written as 0.1, and reads back as it.
double tidy(float value)
{
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    double wide = 0.0;
    std::from_chars(text.data(), end, wide);
    return wide;
}
json array(glm::vec2 v) { return {tidy(v.x), tidy(v.y)}; }
json array(glm::vec3 v) { return {tidy(v.x), tidy(v.y), tidy(v.z)}; }
json array(glm::vec4 v) { return {tidy(v.x), tidy(v.y), tidy(v.z), tidy(v.w)}; }
json array(const glm::dquat& q) { return {q.x, q.y, q.z, q.w}; }

/// Colour with a largest channel of 1, times a strength; ratios in double, so that their product gives the float back.
json colourOf(glm::vec3 value, float strength)
{
    const double s = strength > 0.0f ? static_cast<double>(strength) : 1.0;
    return {double(value.x) / s, double(value.y) / s, double(value.z) / s};
}

/// Turns -Z into `travel`.
glm::dquat aim(glm::dvec3 travel)
{
    travel = glm::normalize(travel);
    const glm::dvec3 from(0.0, 0.0, -1.0);
    if (travel.z >= 1.0 - 1e-12) return {0.0, 0.0, 1.0, 0.0}; // about turn, any axis across will do
    return glm::normalize(glm::dquat(1.0 + glm::dot(from, travel), glm::cross(from, travel)));
}

class Writer {
public:
    Writer(const Scene& scene, const GltfLightmap* lightmap) : scene_(scene), lightmap_(lightmap) {}

    Result<std::vector<std::uint8_t>> write()
    {
        for (const Image& image : scene_.images) {
            if (const Result<Done> added = addImage(image); !added) return added.error();
        }
        if (lightmap_) {
            if (const Result<Done> added = addImage(lightmap_->image); !added) return added.error();
        }
        for (const Material& material : scene_.materials) materials_.push_back(materialOf(material));
        findJoinedGroups();
        addInstances();
        for (const PunctualLight& light : scene_.lights) addLight(light);
        for (const Camera& camera : scene_.cameras) addCamera(camera);
        return pack(document().dump());
    }

private:
    static void nameIt(json& object, const std::string& name)
    {
        if (!name.empty()) object["name"] = name;
    }

    // --- materials

    Result<Done> addImage(const Image& image)
    {
        const Result<std::vector<std::uint8_t>> png = pngBytes(image);
        if (!png) return png.error();
        images_.push_back({{"mimeType", "image/png"}, {"bufferView", buffer_.addBlob(*png)}});
        nameIt(images_.back(), image.name);
        return Done{};
    }

    int samplerOf(const Texture& t)
    {
        static constexpr std::array<int, 3> kWrap{10497, 33071, 33648}; // GL: repeat, clamp to edge, mirrored repeat
        const json sampler{{"wrapS", kWrap[static_cast<std::size_t>(t.wrapS)]},
                           {"wrapT", kWrap[static_cast<std::size_t>(t.wrapT)]},
                           {"magFilter", t.smooth ? 9729 : 9728},
                           {"minFilter", t.smooth ? 9987 : 9728}};
        return indexOf(samplers_, sampler);
    }

    json textureOf(const Texture& t)
    {
        json info{{"index", indexOf(textures_, {{"source", t.image}, {"sampler", samplerOf(t)}})}};
        if (t.uvSet != 0) info["texCoord"] = t.uvSet + (lightmap_ ? 1 : 0);
        json transform = json::object();
        if (t.offset != glm::vec2(0.0f)) transform["offset"] = array(t.offset);
        if (t.scale != glm::vec2(1.0f)) transform["scale"] = array(t.scale);
        if (t.rotation != 0.0f) transform["rotation"] = tidy(t.rotation);
        if (!transform.empty()) info["extensions"]["KHR_texture_transform"] = use("KHR_texture_transform", transform);
        return info;
    }

    /// Number of `entry` in `list`, added if it is new.
    static int indexOf(json& list, const json& entry)
    {
        for (std::size_t i = 0; i < list.size(); ++i) {
            if (list[i] == entry) return static_cast<int>(i);
        }
        list.push_back(entry);
        return static_cast<int>(list.size()) - 1;
    }

    json use(const char* extension, json content)
    {
        extensions_.insert(extension);
        return content;
    }

    json materialOf(const Material& m)
    {
        json out{
            {"pbrMetallicRoughness", {{"metallicFactor", tidy(m.metallic)}, {"roughnessFactor", tidy(m.roughness)}}}};
        nameIt(out, m.name);
        json& pbr = out["pbrMetallicRoughness"];
        if (m.baseColor != glm::vec4(1.0f)) pbr["baseColorFactor"] = array(m.baseColor);
        if (m.baseColorTexture.isSet()) pbr["baseColorTexture"] = textureOf(m.baseColorTexture);
        if (m.metallicRoughnessTexture.isSet()) {
            pbr["metallicRoughnessTexture"] = textureOf(m.metallicRoughnessTexture);
        }
        if (m.normalTexture.isSet()) {
            out["normalTexture"] = textureOf(m.normalTexture);
            out["normalTexture"]["scale"] = tidy(m.normalScale);
        }
        if (m.emissionTexture.isSet()) out["emissiveTexture"] = textureOf(m.emissionTexture);
        if (m.doubleSided) out["doubleSided"] = true;
        if (m.alpha != Material::Alpha::opaque) {
            out["alphaMode"] = m.alpha == Material::Alpha::mask ? "MASK" : "BLEND";
        }
        if (m.alpha == Material::Alpha::mask) out["alphaCutoff"] = tidy(m.alphaCutoff);
        addEmission(m, out);
        addGlass(m, out);
        addLightmap(out);
        return out;
    }

    /// No mip levels: from the third on charts would run into each other.
    void addLightmap(json& out)
    {
        if (!lightmap_) return;
        const json sampler{{"wrapS", 33071}, {"wrapT", 33071}, {"magFilter", 9729}, {"minFilter", 9729}};
        const json texture{{"source", images_.size() - 1}, {"sampler", indexOf(samplers_, sampler)}};
        out["extensions"]["MOZ_lightmap"] =
            use("MOZ_lightmap",
                {{"index", indexOf(textures_, texture)}, {"texCoord", 1}, {"intensity", tidy(lightmap_->intensity)}});
    }

    void addEmission(const Material& m, json& out)
    {
        if (!m.isEmissive()) return;
        const float strength = maxChannel(m.emission);
        if (strength <= 1.0f) { // fits the core format
            out["emissiveFactor"] = array(m.emission);
            return;
        }
        out["emissiveFactor"] = colourOf(m.emission, strength);
        out["extensions"]["KHR_materials_emissive_strength"] =
            use("KHR_materials_emissive_strength", {{"emissiveStrength", tidy(strength)}});
    }

    void addGlass(const Material& m, json& out)
    {
        const Material plain;
        if (m.transmission > 0.0f) {
            out["extensions"]["KHR_materials_transmission"] =
                use("KHR_materials_transmission", {{"transmissionFactor", tidy(m.transmission)}});
        }
        if (m.ior != plain.ior) {
            out["extensions"]["KHR_materials_ior"] = use("KHR_materials_ior", {{"ior", tidy(m.ior)}});
        }
        if (m.thickness <= 0.0f) return;
        json volume{{"thicknessFactor", tidy(m.thickness)}, {"attenuationColor", array(m.attenuationColor)}};
        if (m.attenuationDistance > 0.0f) volume["attenuationDistance"] = tidy(m.attenuationDistance);
        out["extensions"]["KHR_materials_volume"] = use("KHR_materials_volume", volume);
    }

    // --- nodes

    /// Adds a node at `path`, whose parents are plain nodes without a transform.
    void addNode(const std::string& path, json node)
    {
        const std::size_t slash = path.rfind('/');
        nameIt(node, slash == std::string::npos ? path : path.substr(slash + 1));
        const int parent = slash == std::string::npos ? -1 : folder(path.substr(0, slash));
        nodes_.push_back(std::move(node));
        attach(parent, static_cast<int>(nodes_.size()) - 1);
    }

    int folder(const std::string& path)
    {
        const auto known = folders_.find(path);
        if (known != folders_.end()) return known->second;
        const std::size_t slash = path.rfind('/');
        const int parent = slash == std::string::npos ? -1 : folder(path.substr(0, slash));
        json node = json::object();
        nameIt(node, slash == std::string::npos ? path : path.substr(slash + 1));
        nodes_.push_back(std::move(node));
        const int index = static_cast<int>(nodes_.size()) - 1;
        attach(parent, index);
        return folders_[path] = index;
    }

    void attach(int parent, int child)
    {
        if (parent < 0)
            roots_.push_back(child);
        else
            nodes_[static_cast<std::size_t>(parent)]["children"].push_back(child);
    }

    void moveTo(json& node, glm::vec3 position) const
    {
        if (scene_.origin == glm::dvec3(0.0)) {
            if (position != glm::vec3(0.0f)) node["translation"] = array(position);
            return;
        }
        const glm::dvec3 p = scene_.toFile(position);
        node["translation"] = {p.x, p.y, p.z};
    }

    void transform(json& node, const glm::mat4& m) const
    {
        glm::mat4 rest = m;
        rest[3] = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
        const glm::vec3 position(m[3].x, m[3].y, m[3].z);
        if (rest == glm::mat4(1.0f)) {
            moveTo(node, position);
            return;
        }
        json matrix = json::array();
        for (int c = 0; c < 3; ++c) {
            for (int r = 0; r < 4; ++r) matrix.push_back(tidy(m[c][r]));
        }
        for (int k = 0; k < 3; ++k) {
            const bool moved = scene_.origin[k] != 0.0;
            matrix.push_back(moved ? double(position[k]) + scene_.origin[k] : tidy(position[k]));
        }
        matrix.push_back(1.0);
        node["matrix"] = matrix;
    }

    /// A group is joined (by `extras.lightloom.group`) if its id is not the path of all its lamps.
    void findJoinedGroups()
    {
        joined_.assign(scene_.groups.size(), false);
        const auto look = [&](int group, const std::string& node) {
            if (group < 0) return;
            const std::string& id = scene_.groups[static_cast<std::size_t>(group)].id;
            const bool own = id == node || id.rfind(node + "#", 0) == 0; // "#2": the path alone was taken
            if (!own) joined_[static_cast<std::size_t>(group)] = true;
        };
        for (const Instance& instance : scene_.instances) look(instance.group, instance.node);
        for (const PunctualLight& light : scene_.lights) look(light.group, light.node);
    }

    void nameGroup(json& node, int group) const
    {
        if (group < 0 || !joined_[static_cast<std::size_t>(group)]) return;
        node["extras"]["lightloom"]["group"] = scene_.groups[static_cast<std::size_t>(group)].id;
    }

    void addInstances()
    {
        const std::vector<Instance>& all = scene_.instances;
        for (std::size_t first = 0, last; first < all.size(); first = last) {
            std::vector<int> parts;
            int group = -1;
            for (last = first; last < all.size(); ++last) { // primitives of one node stand one after another
                const Instance& next = all[last];
                if (next.node != all[first].node || next.toWorld != all[first].toWorld) break;
                if (group >= 0 && next.group >= 0 && next.group != group) break;
                if (next.group >= 0) group = next.group;
                if (!scene_.meshes[static_cast<std::size_t>(next.mesh)].triangles.empty()) parts.push_back(next.mesh);
            }
            if (parts.empty()) continue;
            json node{{"mesh", meshOf(parts)}};
            transform(node, all[first].toWorld);
            nameGroup(node, group);
            addNode(all[first].node, std::move(node));
        }
    }

    int meshOf(const std::vector<int>& parts)
    {
        const auto known = meshOf_.find(parts);
        if (known != meshOf_.end()) return known->second;
        json mesh;
        nameIt(mesh, scene_.meshes[static_cast<std::size_t>(parts.front())].name);
        for (const int part : parts) mesh["primitives"].push_back(primitiveOf(part));
        meshes_.push_back(mesh);
        return meshOf_[parts] = static_cast<int>(meshes_.size()) - 1;
    }

    const json& primitiveOf(int index)
    {
        json& primitive = primitives_[index];
        if (!primitive.is_null()) return primitive;
        const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(index)];
        json attributes{{"POSITION", buffer_.addPositions(mesh.positions)}};
        if (!mesh.normals.empty()) attributes["NORMAL"] = buffer_.addFloats(mesh.normals);
        if (!mesh.tangents.empty()) attributes["TANGENT"] = buffer_.addFloats(mesh.tangents);
        if (!mesh.uv[0].empty()) attributes["TEXCOORD_0"] = buffer_.addFloats(mesh.uv[0]);
        const char* second = "TEXCOORD_1";
        if (lightmap_) {
            attributes["TEXCOORD_1"] = buffer_.addFloats(lightmap_->uv[static_cast<std::size_t>(index)]);
            if (mesh.uv[0].empty()) attributes["TEXCOORD_0"] = attributes["TEXCOORD_1"]; // sets count on from 0
            second = "TEXCOORD_2";
        }
        if (!mesh.uv[1].empty()) attributes[second] = buffer_.addFloats(mesh.uv[1]);
        if (!mesh.colors.empty()) attributes["COLOR_0"] = buffer_.addFloats(mesh.colors);
        primitive = {{"attributes", attributes},
                     {"indices", buffer_.addTriangles(mesh.triangles, mesh.positions.size())},
                     {"material", mesh.material}};
        return primitive;
    }

    void addLight(const PunctualLight& light)
    {
        static constexpr std::array kTypes{"point", "spot", "directional"};
        const float strength = maxChannel(light.intensity);
        json entry{{"type", kTypes[static_cast<std::size_t>(light.kind)]},
                   {"color", colourOf(light.intensity, strength)},
                   {"intensity", tidy(strength)}};
        nameIt(entry, light.name);
        if (light.kind == PunctualLight::Kind::spot) {
            entry["spot"] = {{"innerConeAngle", tidy(light.innerCone)}, {"outerConeAngle", tidy(light.outerCone)}};
        }
        json node;
        node["extensions"]["KHR_lights_punctual"]["light"] = lights_.size();
        lights_.push_back(use("KHR_lights_punctual", entry));
        moveTo(node, light.position);
        if (light.kind != PunctualLight::Kind::point) node["rotation"] = array(aim(light.travel));
        nameGroup(node, light.group);
        addNode(light.node, std::move(node));
    }

    void addCamera(const Camera& camera)
    {
        json entry{{"type", "perspective"},
                   {"perspective", {{"yfov", tidy(camera.yFov)}, {"znear", tidy(camera.nearPlane)}}}};
        nameIt(entry, camera.name);
        json node{{"camera", cameras_.size()}};
        cameras_.push_back(entry);
        moveTo(node, camera.position);
        const glm::quat q = camera.orientation;
        node["rotation"] = array(glm::vec4(q.x, q.y, q.z, q.w));
        nameIt(node, camera.name); // a camera's name is no path
        nodes_.push_back(std::move(node));
        roots_.push_back(static_cast<int>(nodes_.size()) - 1);
    }

    // --- file

    json document()
    {
        json out{{"asset", {{"version", "2.0"}, {"generator", "Lightloom"}}}, {"scene", 0}};
        json root = json::object();
        nameIt(root, scene_.name);
        if (!roots_.empty()) root["nodes"] = roots_;
        if (scene_.exposureEv) root["extras"]["lightloom"]["exposure"] = tidy(*scene_.exposureEv);
        out["scenes"] = {root};
        if (lightmap_) {
            json& about = out["scenes"][0]["extras"]["lightloom"]["lightmap"];
            about = {{"file", lightmap_->hdrFile},
                     {"unit", "lux"},
                     {"texCoord", 1},
                     {"intensity", tidy(lightmap_->intensity)},
                     {"light", lightmap_->light}};
            if (!lightmap_->incomplete.empty()) about["incomplete"] = lightmap_->incomplete;
        }
        const auto put = [&](const char* key, json& list) {
            if (!list.empty()) out[key] = std::move(list);
        };
        put("nodes", nodes_), put("meshes", meshes_), put("materials", materials_), put("cameras", cameras_);
        put("images", images_), put("textures", textures_), put("samplers", samplers_);
        if (!lights_.empty()) out["extensions"]["KHR_lights_punctual"]["lights"] = std::move(lights_);
        if (!extensions_.empty()) out["extensionsUsed"] = extensions_;
        for (const GlbBuffer::View& view : buffer_.views()) {
            json entry{{"buffer", 0}, {"byteOffset", view.offset}, {"byteLength", view.length}};
            if (view.target) entry["target"] = view.target;
            out["bufferViews"].push_back(entry);
        }
        for (const GlbBuffer::Accessor& a : buffer_.accessors()) {
            json entry{
                {"bufferView", a.view}, {"componentType", a.componentType}, {"count", a.count}, {"type", a.type}};
            if (a.hasRange) entry["min"] = array(a.low), entry["max"] = array(a.high);
            out["accessors"].push_back(entry);
        }
        if (!buffer_.bytes().empty()) out["buffers"] = {{{"byteLength", buffer_.bytes().size()}}};
        return out;
    }

    /// Header, JSON chunk padded with spaces, binary chunk padded with zeros; all numbers little-endian.
    Result<std::vector<std::uint8_t>> pack(std::string text) const
    {
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const std::vector<std::uint8_t>& bin = buffer_.bytes();
        const std::uint64_t total = 12 + 8 + text.size() + (bin.empty() ? 0 : 8 + bin.size());
        if (total > 0xFFFFFFFFull) {
            return Error{Error::Kind::unsupported,
                         fmt::format("the scene takes {} bytes and a glb holds 4294967295; split it", total)};
        }
        std::vector<std::uint8_t> out;
        out.reserve(total);
        const auto number = [&](std::uint64_t value) {
            for (unsigned shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
        };
        number(0x46546C67), number(2), number(total); // "glTF"
        number(text.size()), number(0x4E4F534A);      // "JSON"
        out.insert(out.end(), text.begin(), text.end());
        if (bin.empty()) return out;
        number(bin.size()), number(0x004E4942); // "BIN"
        out.insert(out.end(), bin.begin(), bin.end());
        return out;
    }

    const Scene& scene_;
    const GltfLightmap* lightmap_; // may be null
    GlbBuffer buffer_;
    json images_ = json::array(), samplers_ = json::array(), textures_ = json::array(), materials_ = json::array();
    json meshes_ = json::array(), nodes_ = json::array(), lights_ = json::array(), cameras_ = json::array();
    std::vector<int> roots_;
    std::map<std::string, int> folders_;
    std::map<std::vector<int>, int> meshOf_;
    std::map<int, json> primitives_;
    std::vector<bool> joined_;
    std::set<std::string> extensions_;
};

} // namespace

Result<std::vector<std::uint8_t>> gltfBytes(const Scene& scene, const GltfLightmap* lightmap)
{
    return Writer(scene, lightmap).write();
}

Result<Done> writeGltf(const Scene& scene, const std::filesystem::path& path)
{
    const Result<std::vector<std::uint8_t>> bytes = gltfBytes(scene);
    if (!bytes) return bytes.error();
    return writeFile(path, *bytes);
}

} // namespace lightloom
