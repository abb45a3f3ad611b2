// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_gpu.h"
#include "core/base/units.h"
#include <Imath/half.h>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <new>

namespace lightloom {
namespace {

constexpr float kMostNumber = 32768.0f; ///< halves end at 65504

/// Texels of one vertex, in the order of slabs.
using VertexTexels = std::vector<glm::vec4>;

std::size_t axisOf(std::size_t direction) { return direction / 2; }

/// Colour and direction for three vectors (RR-6983, section 4.2). Where they cancel there is no direction, and no light
/// to speak of.
void compress(std::span<const glm::vec3, 3> xyz, glm::vec3& lengths, glm::vec3& direction)
{
    glm::vec3 sum(0.0f);
    for (int c = 0; c < 3; ++c) {
        const glm::vec3 one(xyz[0][c], xyz[1][c], xyz[2][c]);
        lengths[c] = glm::length(one);
        sum += one;
    }
    const float length = glm::length(sum);
    direction = length > 0.0f ? sum / length : glm::vec3(0.0f);
}

/// Numbers of a part one after the other, four a texel, their trust behind them.
void addPacked(std::span<const glm::vec3> numbers, float trust, glm::vec4* texels)
{
    std::size_t at = 0;
    const auto add = [&](float v) {
        texels[at / 4][static_cast<int>(at % 4)] = v;
        ++at;
    };
    for (const glm::vec3& n : numbers) {
        for (int c = 0; c < 3; ++c) add(n[c] * trust);
    }
    add(trust);
}

class Packer {
public:
    Packer(const IrradianceGrid& grid, GpuGrid& gpu) : grid_(grid), gpu_(gpu), parts_(remapParts(gpu.show.remap)) {}

    /// All numbers but directions are still in lux.
    void texelsOf(std::size_t vertex, VertexTexels& texels) const
    {
        std::ranges::fill(texels, glm::vec4(0.0f));
        const std::span<const glm::vec3> kept = grid_.keptAt(vertex);
        const auto sideTexels = static_cast<std::size_t>(gpu_.sideTexels);
        for (std::size_t d = 0; d < 6 && sideTexels > 0; ++d) {
            const float trust = grid_.trust(vertex, axisOf(d));
            glm::vec4* side = texels.data() + d * sideTexels;
            if (gpu_.packing == GridPacking::compressed) {
                glm::vec3 lengths, direction;
                compress(kept.subspan(3 * d).first<3>(), lengths, direction);
                side[0] = glm::vec4(lengths * trust, trust);
                side[1] = glm::vec4(direction * trust, 0.0f);
                continue;
            }
            for (std::size_t j = 0; j < sideTexels; ++j) side[j] = glm::vec4(kept[d * sideTexels + j] * trust, trust);
        }
        glm::vec4* shared = texels.data() + 6 * sideTexels;
        if (gpu_.sharedTexels > 0) {
            const std::size_t part = parts_.size() - 1;
            addPacked(kept.subspan(parts_[part].first, parts_[part].count), grid_.trust(vertex, part), shared);
        }
        if (!gpu_.hasSlopes) return;
        glm::vec4* slopes = shared + gpu_.sharedTexels;
        for (std::size_t d = 0; d < 6; ++d)
            slopes[d] = glm::vec4(grid_.slopes(vertex)[d] * grid_.trust(vertex, axisOf(d)), 0.0f);
    }

    [[nodiscard]] bool isKnown(std::size_t vertex) const
    {
        for (std::size_t part = 0; part < parts_.size(); ++part) {
            if (grid_.trust(vertex, part) > 0.0f) return true;
        }
        return false;
    }

    /// Whether a texel's colour is light, and not weights or directions.
    [[nodiscard]] bool isLight(std::size_t slab, int component) const
    {
        const auto sides = static_cast<std::size_t>(6 * gpu_.sideTexels);
        if (slab < sides) {
            const bool isDirection = gpu_.packing == GridPacking::compressed && slab % 2 == 1;
            return component < 3 && !isDirection;
        }
        const std::size_t shared = slab - sides;
        if (shared >= static_cast<std::size_t>(gpu_.sharedTexels)) return true; // slopes
        return 4 * shared + static_cast<std::size_t>(component) < 3 * parts_.back().count;
    }

private:
    const IrradianceGrid& grid_;
    const GpuGrid& gpu_;
    std::span<const RemapPart> parts_;
};

void choose(GpuGrid& gpu)
{
    switch (gpu.show.remap) {
    case GridRemap::joined:
        gpu.sharedTexels = 5; // 18 numbers and their trust
        break;
    case GridRemap::harmonic:
        gpu.sideTexels = 0;
        gpu.sharedTexels = 7; // 27 numbers and their trust
        gpu.hasSlopes = false;
        break;
    case GridRemap::flux:
        break;
    case GridRemap::paper:
        gpu.sideTexels = gpu.packing == GridPacking::compressed ? 2 : 3;
        gpu.hasSlopes = false;
        break;
    }
}

void packSight(const IrradianceGrid& grid, const Packer& packer, GpuGrid& gpu)
{
    const auto& sight = grid.geometry().openness.sight;
    gpu.sight.resize(4 * sight.size());
    for (std::size_t i = 0; i < sight.size(); ++i) {
        std::uint16_t* texel = gpu.sight.data() + 4 * i;
        for (std::size_t axis = 0; axis < 3; ++axis)
            texel[axis] = static_cast<std::uint16_t>(sight[i][2 * axis] | sight[i][2 * axis + 1] << 8);
        texel[3] = packer.isKnown(i) ? 1 : 0;
        gpu.openVertices += texel[3];
    }
}

void packPlaces(const IrradianceGrid& grid, GpuGrid& gpu)
{
    if (!gpu.hasSlopes || gpu.show.filter != GridFilter::bspline) return;
    const std::size_t count = gpu.lattice.vertexCount();
    gpu.places.assign(4 * count, 0.0f);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::ivec3 vertex = gpu.lattice.vertex(i);
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            gpu.places[4 * i + a] = grid.trust(i, a) * static_cast<float>(vertex[axis]);
        }
    }
}

/// Where slabs begin in the array, in texels.
std::vector<std::size_t> slabStarts(const GpuGrid& gpu)
{
    std::vector<std::size_t> starts;
    const glm::ivec3 n = gpu.lattice.vertices(), size = gpu.size();
    for (int s = 0; s < gpu.slabCount(); ++s) {
        const glm::ivec3 low =
            n * glm::ivec3(s % gpu.slabs.x, s / gpu.slabs.x % gpu.slabs.y, s / (gpu.slabs.x * gpu.slabs.y));
        starts.push_back(
            (static_cast<std::size_t>(low.z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(low.y)) *
                static_cast<std::size_t>(size.x) +
            static_cast<std::size_t>(low.x));
    }
    return starts;
}

void packLight(const Packer& packer, GpuGrid& gpu)
{
    const std::size_t count = gpu.lattice.vertexCount();
    VertexTexels texels(static_cast<std::size_t>(gpu.slabCount()));
    float most = 0.0f;
    for (std::size_t i = 0; i < count; ++i) {
        packer.texelsOf(i, texels);
        for (std::size_t s = 0; s < texels.size(); ++s) {
            for (int c = 0; c < 4; ++c) most = packer.isLight(s, c) ? glm::max(most, std::abs(texels[s][c])) : most;
        }
    }
    gpu.scale = most > 0.0f ? std::exp2(std::ceil(std::log2(most / kMostNumber))) : 1.0f;
    const glm::ivec3 size = gpu.size();
    gpu.light.assign(
        4 * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z), 0);
    const std::vector<std::size_t> starts = slabStarts(gpu);
    for (std::size_t i = 0; i < count; ++i) {
        packer.texelsOf(i, texels);
        const glm::ivec3 v = gpu.lattice.vertex(i);
        const std::size_t in =
            (static_cast<std::size_t>(v.z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(v.y)) *
                static_cast<std::size_t>(size.x) +
            static_cast<std::size_t>(v.x);
        for (std::size_t s = 0; s < texels.size(); ++s) {
            std::uint16_t* half = gpu.light.data() + 4 * (starts[s] + in);
            for (int c = 0; c < 4; ++c)
                half[c] = imath_float_to_half(texels[s][c] / (packer.isLight(s, c) ? gpu.scale : 1.0f));
        }
    }
}

} // namespace

glm::ivec3 slabBox(glm::ivec3 vertices, int count)
{
    const auto longest = [&](glm::ivec3 box) {
        const glm::ivec3 size = box * vertices;
        return std::max({size.x, size.y, size.z});
    };
    glm::ivec3 best(1, 1, count);
    for (int x = 1; x <= count; ++x) {
        for (int y = 1; x * y < count + x; ++y) {
            const glm::ivec3 box(x, y, (count + x * y - 1) / (x * y));
            const int a = longest(box), b = longest(best);
            if (a < b || (a == b && box.x * box.y * box.z < best.x * best.y * best.z)) best = box;
        }
    }
    return best;
}

Result<GpuGrid> makeGpuGrid(const IrradianceGrid& grid, GridPacking packing)
try {
    GpuGrid gpu;
    gpu.lattice = grid.geometry().lattice;
    gpu.show = grid.show();
    gpu.packing = packing;
    if (packing == GridPacking::compressed && gpu.show.remap != GridRemap::paper) {
        return Error{Error::Kind::badInput, "the compressed form keeps what grid.remap = paper needs; choose that"};
    }
    choose(gpu);
    gpu.slabs = slabBox(gpu.lattice.vertices(), gpu.slabCount());
    const Packer packer(grid, gpu);
    packSight(grid, packer, gpu);
    packPlaces(grid, gpu);
    packLight(packer, gpu);
    if (const GridInside& inside = grid.inside(); inside.grid) {
        Result<GpuGrid> finer = makeGpuGrid(*inside.grid, packing);
        if (!finer) return finer.error();
        gpu.inside = std::make_shared<const GpuGrid>(std::move(*finer));
        gpu.box = inside.box;
        gpu.fade = inside.fade;
    }
    return gpu;
} catch (const std::bad_alloc&) {
    return Error{Error::Kind::outOfMemory,
                 fmt::format("not enough memory for the textures of a grid of {} vertices; lower grid.size",
                             grid.geometry().lattice.vertexCount())};
}

} // namespace lightloom
