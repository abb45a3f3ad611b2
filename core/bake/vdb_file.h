// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lightloom {

/// An OpenVDB file in memory: named grids of numbers or vectors, and what the file says about itself. Keeps OpenVDB's
/// headers in one source file. Reading functions throw std::exception where something is missing or of another type:
/// whoever reads a file turns that into an Error.
class VdbFile {
public:
    VdbFile();
    explicit VdbFile(const std::string& stream); ///< from the bytes of an OpenVDB stream
    ~VdbFile();
    VdbFile(const VdbFile&) = delete;
    VdbFile& operator=(const VdbFile&) = delete;
    [[nodiscard]] std::string bytes() const;

    void set(const std::string& key, const std::string& text);
    void set(const std::string& key, std::int64_t number);
    void set(const std::string& key, float number);
    void set(const std::string& key, glm::vec3 vector);
    [[nodiscard]] std::string text(const std::string& key) const;
    [[nodiscard]] std::int64_t integer(const std::string& key) const;
    [[nodiscard]] float number(const std::string& key) const;
    [[nodiscard]] glm::vec3 vector(const std::string& key) const;

    /// Where voxels lie: voxel (i, j, k) covers corner + cell * [i, i+1] and so on, in the scene file's frame, metres.
    struct Lattice {
        glm::dvec3 corner{0.0};
        glm::dvec3 cell{1.0};
    };
    /// Adds a grid whose voxels `cells` hold `values`, one each.
    void add(const std::string& name, const Lattice& lattice, std::span<const glm::ivec3> cells,
             std::span<const float> values);
    void add(const std::string& name, const Lattice& lattice, std::span<const glm::ivec3> cells,
             std::span<const glm::vec3> values);

    [[nodiscard]] bool contains(const std::string& grid) const;
    [[nodiscard]] std::vector<glm::ivec3> cells(const std::string& grid) const; ///< of vectors; the file's order
    /// Values at `cells`; 0 where the grid has none.
    [[nodiscard]] std::vector<float> numbers(const std::string& grid, std::span<const glm::ivec3> cells) const;
    [[nodiscard]] std::vector<glm::vec3> vectors(const std::string& grid, std::span<const glm::ivec3> cells) const;

private:
    struct Content;
    std::unique_ptr<Content> content_;
};

} // namespace lightloom
