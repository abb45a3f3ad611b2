// SPDX-License-Identifier: Apache-2.0
#include "core/bake/gpu_layout.h"
#include "core/base/units.h"
#include "core/octree/vdl_cluster.h"
#include "core/octree/vdl_codec.h"
#include <Imath/half.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint64_t kMostWidth = 4096; ///< of 2D textures: with it 24 bits address every texel
constexpr int kMostBrickSide = 128;        ///< GL 3.3 promises 3D textures of 256 texels a side
constexpr float kMostColour = 32768.0f;    ///< halves end at 65504

struct Texel {
    std::uint8_t r = 0, g = 0, b = 0, a = 0;
};
using Brick = std::array<Texel, 8>;

/// Turns sorted leaf codes into bricks, depth first, the root brick first.
class BrickBuilder {
public:
    explicit BrickBuilder(const OctreeGeometry& geometry) : geometry_(geometry)
    {
        if (!geometry.cells.empty()) {
            add(0, geometry.cells.size(), 0);
        } else {
            bricks.emplace_back();
            children.emplace_back();
        }
    }

    std::vector<Brick> bricks;
    std::vector<std::array<std::uint32_t, 8>> children; ///< brick number of node texels; 0: none

private:
    std::uint32_t add(std::size_t first, std::size_t last, int level)
    {
        const auto brick = static_cast<std::uint32_t>(bricks.size());
        bricks.emplace_back();
        children.emplace_back();
        const int shift = 3 * (geometry_.depth - 1 - level);
        while (first < last) {
            const std::uint64_t child = geometry_.cells[first] >> shift;
            std::size_t end = first + 1;
            while (end < last && geometry_.cells[end] >> shift == child) ++end;
            const std::size_t octant = child & 7;
            if (level + 1 == geometry_.depth) {
                bricks[brick][octant] = leaf(first);
            } else {
                const std::uint32_t node = add(first, end, level + 1);
                children[brick][octant] = node;
                bricks[brick][octant].a = 1;
            }
            first = end;
        }
        return brick;
    }

    [[nodiscard]] Texel leaf(std::size_t i) const
    {
        const std::uint32_t entry = geometry_.firstEntry[i], count = geometry_.firstEntry[i + 1] - entry;
        return {static_cast<std::uint8_t>(entry), static_cast<std::uint8_t>(entry >> 8),
                static_cast<std::uint8_t>(entry >> 16), static_cast<std::uint8_t>(count + 1)};
    }

    const OctreeGeometry& geometry_;
};

void layOutBricks(const BrickBuilder& built, GpuOctree& gpu)
{
    const glm::uvec3 side(gpu.side);
    const std::size_t across = 2 * std::size_t(side.x), down = 2 * std::size_t(side.y), deep = 2 * std::size_t(side.z);
    gpu.bricks.assign(4 * across * down * deep, 0);
    const auto place = [&](std::size_t brick) {
        return glm::uvec3(brick % side.x, brick / side.x % side.y, brick / (std::size_t(side.x) * side.y));
    };
    for (std::size_t b = 0; b < built.bricks.size(); ++b) {
        const glm::uvec3 corner = 2u * place(b);
        for (std::size_t i = 0; i < 8; ++i) {
            Texel texel = built.bricks[b][i];
            if (texel.a == 1) {
                const glm::uvec3 child = place(built.children[b][i]);
                texel = {static_cast<std::uint8_t>(child.x), static_cast<std::uint8_t>(child.y),
                         static_cast<std::uint8_t>(child.z), 1};
            }
            const glm::uvec3 at = corner + glm::uvec3(i & 1, i >> 1 & 1, i >> 2 & 1);
            std::uint8_t* out = gpu.bricks.data() + 4 * ((at.z * down + at.y) * across + at.x);
            out[0] = texel.r, out[1] = texel.g, out[2] = texel.b, out[3] = texel.a;
        }
    }
}

/// What every entry holds under the mix, `gpu.vdlCount` each.
std::vector<Vdl> mixAll(const LightOctree& octree, const GpuOctree& gpu)
{
    const auto count = static_cast<std::size_t>(gpu.vdlCount);
    std::vector<Vdl> all;
    all.reserve(octree.geometry().entries.size() * count);
    for (std::uint32_t e = 0; e < octree.geometry().entries.size(); ++e) {
        if (!gpu.hasDirections) {
            all.push_back({octree.mixedColour(e), octree.geometry().entries[e].normal});
            continue;
        }
        const std::vector<Vdl> some = octree.mixed(e, gpu.vdlCount);
        all.insert(all.end(), some.begin(), some.end());
    }
    return all;
}

/// Power of two that brings the brightest colour just below the end of the half floats.
float scaleFor(const std::vector<Vdl>& vdls)
{
    float most = 0.0f;
    for (const Vdl& vdl : vdls) most = glm::max(most, maxChannel(vdl.colour));
    return most > 0.0f ? std::exp2(std::ceil(std::log2(most / kMostColour))) : 1.0f;
}

void packVdls(const LightOctree& octree, const std::vector<Vdl>& vdls, GpuOctree& gpu)
{
    gpu.colourScale = scaleFor(vdls);
    gpu.vdls.assign(4 * static_cast<std::size_t>(gpu.vdlWidth) * static_cast<std::size_t>(gpu.vdlHeight), 0);
    std::size_t next = 0; // where the next light goes: an entry's black ones come last, black as halves
    for (std::size_t i = 0; i < vdls.size(); ++i) {
        if (i % static_cast<std::size_t>(gpu.vdlCount) == 0) next = i;
        const std::uint16_t direction = gpu.hasDirections ? packDirection(vdls[i].toLight) : std::uint16_t(0);
        const glm::vec3 n = octree.geometry().entries[i / static_cast<std::size_t>(gpu.vdlCount)].normal;
        // the rounded direction meets the surface at another angle: keep what it gives on the entry's own normal
        const float was = glm::dot(vdls[i].toLight, n), is = glm::dot(unpackDirection(direction), n);
        const float keep = gpu.hasDirections && was > kLeastCosine && is > kLeastCosine ? was / is : 1.0f;
        const glm::vec3 colour = vdls[i].colour * (keep / gpu.colourScale);
        const std::array texel{imath_float_to_half(colour.x), imath_float_to_half(colour.y),
                               imath_float_to_half(colour.z), direction};
        if ((texel[0] | texel[1] | texel[2]) == 0) continue;
        std::ranges::copy(texel, gpu.vdls.begin() + static_cast<std::ptrdiff_t>(4 * next++));
    }
}

void packNormals(const OctreeGeometry& geometry, GpuOctree& gpu)
{
    gpu.normals.assign(2 * static_cast<std::size_t>(gpu.normalWidth) * static_cast<std::size_t>(gpu.normalHeight), 0);
    for (std::size_t e = 0; e < geometry.entries.size(); ++e) {
        const std::uint16_t packed = packDirection(geometry.entries[e].normal);
        gpu.normals[2 * e] = static_cast<std::uint8_t>(packed >> 8);
        gpu.normals[2 * e + 1] = static_cast<std::uint8_t>(packed & 255);
    }
}

void shape(std::uint64_t texels, int& width, int& height)
{
    const std::uint64_t w = std::clamp<std::uint64_t>(
        static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(texels)))), 1, kMostWidth);
    width = static_cast<int>(w);
    height = static_cast<int>(std::max<std::uint64_t>(1, (texels + w - 1) / w));
}

} // namespace

std::optional<glm::ivec3> brickBox(std::uint64_t bricks)
{
    std::optional<glm::ivec3> best;
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (int x = 1; x <= kMostBrickSide; ++x) {
        for (int y = x; y <= kMostBrickSide; ++y) {
            const auto layer = static_cast<std::uint64_t>(x) * static_cast<std::uint64_t>(y);
            const std::uint64_t z = std::max<std::uint64_t>(1, (bricks + layer - 1) / layer);
            if (z > static_cast<std::uint64_t>(kMostBrickSide) || layer * z >= least) continue;
            least = layer * z;
            best = glm::ivec3(x, y, static_cast<int>(z));
        }
    }
    return best;
}

Result<GpuOctree> makeGpuOctree(const LightOctree& octree)
{
    const OctreeGeometry& geometry = octree.geometry();
    GpuOctree gpu;
    gpu.depth = geometry.depth;
    gpu.lowest = geometry.lowest;
    gpu.rootSize = geometry.rootSize;
    gpu.hasDirections = octree.show() == OctreeShow::lights;
    for (const auto& layer : octree.layers()) {
        if (layer && gpu.hasDirections) gpu.vdlCount = std::max(gpu.vdlCount, layer->count);
    }
    gpu.leafCount = geometry.cells.size();
    gpu.entryCount = geometry.entries.size();
    const std::uint64_t texels = gpu.entryCount * static_cast<std::uint64_t>(gpu.vdlCount);
    if (texels > kMostWidth * kMostWidth) {
        return Error{Error::Kind::unsupported,
                     fmt::format("{} entries with {} lights each need {} texels and 24 bits address {}; lower "
                                 "octree.depth or vdl.count",
                                 gpu.entryCount, gpu.vdlCount, texels, kMostWidth * kMostWidth)};
    }
    const BrickBuilder built(geometry);
    const std::optional<glm::ivec3> side = brickBox(built.bricks.size());
    if (!side) {
        return Error{Error::Kind::unsupported,
                     fmt::format("{} octree nodes do not fit a 3D texture of {} bricks a side; lower octree.depth",
                                 built.bricks.size(), kMostBrickSide)};
    }
    gpu.side = *side;
    shape(texels, gpu.vdlWidth, gpu.vdlHeight);
    shape(gpu.entryCount, gpu.normalWidth, gpu.normalHeight);
    layOutBricks(built, gpu);
    packVdls(octree, mixAll(octree, gpu), gpu);
    packNormals(geometry, gpu);
    return gpu;
}

} // namespace lightloom
