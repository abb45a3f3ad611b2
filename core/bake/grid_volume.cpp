// SPDX-License-Identifier: Apache-2.0
#include "core/bake/grid_volume.h"
#include "core/bake/volume_file.h"
#include "core/ivg/irradiance_grid.h"
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr std::array<const char*, 6> kDirections{"minus_x", "plus_x", "minus_y", "plus_y", "minus_z", "plus_z"};
constexpr std::array<const char*, 3> kChannels{"r", "g", "b"};

void addGrids(const IrradianceGrid& grid, const Scene& scene, const std::string& prefix, VdbFile& file)
{
    const GridLattice& lattice = grid.geometry().lattice;
    const GridOpenness& openness = grid.geometry().openness;
    const glm::dvec3 cell(lattice.cellSize);
    const VdbFile::Lattice at{scene.toFile(lattice.lowest) - 0.5 * cell, cell}; // voxels around vertices

    std::vector<glm::ivec3> all, open;
    std::vector<float> valid;
    std::vector<glm::vec3> shares;
    std::vector<IrradianceVectors> mixed;
    for (std::size_t i = 0; i < lattice.vertexCount(); ++i) {
        const bool isOpen = openness.isOpen[i] != 0;
        all.push_back(lattice.vertex(i));
        valid.push_back(isOpen ? 1.0f : 0.0f);
        if (!isOpen) continue;
        open.push_back(lattice.vertex(i));
        shares.push_back(openness.faceShare[i]);
        mixed.push_back(grid.mixedVectors(i));
    }
    file.add(prefix + "valid", at, all, valid);
    file.add(prefix + "open", at, open, shares);
    std::vector<glm::vec3> values(open.size());
    for (std::size_t d = 0; d < kDirections.size(); ++d) {
        for (std::size_t channel = 0; channel < kChannels.size(); ++channel) {
            for (std::size_t k = 0; k < open.size(); ++k) values[k] = mixed[k][d][static_cast<int>(channel)];
            file.add(fmt::format("{}irradiance_vector_{}_{}", prefix, kChannels[channel], kDirections[d]), at, open,
                     values);
        }
        for (std::size_t k = 0; k < open.size(); ++k) values[k] = alongAxis(mixed[k], d);
        file.add(fmt::format("{}irradiance_{}", prefix, kDirections[d]), at, open, values);
    }
}

} // namespace

Result<std::vector<std::uint8_t>> gridVolume(const IrradianceGrid& grid, const BakeInfo& info, const Scene& scene)
{
    return volumeBytes(info, [&](VdbFile& file) {
        addGrids(grid, scene, "", file);
        if (grid.inside().grid) addGrids(*grid.inside().grid, scene, "inside_", file);
    });
}

} // namespace lightloom
