// SPDX-License-Identifier: Apache-2.0
#include "core/bake/gpu_layout.h"
#include "core/base/units.h"
#include "core/octree/detail_union.h"
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

constexpr std::uint8_t kNode = 1, kSplit = 255; ///< alpha

/// Turns sorted leaf codes into bricks, depth first, the root brick first.
class BrickBuilder {
public:
    explicit BrickBuilder(const LightOctree& octree)
    {
        levels_.push_back({&octree.geometry(), 0});
        for (const UnionLevel& level : octree.deeper()) {
            const Level& above = levels_.back();
            levels_.push_back(
                {&level.geometry, above.firstEntry + static_cast<std::uint32_t>(above.geometry->entries.size())});
        }
        const OctreeGeometry& geometry = octree.geometry();
        const std::uint32_t root = newBrick();
        if (!geometry.cells.empty()) fill(root, 0, geometry.cells.size(), 0);
    }

    std::vector<Brick> bricks;
    std::vector<std::array<std::uint32_t, 8>> children; ///< brick number of texels that point to one; 0: none

private:
    struct Level {
        const OctreeGeometry* geometry;
        std::uint32_t firstEntry; ///< number of its first entry among all levels'
    };

    std::uint32_t newBrick()
    {
        bricks.emplace_back();
        children.emplace_back();
        return static_cast<std::uint32_t>(bricks.size() - 1);
    }

    void point(std::uint32_t brick, std::size_t octant, std::uint8_t alpha, std::uint32_t to)
    {
        children[brick][octant] = to;
        bricks[brick][octant].a = alpha;
    }

    /// Leaves [first, last) of the octree's own depth lie in the node at `level`.
    void fill(std::uint32_t brick, std::size_t first, std::size_t last, int level)
    {
        const OctreeGeometry& geometry = *levels_[0].geometry;
        const int shift = 3 * (geometry.depth - 1 - level);
        while (first < last) {
            const std::uint64_t child = geometry.cells[first] >> shift;
            std::size_t end = first + 1;
            while (end < last && geometry.cells[end] >> shift == child) ++end;
            const std::size_t octant = child & 7;
            if (level + 1 == geometry.depth) {
                putLeaf(brick, octant, 0, first);
            } else {
                const std::uint32_t node = newBrick();
                point(brick, octant, kNode, node);
                fill(node, first, end, level + 1);
            }
            first = end;
        }
    }

    /// Leaf `i` of levels_[level], and what it is split into.
    void putLeaf(std::uint32_t brick, std::size_t octant, std::size_t level, std::size_t i)
    {
        const OctreeGeometry& geometry = *levels_[level].geometry;
        if (level + 1 < levels_.size()) {
            const std::vector<std::uint64_t>& below = levels_[level + 1].geometry->cells;
            const std::uint64_t cell = geometry.cells[i];
            auto child = std::ranges::lower_bound(below, cell << 3);
            if (child != below.end() && *child >> 3 == cell) {
                const std::uint32_t self = newBrick(), node = newBrick();
                point(brick, octant, kSplit, self);
                point(self, 1, kNode, node);
                for (; child != below.end() && *child >> 3 == cell; ++child)
                    putLeaf(node, *child & 7, level + 1, static_cast<std::size_t>(child - below.begin()));
                brick = self, octant = 0;
            }
        }
        const std::uint32_t entry = levels_[level].firstEntry + geometry.firstEntry[i];
        const std::uint32_t count = geometry.firstEntry[i + 1] - geometry.firstEntry[i];
        bricks[brick][octant] = {static_cast<std::uint8_t>(entry), static_cast<std::uint8_t>(entry >> 8),
                                 static_cast<std::uint8_t>(entry >> 16), static_cast<std::uint8_t>(count + 1)};
    }

    std::vector<Level> levels_;
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
            if (texel.a == kNode || texel.a == kSplit) {
                const glm::uvec3 child = place(built.children[b][i]);
                texel = {static_cast<std::uint8_t>(child.x), static_cast<std::uint8_t>(child.y),
                         static_cast<std::uint8_t>(child.z), texel.a};
            }
            const glm::uvec3 at = corner + glm::uvec3(i & 1, i >> 1 & 1, i >> 2 & 1);
            std::uint8_t* out = gpu.bricks.data() + 4 * ((at.z * down + at.y) * across + at.x);
            out[0] = texel.r, out[1] = texel.g, out[2] = texel.b, out[3] = texel.a;
        }
    }
}

/// Visits every entry in the order of their numbers: those of the octree's own depth first, then level by level.
template<class Visit>
void forEntries(const LightOctree& octree, const Visit& visit)
{
    for (std::size_t e = 0; e < octree.geometry().entries.size(); ++e) visit(LightOctree::At{e, 0});
    for (std::size_t level = 0; level < octree.deeper().size(); ++level) {
        const std::size_t count = octree.deeper()[level].geometry.entries.size();
        for (std::size_t e = 0; e < count; ++e) visit(LightOctree::At{e, level + 1});
    }
}

/// What every entry holds under the mix, `gpu.vdlCount` each.
std::vector<Vdl> mixAll(const LightOctree& octree, const GpuOctree& gpu)
{
    std::vector<Vdl> all;
    all.reserve(gpu.entryCount * static_cast<std::size_t>(gpu.vdlCount));
    forEntries(octree, [&](LightOctree::At at) {
        if (!gpu.hasDirections) {
            all.push_back({octree.mixedColour(at), octree.surface(at).normal});
            return;
        }
        const std::vector<Vdl> some = octree.mixed(at, gpu.vdlCount);
        all.insert(all.end(), some.begin(), some.end());
    });
    return all;
}

std::vector<glm::vec3> normalsOf(const LightOctree& octree)
{
    std::vector<glm::vec3> normals;
    forEntries(octree, [&](LightOctree::At at) { normals.push_back(octree.surface(at).normal); });
    return normals;
}

/// Power of two that brings the brightest colour just below the end of the half floats.
float scaleFor(const std::vector<Vdl>& vdls)
{
    float most = 0.0f;
    for (const Vdl& vdl : vdls) most = glm::max(most, maxChannel(vdl.colour));
    return most > 0.0f ? std::exp2(std::ceil(std::log2(most / kMostColour))) : 1.0f;
}

void packVdls(const std::vector<glm::vec3>& normals, const std::vector<Vdl>& vdls, GpuOctree& gpu)
{
    gpu.colourScale = scaleFor(vdls);
    gpu.vdls.assign(4 * static_cast<std::size_t>(gpu.vdlWidth) * static_cast<std::size_t>(gpu.vdlHeight), 0);
    std::size_t next = 0; // where the next light goes: an entry's black ones come last, black as halves
    for (std::size_t i = 0; i < vdls.size(); ++i) {
        if (i % static_cast<std::size_t>(gpu.vdlCount) == 0) next = i;
        const std::uint16_t direction = gpu.hasDirections ? packDirection(vdls[i].toLight) : std::uint16_t(0);
        const glm::vec3 n = normals[i / static_cast<std::size_t>(gpu.vdlCount)];
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

void packNormals(const std::vector<glm::vec3>& normals, GpuOctree& gpu)
{
    gpu.normals.assign(2 * static_cast<std::size_t>(gpu.normalWidth) * static_cast<std::size_t>(gpu.normalHeight), 0);
    for (std::size_t e = 0; e < normals.size(); ++e) {
        const std::uint16_t packed = packDirection(normals[e]);
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
    gpu.deepest = geometry.depth + static_cast<int>(octree.deeper().size());
    gpu.lowest = geometry.lowest;
    gpu.rootSize = geometry.rootSize;
    gpu.hasDirections = octree.show() == OctreeShow::lights;
    for (const auto& layer : octree.layers()) {
        if (layer && gpu.hasDirections) gpu.vdlCount = std::max(gpu.vdlCount, layer->count);
    }
    gpu.leafCount = geometry.cells.size();
    gpu.entryCount = geometry.entries.size();
    for (const UnionLevel& level : octree.deeper()) {
        gpu.leafCount += level.geometry.cells.size();
        gpu.entryCount += level.geometry.entries.size();
    }
    const std::uint64_t texels = gpu.entryCount * static_cast<std::uint64_t>(gpu.vdlCount);
    if (texels > kMostWidth * kMostWidth) {
        return Error{Error::Kind::unsupported,
                     fmt::format("{} entries with {} lights each need {} texels and 24 bits address {}; lower "
                                 "octree.depth, octree.detail or vdl.count",
                                 gpu.entryCount, gpu.vdlCount, texels, kMostWidth * kMostWidth)};
    }
    const BrickBuilder built(octree);
    const std::optional<glm::ivec3> side = brickBox(built.bricks.size());
    if (!side) {
        return Error{
            Error::Kind::unsupported,
            fmt::format(
                "{} octree nodes do not fit a 3D texture of {} bricks a side; lower octree.depth or octree.detail",
                built.bricks.size(), kMostBrickSide)};
    }
    gpu.side = *side;
    shape(texels, gpu.vdlWidth, gpu.vdlHeight);
    shape(gpu.entryCount, gpu.normalWidth, gpu.normalHeight);
    layOutBricks(built, gpu);
    const std::vector<glm::vec3> normals = normalsOf(octree);
    packVdls(normals, mixAll(octree, gpu), gpu);
    packNormals(normals, gpu);
    return gpu;
}

} // namespace lightloom
