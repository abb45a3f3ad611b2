// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_nest.h"
#include "core/base/units.h"
#include <algorithm>
#include <cmath>

namespace lightloom {
namespace {

constexpr float kNoiseOfBend = 6.0f; ///< variance of a second difference over that of its values

/// By vertex, the square of how much light bends within a cell, summed over axes and those directions that surface near
/// by faces.
class Bends {
public:
    explicit Bends(const IrradianceGrid& grid) : grid_(grid), lattice_(grid.geometry().lattice)
    {
        const std::size_t count = lattice_.vertexCount();
        flux_.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const IrradianceVectors vectors = grid.mixedVectors(i);
            for (std::size_t d = 0; d < 6; ++d) flux_[i][d] = luminance(alongAxis(vectors, d));
        }
        squares_.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            squares_[i] = grid.geometry().openness.isOpen[i] != 0 ? squareAt(i) : 0.0;
    }
    [[nodiscard]] const std::vector<double>& squares() const { return squares_; }

private:
    /// Whether surface that faces direction `d` lies within a cell: others do not ask for this direction.
    [[nodiscard]] bool isAsked(std::size_t i, std::size_t d) const
    {
        const GridOpenness& openness = grid_.geometry().openness;
        return static_cast<float>(openness.sight[i][d ^ 1]) <= GridOpenness::kSightUnits;
    }
    /// The neighbour along an axis, if it is seen.
    [[nodiscard]] std::optional<std::size_t> seen(std::size_t i, int axis, int step) const
    {
        glm::ivec3 to = lattice_.vertex(i);
        to[axis] += step;
        if (to != glm::clamp(to, glm::ivec3(0), lattice_.cells)) return {};
        const std::size_t way = static_cast<std::size_t>(2 * axis + (step > 0 ? 1 : 0));
        const auto sight = static_cast<float>(grid_.geometry().openness.sight[i][way]);
        if (sight < GridOpenness::kSightUnits) return {};
        return lattice_.index(to);
    }
    [[nodiscard]] double squareAt(std::size_t i) const
    {
        double sum = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            const auto below = seen(i, axis, -1), above = seen(i, axis, 1);
            for (std::size_t d = 0; d < 6; ++d) {
                if (!isAsked(i, d)) continue;
                // beside a wall there is no more than the slope: that it goes on as it is, is not known
                const float low = below ? flux_[*below][d] : flux_[i][d], high = above ? flux_[*above][d] : flux_[i][d];
                const float bend = low - 2.0f * flux_[i][d] + high;
                const float noise = kNoiseOfBend * grid_.variance(i)[d];
                sum += static_cast<double>(std::max(bend * bend - noise, 0.0f));
            }
        }
        return sum;
    }

    const IrradianceGrid& grid_;
    const GridLattice& lattice_;
    std::vector<std::array<float, 6>> flux_;
    std::vector<double> squares_;
};

/// A box of vertices, both ends in it.
struct VertexBox {
    glm::ivec3 low, high;
    [[nodiscard]] glm::ivec3 cells() const { return high - low; }
};

double sumIn(const GridLattice& lattice, const std::vector<double>& squares, const VertexBox& box)
{
    double sum = 0.0;
    for (int z = box.low.z; z <= box.high.z; ++z) {
        for (int y = box.low.y; y <= box.high.y; ++y) {
            for (int x = box.low.x; x <= box.high.x; ++x) sum += squares[lattice.index({x, y, z})];
        }
    }
    return sum;
}

/// Of the finer grid: a cell more on each side, for the surface that lies beyond the last vertices, and for the seam.
double verticesOf(const VertexBox& box, int fine)
{
    const glm::dvec3 n = glm::dvec3((box.cells() + 2) * fine + 4);
    return n.x * n.y * n.z;
}

} // namespace

std::optional<Bounds> chooseNest(const IrradianceGrid& outer, int fine)
{
    const GridLattice& lattice = outer.geometry().lattice;
    const Bends bends(outer);
    const std::vector<double>& squares = bends.squares();
    const auto most = std::ranges::max_element(squares);
    if (most == squares.end() || *most <= 0.0) return {};
    const glm::ivec3 centre = lattice.vertex(static_cast<std::size_t>(most - squares.begin()));
    VertexBox box{glm::max(centre - 1, glm::ivec3(0)), glm::min(centre + 1, lattice.cells)};
    const auto allowed = static_cast<double>(lattice.vertexCount());
    while (true) {
        std::optional<VertexBox> best;
        double bestGain = 0.0;
        for (int side = 0; side < 6; ++side) {
            const int axis = side / 2;
            for (const int step : {1, 2, 4}) { // also across a calm layer to what lies behind
                VertexBox grown = box, layer = box;
                if (side % 2 == 0) {
                    grown.low[axis] = std::max(box.low[axis] - step, 0);
                    layer.low[axis] = grown.low[axis], layer.high[axis] = box.low[axis] - 1;
                } else {
                    grown.high[axis] = std::min(box.high[axis] + step, lattice.cells[axis]);
                    layer.low[axis] = box.high[axis] + 1, layer.high[axis] = grown.high[axis];
                }
                if (layer.low[axis] > layer.high[axis] || verticesOf(grown, fine) > allowed) continue;
                const double gain = sumIn(lattice, squares, layer) / (verticesOf(grown, fine) - verticesOf(box, fine));
                if (gain > bestGain) bestGain = gain, best = grown;
            }
        }
        if (!best) break;
        box = *best;
    }
    return Bounds{lattice.position(box.low - 1), lattice.position(box.high + 1)};
}

GridLattice nestLattice(const RayScene& rays, const GridLattice& outer, const Bounds& box, int fine)
{
    GridLattice lattice;
    for (int axis = 0; axis < 3; ++axis) {
        const float cell = outer.cellSize[axis] / static_cast<float>(fine);
        const float start = box.low[axis] - 0.5f * cell;
        const float place = freePlace(0.0f, wallFractions(rays, axis, start, cell), kWallClearance);
        lattice.cellSize[axis] = cell;
        lattice.lowest[axis] = start + (place - 1.0f) * cell;
        lattice.cells[axis] = static_cast<int>(std::ceil((box.high[axis] - box.low[axis]) / cell - 1e-3f)) + 3;
    }
    return lattice;
}

GridInside joinNest(std::shared_ptr<const IrradianceGrid> finer, const Bounds& scene, const GridLattice& outer,
                    Bounds box)
{
    const float fade = std::max({outer.cellSize.x, outer.cellSize.y, outer.cellSize.z});
    for (int axis = 0; axis < 3; ++axis) {
        if (box.low[axis] <= scene.low[axis]) box.low[axis] = scene.low[axis] - 2.0f * fade;
        if (box.high[axis] >= scene.high[axis]) box.high[axis] = scene.high[axis] + 2.0f * fade;
    }
    return {std::move(finer), box, fade};
}

} // namespace lightloom
