// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// Small glTF files made in memory, for tests that want to know every byte of what they read.
namespace lightloom::test {

using Bytes = std::vector<std::uint8_t>;

enum Component { kByte = 5120, kUByte = 5121, kShort = 5122, kUShort = 5123, kUInt = 5125, kFloat = 5126 };

struct GltfBuilder {
    nlohmann::json root{
        {"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", nlohmann::json::array()}}}}};
    Bytes binary;

    template<class T>
    int view(const std::vector<T>& values, int stride = 0)
    {
        while (binary.size() % 4 != 0) binary.push_back(0);
        nlohmann::json view{{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}};
        if (stride != 0) view["byteStride"] = stride;
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
        binary.insert(binary.end(), bytes, bytes + values.size() * sizeof(T));
        return add("bufferViews", std::move(view));
    }
    int accessor(int view, int component, const char* type, std::size_t count, bool normalized = false)
    {
        return add("accessors", {{"bufferView", view},
                                 {"componentType", component},
                                 {"type", type},
                                 {"count", count},
                                 {"normalized", normalized}});
    }
    int vec3s(const std::vector<glm::vec3>& values) { return accessor(view(values), kFloat, "VEC3", values.size()); }
    int vec2s(const std::vector<glm::vec2>& values) { return accessor(view(values), kFloat, "VEC2", values.size()); }
    template<class T>
    int indices(const std::vector<T>& values)
    {
        const int component = sizeof(T) == 1 ? kUByte : sizeof(T) == 2 ? kUShort : kUInt;
        return accessor(view(values), component, "SCALAR", values.size());
    }
    /// Appends to a top-level list; gives the index.
    int add(const char* list, nlohmann::json entry)
    {
        root[list].push_back(std::move(entry));
        return static_cast<int>(root[list].size()) - 1;
    }
    int mesh(nlohmann::json primitive, const char* name = "mesh")
    {
        return add("meshes", {{"name", name}, {"primitives", {std::move(primitive)}}});
    }
    /// A node at the root of the scene.
    int node(nlohmann::json node)
    {
        const int index = add("nodes", std::move(node));
        root["scenes"][0]["nodes"].push_back(index);
        return index;
    }
    /// A unit square in the xz plane that faces up, `material` -1: none.
    int quad(int material = -1, const char* name = "quad")
    {
        const int positions = vec3s({{0, 0, 0}, {1, 0, 0}, {1, 0, -1}, {0, 0, -1}});
        const int corners = indices<std::uint16_t>({0, 1, 2, 0, 2, 3});
        nlohmann::json primitive{{"attributes", {{"POSITION", positions}}}, {"indices", corners}};
        if (material >= 0) primitive["material"] = material;
        return mesh(primitive, name);
    }

    [[nodiscard]] Bytes glb()
    {
        if (!binary.empty()) root["buffers"] = {{{"byteLength", binary.size()}}};
        return glbOf(root.dump(), binary);
    }
    [[nodiscard]] Bytes gltf(const std::string& uri)
    {
        root["buffers"] = {{{"byteLength", binary.size()}, {"uri", uri}}};
        const std::string text = root.dump();
        return {text.begin(), text.end()};
    }

    static Bytes glbOf(std::string json, Bytes binary)
    {
        while (json.size() % 4 != 0) json += ' ';
        while (binary.size() % 4 != 0) binary.push_back(0);
        Bytes file;
        const auto word = [&](std::size_t v) {
            for (int i = 0; i < 4; ++i) file.push_back(static_cast<std::uint8_t>(v >> (8 * i) & 0xFF));
        };
        word(0x46546C67);
        word(2);
        word(12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size()));
        word(json.size());
        word(0x4E4F534A);
        file.insert(file.end(), json.begin(), json.end());
        if (binary.empty()) return file;
        word(binary.size());
        word(0x004E4942);
        file.insert(file.end(), binary.begin(), binary.end());
        return file;
    }
};

} // namespace lightloom::test
