// SPDX-License-Identifier: Apache-2.0
#include "core/base/units.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"

namespace lightloom {
namespace {

constexpr float kWallA = 4.0f, kWallB = 4.2f; // the dividing wall, x
constexpr float kDoorLow = 1.4f, kDoorHigh = 2.5f, kDoorTop = 2.2f;

void addShell(SceneBuilder& builder)
{
    const int floor = builder.addMaterial("oak floor", {0.42f, 0.30f, 0.19f});
    const int ceiling = builder.addMaterial("white ceiling", glm::vec3(0.80f));
    const int wallsA = builder.addMaterial("cream walls", {0.74f, 0.71f, 0.65f});
    const int wallsB = builder.addMaterial("blue walls", {0.56f, 0.66f, 0.74f});
    const int jamb = builder.addMaterial("door lining", {0.62f, 0.60f, 0.57f});
    CellPlan plan;
    plan.xs = {0.0f, kWallA, kWallB, 8.2f};
    plan.ys = {0.0f, kDoorTop, 2.8f};
    plan.zs = {0.0f, kDoorLow, kDoorHigh, 4.0f};
    plan.isAir = [](glm::vec3 p) {
        const bool inWall = p.x > kWallA && p.x < kWallB;
        return !inWall || (p.y < kDoorTop && p.z > kDoorLow && p.z < kDoorHigh);
    };
    plan.materialOf = [=](glm::vec3 p, glm::vec3 n) {
        if (n.y > 0.0f) return floor;
        if (p.x > kWallA && p.x < kWallB) return jamb;
        if (n.y < 0.0f) return ceiling;
        return p.x <= kWallA ? wallsA : wallsB;
    };
    for (Mesh& mesh : cellShell(plan)) {
        const int material = mesh.material;
        const std::array<const char*, 5> names{"Rooms/Floor", "Rooms/Ceiling", "Rooms/Walls A", "Rooms/Walls B",
                                               "Rooms/Door opening"};
        builder.add(names[static_cast<std::size_t>(material)], std::move(mesh), material);
    }
}

/// Stands a little in the floor, so that no face lies in the floor's own plane.
constexpr float kSunk = -0.005f;

void addFurniture(SceneBuilder& builder)
{
    const int wood = builder.addMaterial("walnut", {0.35f, 0.22f, 0.13f});
    const int fabric = builder.addMaterial("green fabric", {0.30f, 0.45f, 0.28f});
    const int white = builder.addMaterial("white lacquer", glm::vec3(0.78f));
    Mesh table = boxMesh({1.3f, 0.71f, 1.6f}, {2.7f, 0.75f, 2.4f});
    for (const float x : {1.36f, 2.58f}) {
        for (const float z : {1.66f, 2.28f}) append(table, boxMesh({x, kSunk, z}, {x + 0.06f, 0.715f, z + 0.06f}));
    }
    builder.add("Furniture/Table", std::move(table), wood);
    builder.add("Furniture/Sofa", boxMesh({5.2f, kSunk, 3.05f}, {7.2f, 0.42f, 3.9f}), fabric);
    builder.add("Furniture/Sofa back", boxMesh({5.2f, kSunk, 3.72f}, {7.2f, 0.82f, 3.95f}), fabric);
    builder.add("Furniture/Cupboard", boxMesh({7.6f, kSunk, 0.3f}, {8.15f, 1.1f, 1.9f}), white);
    builder.add("Furniture/Vase", sphereMesh({7.85f, 1.25f, 0.9f}, 0.155f, 16),
                builder.addMaterial("red clay", {0.60f, 0.20f, 0.12f}));
}

void addLamps(SceneBuilder& builder)
{
    const glm::vec3 warm(1.0f, 0.80f, 0.58f);
    builder.addPoint("Lamps/Pendant over the table", {2.0f, 2.05f, 2.0f}, tinted(warm, 800.0f / (4.0f * kPi)));
    Mesh shade = cylinderMesh({0.5f, 1.35f, 0.55f}, 0.16f, 0.28f, 32);
    const float luminance = 500.0f / (kPi * static_cast<float>(areaOf(shade)));
    builder.add("Lamps/Floor lamp", std::move(shade),
                builder.addEmitter("lamp shade", tinted({1.0f, 0.84f, 0.64f}, luminance)));
    builder.add("Furniture/Lamp foot", cylinderMesh({0.5f, kSunk, 0.55f}, 0.02f, 1.34f, 12),
                builder.addMaterial("black steel", glm::vec3(0.06f)));
}

} // namespace

Scene twoRooms()
{
    SceneBuilder builder("two rooms");
    addShell(builder);
    addFurniture(builder);
    addLamps(builder);
    builder.addCamera("Room B", {8.0f, 1.65f, 3.8f}, {5.2f, 1.0f, 1.2f}, 60.0f);
    builder.addCamera("Room A", {0.3f, 1.65f, 3.7f}, {3.6f, 0.9f, 1.4f}, 60.0f);
    builder.addCamera("Through the door", {6.6f, 1.55f, 2.2f}, {2.0f, 1.1f, 1.9f}, 55.0f);
    builder.setExposure(2.5f);
    return builder.finish();
}

} // namespace lightloom
