// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
class Value;
} // namespace tinygltf

namespace lightloom {

/// One line per thing that is read differently from what the file says, however often it occurs.
class GltfWarnings {
public:
    void add(const std::string& line)
    {
        if (seen_.insert(line).second) lines.push_back(line);
    }
    std::vector<std::string> lines;

private:
    std::set<std::string> seen_;
};

/// Reads accessors of a model that has passed `checkGltf`: ranges and types are not checked again.
class GltfData {
public:
    GltfData(const tinygltf::Model& model, std::span<const std::span<const std::uint8_t>> buffers)
        : model_(model), buffers_(buffers)
    {
    }
    [[nodiscard]] std::size_t count(int accessor) const;
    [[nodiscard]] int components(int accessor) const; ///< 1 .. 4

    /// All elements as floats, `components(accessor)` each; normalised integers become [0,1] or [-1,1]; sparse parts
    /// are laid over.
    [[nodiscard]] std::vector<float> floats(int accessor) const;
    /// All elements of an accessor of unsigned integers.
    [[nodiscard]] std::vector<std::uint32_t> indices(int accessor) const;

private:
    const tinygltf::Model& model_;
    std::span<const std::span<const std::uint8_t>> buffers_;
};

/// Looks into an extension or extras: the number, or `otherwise` where there is none.
[[nodiscard]] double gltfNumber(const tinygltf::Value& value, const char* key, double otherwise);
/// The text at value.lightloom.key, or at value."lightloom.key" (flat custom properties); "" where there is none.
[[nodiscard]] std::string lightloomText(const tinygltf::Value& extras, const std::string& key);
/// The same for a number; NaN where there is none.
[[nodiscard]] double lightloomNumber(const tinygltf::Value& extras, const std::string& key);

} // namespace lightloom
