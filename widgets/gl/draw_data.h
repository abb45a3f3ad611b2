// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/scene/scene.h"
#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

namespace lightloom {

struct DrawVertex {
    glm::vec3 position, normal;
    glm::vec4 uv;     ///< set 0, set 1
    glm::vec4 colour; ///< linear, multiplies the base colour
};

/// One light of the direct preview: a punctual lamp, or a patch of a shining surface.
struct PreviewLight {
    int kind = 0;                        ///< kLampPoint.. of shaders/shared_limits.glsl
    int group = 0;                       ///< light group
    glm::vec3 position{0.0f};            ///< scene space
    glm::vec3 travel{0.0f, -1.0f, 0.0f}; ///< spot axis, sun, or normal of the patch
    glm::vec3 colour{0.0f};              ///< cd, lux (sun) or cd/m2 (patch), at gain 1
    float cosInner = 1.0f, cosOuter = 0.0f;
    float area = 0.0f;  ///< of a patch, m2
    bool inCube = true; ///< shadow in six layers, or (spot, sun) in one
    struct Point {
        glm::vec3 position, travel;
    };
    /// Of a patch: equal parts of it, any first few of them well spread. Null: it has no extent.
    std::shared_ptr<const std::vector<Point>> points;
};

/// A scene as plain arrays that a viewport uploads as they are. Made on a worker, never changed afterwards.
struct DrawData {
    struct Range {
        std::uint32_t first = 0, count = 0; ///< indices
    };
    std::shared_ptr<const Scene> scene;
    SharedList<DrawVertex> vertices;
    SharedList<std::uint32_t> indices;
    std::vector<Range> meshes;        ///< as Scene::meshes
    std::vector<PreviewLight> lights; ///< punctual lamps, then patches of surfaces
    int shiningSurfaces = 0;          ///< that have patches
    int patchesEach = 0;              ///< that a surface may have
    std::string lampMessage;          ///< what the preview of direct light leaves out; empty: nothing
};

/// Meshes without normals get flat ones. Shining surfaces become up to 8 patches, fewer where many lamps share the
/// shadow maps; lamps beyond 16 are left out and named in `lampMessage`.
[[nodiscard]] std::shared_ptr<const DrawData> makeDrawData(std::shared_ptr<const Scene> scene);

/// The same for an edit of the scene's punctual lamps: everything else is shared, the patches of surfaces stay. Quick,
/// but where a cone becomes so wide or narrow that the patches must share the shadow maps anew.
[[nodiscard]] std::shared_ptr<const DrawData> withLamps(const DrawData& data, std::shared_ptr<const Scene> scene);

} // namespace lightloom
