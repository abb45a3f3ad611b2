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

/// Calls visit(geometry, level) for the octree's own depth and for each deeper one.
template<class Visit>
void forLevels(const LightOctree& octree, const Visit& visit)
{
    visit(octree.geometry(), std::size_t(0));
    for (std::size_t level = 0; level < octree.deeper().size(); ++level)
        visit(octree.deeper()[level].geometry, level + 1);
}

/// What every entry holds under the mix, in the order of levels, leaves and entries.
struct MixedLights {
    std::vector<Vdl> vdls;
    std::vector<std::size_t> first; ///< of each entry, and the end
};

MixedLights mixAll(const LightOctree& octree, const GpuOctree& gpu)
{
    MixedLights all;
    all.first.reserve(gpu.entryCount + 1);
    all.vdls.reserve(gpu.entryCount * static_cast<std::size_t>(gpu.vdlCount));
    forLevels(octree, [&](const OctreeGeometry& geometry, std::size_t level) {
        for (std::size_t e = 0; e < geometry.entries.size(); ++e) {
            all.first.push_back(all.vdls.size());
            if (!gpu.hasDirections) {
                all.vdls.push_back({octree.mixedColour({e, level}), geometry.entries[e].normal});
                continue;
            }
            if (gpu.isFirstFlat)
                all.vdls.push_back({octree.flatShare() * octree.mixedColour({e, level}), geometry.entries[e].normal});
            const std::vector<Vdl> some = octree.mixed({e, level}, gpu.vdlCount - (gpu.isFirstFlat ? 1 : 0));
            all.vdls.insert(all.vdls.end(), some.begin(), some.end());
        }
    });
    all.first.push_back(all.vdls.size());
    return all;
}

/// Numbers of entries in the arrays: leaves by the most lights that an entry of theirs has.
struct EntryOrder {
    std::vector<std::vector<std::uint32_t>> firstEntry; ///< by level and leaf
    std::vector<std::size_t> entries;                   ///< by number: its place among MixedLights
    std::vector<OctreeEntry> surfaces;                  ///< by number
    std::array<int, 9> classEnds{};
    std::uint64_t texels = 0;
};

EntryOrder orderEntries(const LightOctree& octree, const MixedLights& mixed)
{
    EntryOrder order;
    std::vector<std::vector<std::uint8_t>> classes;
    std::size_t place = 0;
    forLevels(octree, [&](const OctreeGeometry& g, std::size_t) {
        std::vector<std::uint8_t>& of = classes.emplace_back();
        for (std::size_t i = 0; i < g.cells.size(); ++i) {
            std::size_t most = 0;
            for (std::uint32_t e = g.firstEntry[i]; e < g.firstEntry[i + 1]; ++e, ++place)
                most = std::max(most, mixed.first[place + 1] - mixed.first[place]);
            of.push_back(static_cast<std::uint8_t>(most));
        }
        order.firstEntry.emplace_back(g.cells.size());
    });
    for (std::size_t lights = 0; lights < order.classEnds.size(); ++lights) {
        const std::size_t before = order.entries.size();
        std::size_t levelFirst = 0; // place of the level's first entry
        forLevels(octree, [&](const OctreeGeometry& g, std::size_t level) {
            for (std::size_t i = 0; i < g.cells.size(); ++i) {
                if (classes[level][i] != lights) continue;
                order.firstEntry[level][i] = static_cast<std::uint32_t>(order.entries.size());
                for (std::uint32_t e = g.firstEntry[i]; e < g.firstEntry[i + 1]; ++e) {
                    order.entries.push_back(levelFirst + e);
                    order.surfaces.push_back(g.entries[e]);
                }
            }
            levelFirst += g.entries.size();
        });
        order.classEnds[lights] = static_cast<int>(order.entries.size());
        order.texels += lights * (order.entries.size() - before);
    }
    return order;
}

constexpr std::uint8_t kNode = 1, kSplit = 255; ///< alpha

/// Turns sorted leaf codes into bricks, depth first, the root brick first.
class BrickBuilder {
public:
    BrickBuilder(const LightOctree& octree, const EntryOrder& order)
    {
        forLevels(octree, [&](const OctreeGeometry& geometry, std::size_t level) {
            levels_.push_back({&geometry, &order.firstEntry[level]});
        });
        const OctreeGeometry& geometry = octree.geometry();
        const std::uint32_t root = newBrick();
        if (!geometry.cells.empty()) fill(root, 0, geometry.cells.size(), 0);
    }

    std::vector<Brick> bricks;
    std::vector<std::array<std::uint32_t, 8>> children; ///< brick number of texels that point to one; 0: none

private:
    struct Level {
        const OctreeGeometry* geometry;
        const std::vector<std::uint32_t>* firstEntry; ///< of each leaf
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
        const std::uint32_t entry = (*levels_[level].firstEntry)[i];
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

/// Power of two that brings the brightest colour just below the end of the half floats.
float scaleFor(const std::vector<Vdl>& vdls)
{
    float most = 0.0f;
    for (const Vdl& vdl : vdls) most = glm::max(most, maxChannel(vdl.colour));
    return most > 0.0f ? std::exp2(std::ceil(std::log2(most / kMostColour))) : 1.0f;
}

void packVdls(const MixedLights& mixed, const EntryOrder& order, GpuOctree& gpu)
{
    gpu.colourScale = scaleFor(mixed.vdls);
    gpu.vdls.assign(4 * static_cast<std::size_t>(gpu.vdlWidth) * static_cast<std::size_t>(gpu.vdlHeight), 0);
    std::size_t lights = 0, texels = 0; // of the class; of the entries so far
    for (std::size_t number = 0; number < order.entries.size(); ++number) {
        while (number >= static_cast<std::size_t>(order.classEnds[lights])) ++lights;
        std::size_t next = texels; // an entry's black ones come last, black as halves
        const std::size_t e = order.entries[number];
        for (std::size_t i = mixed.first[e]; i < mixed.first[e + 1]; ++i) {
            const Vdl& vdl = mixed.vdls[i];
            const bool isAimed = gpu.hasDirections && !(gpu.isFirstFlat && i == mixed.first[e]);
            const std::uint16_t direction = isAimed ? packDirection(vdl.toLight) : std::uint16_t(0);
            // the rounded direction meets the surface at another angle: keep what it gives on the entry's own normal
            const glm::vec3 n = order.surfaces[number].normal;
            const float was = glm::dot(vdl.toLight, n), is = glm::dot(unpackDirection(direction), n);
            const float keep = isAimed && was > kLeastCosine && is > kLeastCosine ? was / is : 1.0f;
            const glm::vec3 colour = vdl.colour * (keep / gpu.colourScale);
            const std::array texel{imath_float_to_half(colour.x), imath_float_to_half(colour.y),
                                   imath_float_to_half(colour.z), direction};
            if ((texel[0] | texel[1] | texel[2]) == 0) continue;
            std::ranges::copy(texel, gpu.vdls.begin() + static_cast<std::ptrdiff_t>(4 * next++));
        }
        texels += lights;
    }
}

void packNormals(const std::vector<OctreeEntry>& surfaces, GpuOctree& gpu)
{
    gpu.normals.assign(4 * static_cast<std::size_t>(gpu.normalWidth) * static_cast<std::size_t>(gpu.normalHeight), 0);
    auto out = gpu.normals.begin();
    for (const OctreeEntry& surface : surfaces) {
        for (const std::uint32_t bytes : {std::uint32_t(packDirection(surface.normal)), surface.side})
            *out++ = static_cast<std::uint8_t>(bytes >> 8), *out++ = static_cast<std::uint8_t>(bytes & 255);
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
    gpu.isFirstFlat = octree.flatShare() > 0.0f;
    if (gpu.isFirstFlat) ++gpu.vdlCount;
    gpu.leafCount = geometry.cells.size();
    gpu.entryCount = geometry.entries.size();
    for (const UnionLevel& level : octree.deeper()) {
        gpu.leafCount += level.geometry.cells.size();
        gpu.entryCount += level.geometry.entries.size();
    }
    const auto tooMany = [&](std::uint64_t texels) {
        return Error{Error::Kind::unsupported,
                     fmt::format("{} entries with up to {} lights each need {} texels and 24 bits address {}; lower "
                                 "octree.depth, octree.detail or vdl.count",
                                 gpu.entryCount, gpu.vdlCount, texels, kMostWidth * kMostWidth)};
    };
    // before anything is mixed: an adaptive octree may need less than it could, others need it all
    const bool isAdaptive =
        std::ranges::any_of(octree.layers(), [](const auto& layer) { return layer && layer->tolerance > 0.0f; });
    const std::uint64_t couldNeed = gpu.entryCount * static_cast<std::uint64_t>(isAdaptive ? 1 : gpu.vdlCount);
    if (couldNeed > kMostWidth * kMostWidth) return tooMany(couldNeed);
    const MixedLights mixed = mixAll(octree, gpu);
    const EntryOrder order = orderEntries(octree, mixed);
    if (order.texels > kMostWidth * kMostWidth) return tooMany(order.texels);
    gpu.classEnds = order.classEnds;
    const BrickBuilder built(octree, order);
    const std::optional<glm::ivec3> side = brickBox(built.bricks.size());
    if (!side) {
        return Error{
            Error::Kind::unsupported,
            fmt::format(
                "{} octree nodes do not fit a 3D texture of {} bricks a side; lower octree.depth or octree.detail",
                built.bricks.size(), kMostBrickSide)};
    }
    gpu.side = *side;
    shape(order.texels, gpu.vdlWidth, gpu.vdlHeight);
    shape(gpu.entryCount, gpu.normalWidth, gpu.normalHeight);
    layOutBricks(built, gpu);
    packVdls(mixed, order, gpu);
    packNormals(order.surfaces, gpu);
    return gpu;
}

} // namespace lightloom
