// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"
#include <functional>

/// Simple bodies as meshes, metres, +Y up. Counter-clockwise from the side they face. Flat bodies come without normals
/// (flat shaded) and share vertices, so that closed ones are watertight; `material` is set by whoever places them.
namespace lightloom {

enum class Facing { out, in }; ///< where the front of a closed body looks: in is a room

/// Parallelogram `corner + s u + t v`, s and t in [0,1], facing u x v.
[[nodiscard]] Mesh quadMesh(glm::vec3 corner, glm::vec3 u, glm::vec3 v);
/// The same with texture coordinates: (0, 1) at the corner (images have row 0 on top), `repeats` images along u and v.
[[nodiscard]] Mesh texturedQuadMesh(glm::vec3 corner, glm::vec3 u, glm::vec3 v, glm::vec2 repeats = glm::vec2(1.0f));

/// Closed box, 12 triangles on 8 vertices.
[[nodiscard]] Mesh boxMesh(glm::vec3 low, glm::vec3 high, Facing facing = Facing::out);

/// Closed sphere with vertices on the sphere and smooth normals; `rings` quads from pole to pole (at least 2), twice as
/// many around. The facets lie inside the sphere: area and volume are a little small.
[[nodiscard]] Mesh sphereMesh(glm::vec3 centre, float radius, int rings, Facing facing = Facing::out);

/// Closed upright cylinder: smooth mantle (`segments` quads, at least 3) and two flat caps.
[[nodiscard]] Mesh cylinderMesh(glm::vec3 foot, float radius, float height, int segments);

/// Closed upright band, a ring with a rectangular section: smooth mantles inside and outside, flat rims.
[[nodiscard]] Mesh bandMesh(glm::vec3 foot, float inner, float outer, float height, int segments);

/// Closed torus around `axis` (unit), smooth.
[[nodiscard]] Mesh torusMesh(glm::vec3 centre, glm::vec3 axis, float radius, float tube, int segments,
                             int tubeSegments);

/// Adds the triangles of `part` to `mesh`; both have the same kinds of vertex data, or `mesh` is empty.
void append(Mesh& mesh, const Mesh& part);

/// Rooms, walls and openings as one clean shell. The planes `xs`, `ys`, `zs` (rising) cut space into cells; a cell is
/// air or solid. Faces appear where air meets solid and look into the air; neighbours share whole edges, so the shell
/// has no gaps and no vertex on another's edge.
struct CellPlan {
    std::vector<float> xs, ys, zs;
    std::function<bool(glm::vec3 centre)> isAir;                                ///< of a cell
    bool airOutside = false;                                                    ///< beyond the outermost planes
    std::function<int(glm::vec3 faceCentre, glm::vec3 normal)> materialOf = {}; ///< none: material 0
};
/// One mesh per material used, in order of material number.
[[nodiscard]] std::vector<Mesh> cellShell(const CellPlan& plan);

/// Area of all triangles, m2.
[[nodiscard]] double areaOf(const Mesh& mesh);
/// Signed volume, m3: positive for a closed mesh that faces out.
[[nodiscard]] double volumeOf(const Mesh& mesh);

} // namespace lightloom
