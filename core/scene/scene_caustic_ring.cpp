// SPDX-License-Identifier: Apache-2.0
#include "core/base/units.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"

namespace lightloom {
namespace {

constexpr glm::vec3 kRing(0.12f, 0.0f, 0.06f), kBall(-0.34f, 0.1305f, 0.27f); ///< foot; centre, .5 mm off the table
constexpr glm::vec3 kLamp(-0.58f, 0.62f, -0.28f);
constexpr float kPanel = 0.16f, kLumen = 400.0f;

/// A square panel that shines towards `aim`.
Mesh panelMesh(glm::vec3 centre, glm::vec3 aim, float side)
{
    const glm::vec3 n = glm::normalize(aim - centre), u = glm::normalize(glm::cross(n, glm::vec3(0.0f, 1.0f, 0.0f)));
    const glm::vec3 v = glm::cross(n, u);
    return quadMesh(centre - 0.5f * side * (u + v), side * u, side * v);
}

} // namespace

Scene causticRing()
{
    SceneBuilder builder("caustic ring");
    builder.add("Table", quadMesh({-0.6f, 0.0f, -0.6f}, {0.0f, 0.0f, 1.2f}, {1.2f, 0.0f, 0.0f}),
                builder.addMaterial("beech", {0.55f, 0.44f, 0.33f}));
    builder.add("Wall", quadMesh({-0.6f, 0.0f, -0.6f}, {1.2f, 0.0f, 0.0f}, {0.0f, 0.9f, 0.0f}),
                builder.addMaterial("blue wall", {0.30f, 0.38f, 0.48f}));
    const glm::vec3 sunk(0.0f, -0.002f, 0.0f); // so that no face lies in the table's plane
    builder.add("Ring", bandMesh(kRing + sunk, 0.24f, 0.25f, 0.152f, 240),
                builder.addMetal("polished brass", {0.91f, 0.78f, 0.42f}, 0.0f));
    builder.add("Ball", sphereMesh(kBall, 0.13f, 48), builder.addGlass("glass", 1.5f, {0.86f, 0.95f, 0.90f}, 0.3f));
    const float luminance = kLumen / (kPi * kPanel * kPanel);
    builder.add("Lamps/Panel", panelMesh(kLamp, {0.0f, 0.0f, 0.1f}, kPanel),
                builder.addEmitter("panel", tinted({1.0f, 0.93f, 0.82f}, luminance)));
    builder.addCamera("Overview", {-0.03f, 0.98f, 1.10f}, {-0.03f, 0.0f, 0.08f}, 40.0f);
    builder.addCamera("Ring from above", {0.12f, 0.75f, 0.40f}, {0.14f, 0.0f, 0.08f}, 40.0f);
    builder.addCamera("Focus", {-0.15f, 0.45f, 0.90f}, {-0.30f, 0.04f, 0.36f}, 40.0f);
    builder.setExposure(5.0f);
    return builder.finish();
}

} // namespace lightloom
