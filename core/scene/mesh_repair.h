// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"

/// Puts meshes as files have them into the shape that Mesh promises.
namespace lightloom {

/// Removes triangles without area: a corner twice, or corners on one line (sine of the widest angle below 1e-10, which
/// no float coordinates resolve). Returns how many. Needle triangles with an area stay.
std::uint64_t dropFlatTriangles(Mesh& mesh);

/// Removes vertices that no triangle uses and renumbers.
void dropUnusedVertices(Mesh& mesh);

/// Makes normals unit; a normal without length becomes the mean of its triangles' own. Tangents become unit too; one
/// without length drops them all, since nobody could shade with the rest.
void completeNormals(Mesh& mesh);

} // namespace lightloom
