// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cornell_walls.h"
#include "core/scene/sample_scenes.h"

namespace lightloom {
namespace {

/// Box on the floor without a bottom, which nothing can see: `foot` counter-clockwise from above, y up.
Mesh blockMesh(const std::array<glm::vec2, 4>& foot, float height)
{
    Mesh mesh;
    for (const glm::vec2 p : foot) mesh.positions.emplace_back(p.x, 0.0f, p.y);
    for (const glm::vec2 p : foot) mesh.positions.emplace_back(p.x, height, p.y);
    mesh.triangles = {{4, 5, 6}, {4, 6, 7}};
    for (unsigned i = 0; i < 4; ++i) {
        const unsigned next = (i + 1) % 4;
        mesh.triangles.emplace_back(i, next, next + 4);
        mesh.triangles.emplace_back(i, next + 4, i + 4);
    }
    return mesh;
}

} // namespace

CornellMaterials addCornellWalls(SceneBuilder& builder)
{
    const CornellMaterials m{
        builder.addMaterial("white", {0.725f, 0.71f, 0.68f}), builder.addMaterial("red", {0.63f, 0.065f, 0.05f}),
        builder.addMaterial("green", {0.14f, 0.45f, 0.091f}), builder.addEmitter("lamp", {340.0f, 238.0f, 80.0f}), 26};
    const auto addQuad = [&](const char* node, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, int material) {
        Mesh mesh;
        mesh.positions = {a, b, c, d};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        builder.add(node, std::move(mesh), material);
    };
    const float top = 0.5488f, back = 0.5592f;
    // the measured box is not square: the left wall leans, the floor is narrower than the ceiling
    addQuad("Room/Floor", {0.5528f, 0, 0}, {0, 0, 0}, {0, 0, back}, {0.5496f, 0, back}, m.white);
    addQuad("Room/Back wall", {0.5496f, 0, back}, {0, 0, back}, {0, top, back}, {0.556f, top, back}, m.white);
    addQuad("Room/Right wall", {0, 0, back}, {0, 0, 0}, {0, top, 0}, {0, top, back}, m.green);
    addQuad("Room/Left wall", {0.5528f, 0, 0}, {0.5496f, 0, back}, {0.556f, top, back}, {0.556f, top, 0}, m.red);
    // the ceiling in nine, the lamp being the middle one: whole edges meet
    const std::array<float, 4> xs{0.0f, 0.213f, 0.343f, 0.556f}, zs{0.0f, 0.227f, 0.332f, back};
    Mesh white, lamp;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3 corner(xs[i], top, zs[k]);
            const glm::vec3 u(xs[i + 1] - corner.x, 0.0f, 0.0f), v(0.0f, 0.0f, zs[k + 1] - corner.z);
            append(i == 1 && k == 1 ? lamp : white, quadMesh(corner, u, v));
        }
    }
    builder.add("Room/Ceiling", std::move(white), m.white);
    builder.add("Ceiling lamp", std::move(lamp), m.lamp);
    return m;
}

void addCornellCameras(SceneBuilder& builder)
{
    builder.addCamera("Front", {0.278f, 0.273f, -0.8f}, {0.278f, 0.273f, 0.28f}, 39.3f);
    builder.addCamera("Past the blocks", {0.1f, 0.4f, -0.3f}, {0.4f, 0.15f, 0.4f}, 55.0f);
    builder.addCamera("From above", {0.278f, 0.53f, 0.03f}, {0.278f, 0.0f, 0.4f}, 70.0f);
}

Scene cornellBox()
{
    SceneBuilder builder("cornell");
    const CornellMaterials m = addCornellWalls(builder);
    using Foot = std::array<glm::vec2, 4>;
    const Foot low{{{0.130f, 0.065f}, {0.082f, 0.225f}, {0.240f, 0.272f}, {0.290f, 0.114f}}};
    const Foot high{{{0.423f, 0.247f}, {0.265f, 0.296f}, {0.314f, 0.456f}, {0.472f, 0.406f}}};
    builder.add("Short block", blockMesh(low, 0.165f), m.white);
    builder.add("Tall block", blockMesh(high, 0.330f), m.white);
    addCornellCameras(builder);
    builder.setExposure(2.5f);
    return builder.finish();
}

} // namespace lightloom
