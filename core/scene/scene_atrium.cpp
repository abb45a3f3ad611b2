// SPDX-License-Identifier: Apache-2.0
#include "core/base/units.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

namespace lightloom {
namespace {

// the hall inside: x 0..20, y 0..10, z 0..12; galleries on both long sides, 2.6 m deep
constexpr float kLength = 20.0f, kHeight = 10.0f, kWidth = 12.0f, kThick = 0.4f;
constexpr float kDepth = 2.6f, kParapet = 2.4f;
constexpr float kSlab1 = 3.3f, kDeck1 = 3.6f, kRail1 = 4.5f, kSlab2 = 6.6f, kDeck2 = 6.9f, kRail2 = 7.8f;

bool between(float v, float low, float high) { return v > low && v < high; }

bool isAir(glm::vec3 p)
{
    const bool inside = between(p.x, 0, kLength) && between(p.y, 0, kHeight) && between(p.z, 0, kWidth);
    if (!inside) { // the roof opening, with a beam across its middle
        const bool isOpening = p.y > kHeight && between(p.x, 4.0f, 16.0f) && between(p.z, 3.5f, 8.5f);
        return isOpening && !between(p.x, 9.6f, 10.4f);
    }
    const float fromWall = std::min(p.z, kWidth - p.z);
    if (fromWall > kDepth) return true;
    if (between(p.y, kSlab1, kDeck1) || between(p.y, kSlab2, kDeck2)) return false;
    const bool isRailHigh = between(p.y, kDeck1, kRail1) || between(p.y, kDeck2, kRail2);
    return !(isRailHigh && fromWall > kParapet);
}

void addBuilding(SceneBuilder& builder)
{
    const int floor = builder.addMaterial("limestone floor", {0.58f, 0.54f, 0.47f});
    const int walls = builder.addMaterial("plaster", {0.74f, 0.72f, 0.68f});
    const int parapet = builder.addMaterial("larch parapets", {0.55f, 0.38f, 0.24f});
    const int end = builder.addMaterial("red end wall", {0.58f, 0.22f, 0.16f});
    CellPlan plan;
    plan.xs = {-kThick, 0.0f, 4.0f, 9.6f, 10.4f, 16.0f, kLength, kLength + kThick};
    plan.ys = {-kThick, 0.0f, kSlab1, kDeck1, kRail1, kSlab2, kDeck2, kRail2, kHeight, kHeight + kThick};
    plan.zs = {-kThick,           0.0f,   kParapet,       kDepth, 3.5f, 8.5f, kWidth - kDepth,
               kWidth - kParapet, kWidth, kWidth + kThick};
    plan.isAir = isAir;
    plan.airOutside = true;
    plan.materialOf = [=](glm::vec3 p, glm::vec3 n) {
        const float fromWall = std::min(p.z, kWidth - p.z);
        if (p.y == 0.0f && n.y > 0.0f) return floor;
        if (p.x == kLength && n.x < 0.0f) return end;
        const bool isRail = between(p.y, kDeck1, kRail1 + 0.1f) || between(p.y, kDeck2, kRail2 + 0.1f);
        if (isRail && fromWall >= kParapet && fromWall <= kDepth && n.x == 0.0f) return parapet;
        return walls;
    };
    for (Mesh& mesh : cellShell(plan)) {
        const std::array<const char*, 4> names{"Building/Floor", "Building/Walls and slabs", "Building/Parapets",
                                               "Building/End wall"};
        const int material = mesh.material;
        builder.add(names[static_cast<std::size_t>(material)], std::move(mesh), material);
    }
}

void addColumns(SceneBuilder& builder)
{
    // 5 cm into floor and slab: no cap lies in their plane
    const float sunk = 0.05f;
    Mesh column = cylinderMesh({0.0f, -sunk, 0.0f}, 0.22f, kSlab1 + 2.0f * sunk, 32);
    column.name = "Column";
    const int mesh = builder.addMesh(std::move(column), builder.addMaterial("pale concrete", glm::vec3(0.62f)));
    for (int storey = 0; storey < 2; ++storey) {
        for (int side = 0; side < 2; ++side) {
            for (int i = 0; i < 6; ++i) {
                const float foot = storey == 0 ? 0.0f : kSlab2 - kSlab1; // both storeys are as high
                const glm::vec3 at(2.0f + 3.2f * static_cast<float>(i), foot, side == 0 ? 2.05f : kWidth - 2.05f);
                builder.place(fmt::format("Columns/{} {} {}", storey == 0 ? "Ground" : "Gallery",
                                          side == 0 ? "south" : "north", i + 1),
                              mesh, glm::translate(glm::mat4(1.0f), at));
            }
        }
    }
}

void addFurniture(SceneBuilder& builder)
{
    const int dark = builder.addMaterial("slate", {0.24f, 0.26f, 0.28f});
    const int green = builder.addMaterial("leaves", {0.20f, 0.38f, 0.12f});
    builder.add("Garden/Planter", boxMesh({8.5f, -0.01f, 5.2f}, {11.5f, 0.5f, 6.8f}), dark);
    int tree = 0;
    for (const float x : {9.2f, 10.0f, 10.8f}) {
        builder.add(fmt::format("Garden/Tree {}", ++tree), sphereMesh({x, 1.0f + 0.1f * x, 6.0f}, 0.6f, 20), green);
        builder.add(fmt::format("Garden/Trunk {}", tree), cylinderMesh({x, 0.45f, 6.0f}, 0.05f, 1.2f, 12), dark);
    }
    builder.add("Garden/Bench", boxMesh({12.5f, -0.01f, 5.6f}, {15.0f, 0.45f, 6.2f}),
                builder.addMaterial("oak bench", {0.50f, 0.36f, 0.22f}));
}

void addLamps(SceneBuilder& builder)
{
    builder.addDirectional("Sun", {0.28f, -0.94f, 0.12f}, tinted({1.0f, 0.94f, 0.84f}, 80000.0f));
    for (int storey = 0; storey < 2; ++storey) {
        const std::string group = storey == 0 ? "Ground floor lamps" : "Gallery lamps";
        for (int i = 0; i < 6; ++i) {
            const float x = 3.6f + 6.4f * static_cast<float>(i % 3), z = i < 3 ? 1.2f : kWidth - 1.2f;
            const glm::vec3 at(x, (storey == 0 ? kSlab1 : kSlab2) - 0.35f, z);
            builder.addPoint(fmt::format("Lamps/{} {}", storey == 0 ? "Ground floor" : "Gallery", i + 1), at,
                             tinted({1.0f, 0.80f, 0.56f}, 1500.0f / (4.0f * kPi)), group);
        }
    }
}

} // namespace

Scene atrium()
{
    SceneBuilder builder("atrium");
    addBuilding(builder);
    addColumns(builder);
    addFurniture(builder);
    addLamps(builder);
    builder.addCamera("Entrance", {0.7f, 1.7f, 6.6f}, {12.0f, 3.8f, 6.2f}, 65.0f);
    builder.addCamera("From the gallery", {3.2f, 5.3f, 2.2f}, {13.5f, 2.0f, 7.6f}, 62.0f);
    builder.addCamera("Under the gallery", {2.9f, 1.65f, 11.1f}, {14.5f, 1.6f, 8.6f}, 60.0f);
    builder.addCamera("Up to the roof", {15.5f, 1.2f, 5.2f}, {8.5f, 9.0f, 6.6f}, 75.0f);
    builder.setExposure(11.5f);
    return builder.finish();
}

} // namespace lightloom
