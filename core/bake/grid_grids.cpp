// SPDX-License-Identifier: Apache-2.0
#include "core/bake/bake_grids.h"
#include "core/base/units.h"
#include "core/ivg/grid_memory.h"
#include "core/ivg/ivg_solver.h"
#include <cmath>
#include <fmt/format.h>
#include <stdexcept>

namespace lightloom {
namespace {

constexpr std::array<const char*, 6> kDirections{"-x", "+x", "-y", "+y", "-z", "+z"};
constexpr std::array<const char*, 3> kChannels{"r", "g", "b"};
constexpr const char *kBoxLow = "lightloom.grid.inside.low", *kBoxHigh = "lightloom.grid.inside.high",
                     *kFade = "lightloom.grid.inside.fade";

/// Names of what belongs to the grid (depth 0), or to the finer one inside it (1).
struct Names {
    int depth = 0;

    [[nodiscard]] std::string geometry(std::string_view quantity) const
    {
        return fmt::format("irradiance-grid/d{}/geometry/{}", depth, quantity);
    }
    [[nodiscard]] std::string vectors(const std::string& group, std::size_t direction, std::size_t channel) const
    {
        return fmt::format("irradiance-grid/d{}/{}/vectors/{}/{}", depth, group, kDirections[direction],
                           kChannels[channel]);
    }
    [[nodiscard]] std::string onSurface(const std::string& group, std::size_t direction) const
    {
        return fmt::format("irradiance-grid/d{}/{}/on_surface/{}", depth, group, kDirections[direction]);
    }
    [[nodiscard]] std::string variance(const std::string& group, std::size_t direction) const
    {
        return fmt::format("irradiance-grid/d{}/{}/variance/{}", depth, group, kDirections[direction]);
    }
    [[nodiscard]] std::string fact(std::string_view what) const
    {
        return fmt::format("lightloom.grid.{}{}", depth == 0 ? "" : "inside.", what);
    }
};

glm::vec3 sightOf(const std::array<std::uint8_t, 6>& sight, std::size_t side)
{
    return {sight[side], sight[2 + side], sight[4 + side]};
}

void require(bool isFine, const char* what)
{
    if (!isFine) throw std::runtime_error(what);
}

GridLattice readLattice(const VdbFile& file, const Names& names)
{
    GridLattice lattice;
    const glm::vec3 cells = file.vector(names.fact("cells"));
    constexpr float kMost = 1024.0f;
    const bool isWhole = glm::all(glm::greaterThanEqual(cells, glm::vec3(1.0f))) &&
                         glm::all(glm::lessThanEqual(cells, glm::vec3(kMost))) && cells == glm::floor(cells);
    require(isWhole, "a grid with no number of cells that there can be");
    lattice.cells = glm::ivec3(cells);
    lattice.cellSize = file.vector(names.fact("cell_size"));
    lattice.lowest = file.vector(names.fact("lowest"));
    require(isFinite(lattice.lowest) && isFinite(lattice.cellSize) &&
                glm::all(glm::greaterThan(lattice.cellSize, glm::vec3(0.0f))),
            "a grid without a place");
    if (const Result<Done> fits = checkGridFits(lattice, GridMemoryJob{}); !fits)
        throw std::runtime_error(fits.error().message);
    return lattice;
}

std::shared_ptr<const GridGeometry> readGeometry(const VdbFile& file, const Names& names,
                                                 std::vector<glm::ivec3>& places)
{
    auto geometry = std::make_shared<GridGeometry>();
    geometry->lattice = readLattice(file, names);
    const GridLattice& lattice = geometry->lattice;
    GridOpenness& openness = geometry->openness;
    openness = GridOpenness::everything(lattice);
    openness.isOpen.assign(lattice.vertexCount(), 0);
    openness.faceShare.assign(lattice.vertexCount(), glm::vec3(0.0f));
    openness.cellShare.assign(lattice.vertexCount(), 0.0f);
    places = file.cells(names.geometry("face_share"));
    const auto faces = file.vectors(names.geometry("face_share"), places);
    const auto cells = file.numbers(names.geometry("cell_share"), places);
    const std::array sights{file.vectors(names.geometry("sight_low"), places),
                            file.vectors(names.geometry("sight_high"), places)};
    for (std::size_t k = 0; k < places.size(); ++k) {
        require(places[k] == glm::clamp(places[k], glm::ivec3(0), lattice.cells), "a vertex outside the grid");
        const std::size_t i = lattice.index(places[k]);
        const bool isShare = glm::all(glm::greaterThanEqual(faces[k], glm::vec3(0.0f))) &&
                             glm::all(glm::lessThanEqual(faces[k], glm::vec3(1.0f))) && cells[k] >= 0.0f &&
                             cells[k] <= 1.0f;
        require(isShare, "a vertex that is open by no share");
        openness.isOpen[i] = 1;
        openness.faceShare[i] = faces[k];
        openness.cellShare[i] = cells[k];
        for (std::size_t way = 0; way < 6; ++way) {
            const float sight = sights[way % 2][k][static_cast<int>(way / 2)];
            require(sight >= 0.0f && sight <= 255.0f, "a vertex with no sight that there can be");
            openness.sight[i][way] = static_cast<std::uint8_t>(sight);
        }
    }
    return geometry;
}

std::shared_ptr<const GridLayer> readLayer(const VdbFile& file, const Names& names, const std::string& group,
                                           int number, const GridLattice& lattice,
                                           const std::vector<glm::ivec3>& places)
{
    auto layer = std::make_shared<GridLayer>();
    layer->group = number;
    layer->vectors.resize(lattice.vertexCount(), IrradianceVectors{});
    layer->variance.resize(lattice.vertexCount(), {});
    for (std::size_t d = 0; d < kDirections.size(); ++d) {
        for (std::size_t channel = 0; channel < kChannels.size(); ++channel) {
            const auto values = file.vectors(names.vectors(group, d, channel), places);
            for (std::size_t k = 0; k < places.size(); ++k) {
                require(isFinite(values[k]), "light that is not finite");
                layer->vectors[lattice.index(places[k])][d][static_cast<int>(channel)] = values[k];
            }
        }
        if (file.contains(names.onSurface(group, d))) {
            layer->onSurface.resize(lattice.vertexCount(), {});
            const auto values = file.vectors(names.onSurface(group, d), places);
            for (std::size_t k = 0; k < places.size(); ++k) {
                require(isFinite(values[k]), "light that is not finite");
                layer->onSurface[lattice.index(places[k])][d] = values[k];
            }
        }
        const auto variances = file.numbers(names.variance(group, d), places);
        for (std::size_t k = 0; k < places.size(); ++k) {
            require(variances[k] >= 0.0f, "a variance below nothing");
            layer->variance[lattice.index(places[k])][d] = variances[k];
        }
    }
    return layer;
}

void storeOne(const IrradianceGrid& grid, const Scene& scene, const Names& names, VdbFile& file)
{
    const GridLattice& lattice = grid.geometry().lattice;
    const GridOpenness& openness = grid.geometry().openness;
    file.set(names.fact("cells"), glm::vec3(lattice.cells));
    file.set(names.fact("cell_size"), lattice.cellSize);
    file.set(names.fact("lowest"), lattice.lowest);
    std::vector<glm::ivec3> places;
    for (std::size_t i = 0; i < lattice.vertexCount(); ++i)
        if (openness.isOpen[i] != 0) places.push_back(lattice.vertex(i));
    const glm::dvec3 cell(lattice.cellSize);
    const VdbFile::Lattice at{scene.toFile(lattice.lowest) - 0.5 * cell, cell}; // voxels around vertices
    const auto vectors = [&](const std::string& name, const auto& valueAt) {
        std::vector<glm::vec3> values;
        for (const glm::ivec3 place : places) values.push_back(valueAt(lattice.index(place)));
        file.add(name, at, places, values);
    };
    const auto numbers = [&](const std::string& name, const auto& valueAt) {
        std::vector<float> values;
        for (const glm::ivec3 place : places) values.push_back(valueAt(lattice.index(place)));
        file.add(name, at, places, values);
    };
    vectors(names.geometry("face_share"), [&](std::size_t i) { return openness.faceShare[i]; });
    numbers(names.geometry("cell_share"), [&](std::size_t i) { return openness.cellShare[i]; });
    vectors(names.geometry("sight_low"), [&](std::size_t i) { return sightOf(openness.sight[i], 0); });
    vectors(names.geometry("sight_high"), [&](std::size_t i) { return sightOf(openness.sight[i], 1); });
    for (std::size_t g = 0; g < grid.layers().size(); ++g) {
        if (!grid.layers()[g]) continue;
        const GridLayer& layer = *grid.layers()[g];
        const std::string group = escaped(scene.groups[g].id);
        for (std::size_t d = 0; d < kDirections.size(); ++d) {
            for (std::size_t c = 0; c < kChannels.size(); ++c)
                vectors(names.vectors(group, d, c),
                        [&](std::size_t i) { return layer.vectors[i][d][static_cast<int>(c)]; });
            if (!layer.onSurface.empty())
                vectors(names.onSurface(group, d), [&](std::size_t i) { return layer.onSurface[i][d]; });
            numbers(names.variance(group, d), [&](std::size_t i) { return layer.variance[i][d]; });
        }
    }
}

std::shared_ptr<const IrradianceGrid> readOne(const VdbFile& file, const Names& names, const Scene& scene,
                                              const std::vector<bool>& isOn, const BakeParams& params)
{
    std::vector<glm::ivec3> places;
    const auto geometry = readGeometry(file, names, places);
    std::vector<std::shared_ptr<const GridLayer>> layers;
    for (std::size_t g = 0; g < isOn.size(); ++g) {
        layers.push_back(isOn[g] ? readLayer(file, names, escaped(scene.groups[g].id), static_cast<int>(g),
                                             geometry->lattice, places)
                                 : nullptr);
    }
    return std::make_shared<IrradianceGrid>(geometry, std::move(layers), params.gridEstimator, Mix{}, gridShow(params));
}

} // namespace

void storeGrid(const IrradianceGrid& grid, const Scene& scene, VdbFile& file)
{
    storeOne(grid, scene, {0}, file);
    const GridInside& inside = grid.inside();
    if (!inside.grid) return;
    storeOne(*inside.grid, scene, {1}, file);
    file.set(kBoxLow, inside.box.low);
    file.set(kBoxHigh, inside.box.high);
    file.set(kFade, inside.fade);
}

std::shared_ptr<const IrradianceGrid> readGrid(const VdbFile& file, const Scene& scene, const std::vector<bool>& isOn,
                                               const BakeParams& params)
{
    const auto outer = readOne(file, {0}, scene, isOn, params);
    if (!file.contains(Names{1}.geometry("face_share"))) return outer;
    GridInside inside{nullptr, {file.vector(kBoxLow), file.vector(kBoxHigh)}, file.number(kFade)};
    const bool isBox = isFinite(inside.box.low) && isFinite(inside.box.high) &&
                       glm::all(glm::lessThan(inside.box.low, inside.box.high)) && std::isfinite(inside.fade) &&
                       inside.fade > 0.0f;
    require(isBox, "a finer grid without a box");
    inside.grid = readOne(file, {1}, scene, isOn, params);
    return outer->withInside(std::move(inside));
}

} // namespace lightloom
