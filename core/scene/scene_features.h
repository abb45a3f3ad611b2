// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"
#include "core/scene/thin_walls.h"
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lightloom {

/// Least and greatest of a photometric value, over what gives any light at all.
struct LightRange {
    float least = 0.0f, most = 0.0f;
};

/// What a scene holds, and with it what it needs: bakes skip what is absent (`follows` says so in words).
struct SceneFeatures {
    std::uint64_t triangles = 0;       ///< instances counted each
    std::uint64_t storedTriangles = 0; ///< of the meshes
    std::uint64_t instances = 0, meshes = 0, materials = 0, images = 0, cameras = 0, groups = 0;
    Bounds bounds;     ///< scene space; add Scene::origin for the file's
    double area = 0.0; ///< m2 of all triangles, one side

    /// A body is what one node holds. Closed: every edge, vertices welded at 1e-5 of its size, has its partner.
    std::uint64_t bodies = 0, closedBodies = 0;
    std::optional<bool> isWatertight; ///< all bodies taken together close; nothing: too many triangles to look
    ThinWallSearch walls;

    std::uint64_t pointLamps = 0, spotLamps = 0, suns = 0, glowingInstances = 0;
    std::uint64_t darkLamps = 0;            ///< of these lamps, how many have intensity 0
    std::optional<LightRange> candela, lux; ///< luminous intensity of point and spot lamps; illuminance from suns
    std::optional<LightRange> luminance;    ///< cd/m2 of glowing surfaces, before their textures

    // of materials that some instance wears
    bool hasMirrors = false;     ///< metal smoother than kMirrorRoughness
    bool hasGlossyMetal = false; ///< any other metal
    bool hasGlass = false;       ///< solid: bends light
    bool hasPanes = false;       ///< thin glass: light goes straight through
    bool hasTextures = false;    ///< that light sees: base colour, metal and roughness, emission
    bool hasCutouts = false;     ///< alpha masks
    [[nodiscard]] bool hasSpecular() const { return hasMirrors || hasGlossyMetal || hasGlass || hasPanes; }
    [[nodiscard]] std::uint64_t emitters() const
    {
        return pointLamps + spotLamps + suns + glowingInstances - darkLamps;
    }

    std::vector<std::string> follows; ///< one sentence each
};

/// Looks `scene` over. Deterministic; linear in the triangles, about 1 s per million plus the search for thin walls.
[[nodiscard]] SceneFeatures findFeatures(const Scene& scene);

} // namespace lightloom
