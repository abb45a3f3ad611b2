// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace lightloom {

/// Joins vertices that are closer than `tolerance`: entry i is the number of the vertex that stands for vertex i (the
/// first one seen; chains are not followed). Linear time.
[[nodiscard]] std::vector<std::uint32_t> weldVertices(std::span<const glm::vec3> positions, float tolerance);

/// Adds up edges of triangles and says whether they close: each edge is run through as often one way as the other.
/// Instead of a table of edges a random word per edge is added or subtracted; what remains is 0 for a closed surface
/// and, but for one chance in 2^64, for no other.
class EdgeBalance {
public:
    /// `corners`: vertex numbers after welding. Edges of a triangle that welding has flattened cancel by themselves.
    void add(glm::uvec3 corners);
    [[nodiscard]] bool isClosed() const { return sum_ == 0; }

private:
    std::uint64_t sum_ = 0;
};

} // namespace lightloom
