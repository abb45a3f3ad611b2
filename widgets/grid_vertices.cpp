// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/grid_vertices.h"
#include "core/base/image.h"
#include "core/base/units.h"
#include "core/compare/false_colour.h"
#include "core/ivg/irradiance_grid.h"
#include <algorithm>
#include <cmath>

namespace lightloom {

namespace {

constexpr std::uint8_t kFaint = 70, kSeen = 255;
constexpr float kAlmostAll = 0.999f;

glm::u8vec4 openColour(const IrradianceGrid& grid, std::size_t vertex)
{
    const GridOpenness& openness = grid.geometry().openness;
    if (openness.isOpen[vertex] == 0) return {225, 60, 50, kSeen};
    float least = 1.0f, share = 1.0f;
    const std::size_t parts = remapParts(grid.show().remap).size();
    for (std::size_t part = 0; part < parts; ++part) least = std::min(least, grid.trust(vertex, part));
    const glm::vec3 faces = openness.faceShare[vertex];
    share = std::min({faces.x, faces.y, faces.z});
    if (least <= 0.0f) return {240, 140, 40, kSeen};
    if (share < kAlmostAll) return {235, 215, 60, kSeen};
    const bool isNear = std::ranges::any_of(openness.sight[vertex], [](std::uint8_t s) { return s < 255; });
    return {90, 200, 110, isNear ? kSeen : kFaint};
}

glm::u8vec4 noiseColour(const IrradianceGrid& grid, const Mix& mix, std::size_t vertex)
{
    if (grid.geometry().openness.isOpen[vertex] == 0) return glm::u8vec4(0);
    float light = 0.0f, variance = 0.0f;
    for (const auto& layer : grid.layers()) {
        if (!layer) continue;
        const glm::vec3 gain = gainOf(mix, layer->group);
        for (std::size_t d = 0; d < 6; ++d) {
            const int axis = static_cast<int>(d / 2);
            const glm::mat3& vectors = layer->vectors[vertex][d];
            const glm::vec3 along(vectors[0][axis], vectors[1][axis], vectors[2][axis]);
            light += luminance(gain * along) * (d % 2 == 0 ? -1.0f : 1.0f);
            variance += luminance(gain) * luminance(gain) * layer->variance[vertex][d];
        }
    }
    const float noise = light > 0.0f ? std::sqrt(variance) / light : 0.0f; // no photon: nothing is known of its noise
    if (light <= 0.0f) return {120, 120, 120, kFaint};
    const glm::vec3 colour = falseColour(noise / kMostVertexNoise);
    const auto byte = [](float linear) { return static_cast<std::uint8_t>(std::lround(255.0f * encodeSrgb(linear))); };
    return {byte(colour.x), byte(colour.y), byte(colour.z), kSeen};
}

GridVertices::Lattice marked(const IrradianceGrid& grid, const Mix& mix, VertexMarks marks)
{
    GridVertices::Lattice out{grid.geometry().lattice, {}};
    out.colours.resize(out.lattice.vertexCount());
    for (std::size_t i = 0; i < out.colours.size(); ++i)
        out.colours[i] = marks == VertexMarks::openness ? openColour(grid, i) : noiseColour(grid, mix, i);
    return out;
}

} // namespace

std::shared_ptr<const GridVertices> gridVertices(const IrradianceGrid& grid, const Mix& mix, VertexMarks marks)
{
    if (marks == VertexMarks::none) return nullptr;
    auto out = std::make_shared<GridVertices>();
    out->lattices.push_back(marked(grid, mix, marks));
    const GridInside& inside = grid.inside();
    if (!inside.grid) return out;
    GridVertices::Lattice& outer = out->lattices.front();
    for (std::size_t i = 0; i < outer.colours.size(); ++i) {
        const bool isReplaced = inside.weight(outer.lattice.position(outer.lattice.vertex(i))) >= 1.0f;
        if (isReplaced) outer.colours[i] = glm::u8vec4(0);
    }
    out->lattices.push_back(marked(*inside.grid, mix, marks));
    return out;
}

} // namespace lightloom
