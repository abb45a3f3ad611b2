// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/ivg/grid_lattice.h"
#include "core/ivg/grid_openness.h"
#include "core/ivg/irradiance_vectors.h"
#include <memory>
#include <vector>

namespace lightloom {

/// A lattice and what walls leave of it. Immutable once shared.
struct GridGeometry {
    GridLattice lattice;
    GridOpenness openness;
    [[nodiscard]] std::size_t memoryBytes() const { return openness.memoryBytes(); }
};

/// Light of one light group at the vertices of a lattice, at baked intensity. Immutable once shared.
struct GridLayer {
    int group = 0;
    std::vector<IrradianceVectors> vectors;     ///< by vertex; zero where nothing is open
    std::vector<std::array<float, 6>> variance; ///< by vertex: of the luminance of I_delta . delta, lux^2
    /// By vertex and direction: what is added to I_delta . delta for surface, so that it looks as bright as what lands
    /// on it says (fitToSurface); lux per channel. Empty: nothing. Remaps `joined` and `flux` use it.
    std::vector<std::array<glm::vec3, 6>> onSurface = {};
    static constexpr std::size_t kBytesPerVertex = sizeof(IrradianceVectors) + sizeof(std::array<float, 6>);
    static constexpr std::size_t kFitBytesPerVertex = sizeof(std::array<glm::vec3, 6>);
    [[nodiscard]] std::size_t memoryBytes() const
    {
        return vectors.size() * kBytesPerVertex + onSurface.size() * kFitBytesPerVertex;
    }
};

} // namespace lightloom
