// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/octree/light_octree.h"
#include <array>
#include <cstdint>
#include <optional>

namespace lightloom {

/// A light octree as the plain arrays that textures are made from: the mixture of all layers under the octree's mix.
/// Form after the 2007 paper, section 4.2.1 and figures 7 and 8 (METHODS section 3, GPU form).
///
/// `bricks` is a 3D texture RGBA8UI of 2x2x2 bricks. Brick b stands at brick coordinates
/// (b % side.x, b / side.x % side.y, b / (side.x * side.y)); its texel for child (x,y,z) lies at 2 * those + (x,y,z).
/// The root is brick 0. A texel's A: 0 empty, 1 node (RGB = brick coordinates of the child), 2..33 leaf with A - 1
/// entries (R + 256 G + 65536 B = number of its first entry), 255 leaf that is split further (RGB = brick coordinates
/// of a brick that holds the leaf itself at (0,0,0) and at (1,0,0) a node with its children). Entries
/// are ordered by the lights of their leaf: first come classEnds[0] without, up to classEnds[1] those with one light
/// each, and so on; their texels in `vdls` stand one after the other, texel `number` at (number % vdlWidth,
/// number / vdlWidth), black ones last within an entry (RGBA16UI: colour as half floats, times `colourScale` gives lux;
/// direction in the fourth as theta 8 bits high, phi 8 bits low). Entry e has one texel in `normals` (RGBA8UI: theta,
/// phi; the two bytes of its side, see entry_side.h), at (e % normalWidth, e / normalWidth).
///
/// A colour octree (OctreeShow::colour) has one texel per entry, its accumulated illuminance, and no directions. Where
/// part of an entry's light counts whatever the normal (LightOctree::flatShare), its first texel is that, without
/// direction.
struct GpuOctree {
    int depth = 0;
    int deepest = 0;                ///< of any leaf; `depth` where none is split
    glm::vec3 lowest{0.0f};         ///< corner of the root cell, scene space
    float rootSize = 1.0f;          ///< side of the root cell, metres
    glm::ivec3 side{1};             ///< bricks per axis of `bricks`, at most 128; the texture has 2 * side texels
    int vdlCount = 1;               ///< most lights of an entry
    std::array<int, 9> classEnds{}; ///< entries of leaves with at most 0, 1, ... 8 lights an entry
    bool hasDirections = true;      ///< false: a colour octree
    bool isFirstFlat = false;       ///< an entry's first texel has no direction, others have
    float colourScale = 1.0f;       ///< power of two that keeps colours within half floats
    int vdlWidth = 1, vdlHeight = 1, normalWidth = 1, normalHeight = 1;
    std::vector<std::uint8_t> bricks;  ///< 4 * 8 side.x side.y side.z
    std::vector<std::uint16_t> vdls;   ///< 4 * vdlWidth * vdlHeight
    std::vector<std::uint8_t> normals; ///< 4 * normalWidth * normalHeight
    std::uint64_t leafCount = 0, entryCount = 0;
    [[nodiscard]] std::size_t memoryBytes() const { return bricks.size() + 2 * vdls.size() + normals.size(); }
};

/// Errors: more entries or bricks than 24 bits address (says how many, and which parameter to lower).
[[nodiscard]] Result<GpuOctree> makeGpuOctree(const LightOctree& octree);

/// The smallest box of at least `bricks` bricks, at most 128 a side; nothing if there is none.
[[nodiscard]] std::optional<glm::ivec3> brickBox(std::uint64_t bricks);

} // namespace lightloom
