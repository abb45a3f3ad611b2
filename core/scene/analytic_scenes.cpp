// SPDX-License-Identifier: Apache-2.0
#include "core/scene/analytic_scenes.h"
#include "core/base/units.h"
#include "core/scene/scene_builder.h"

namespace lightloom {
namespace {

/// Luminance of a Lambertian surface of exitance M.
glm::vec3 glow(float exitance) { return glm::vec3(exitance / kPi); }

/// Parallelogram given in z-up coordinates; turning axes cyclically keeps which side is front.
Mesh quadFromZUp(glm::vec3 corner, glm::vec3 u, glm::vec3 v)
{
    const auto turn = [](glm::vec3 p) { return fromZUp(p.x, p.y, p.z); };
    return quadMesh(turn(corner), turn(u), turn(v));
}

void addReflectionPlanes(SceneBuilder& builder, float side, float rho, float lux)
{
    const float half = 0.5f * side;
    builder.add("S2", quadFromZUp({-half, 0.0f, 0.0f}, {side, 0.0f, 0.0f}, {0.0f, side, 0.0f}),
                builder.addMaterial("S2", glm::vec3(rho)));
    builder.add("Wall", quadFromZUp({-half, 0.0f, 0.0f}, {0.0f, 0.0f, 4.0f}, {side, 0.0f, 0.0f}),
                builder.addMaterial("black", glm::vec3(0.0f)));
    builder.addDirectional("Sun", {0.0f, -1.0f, 0.0f}, glm::vec3(lux));
}

} // namespace

Scene furnaceBox(float rho, float exitance, glm::vec3 size)
{
    SceneBuilder builder("furnace");
    builder.add("Furnace", boxMesh(-0.5f * size, 0.5f * size, Facing::in),
                builder.addEmitter("glowing", glow(exitance), glm::vec3(rho)));
    return builder.finish();
}

Scene litCube(float rho, float candela)
{
    SceneBuilder builder("cube");
    builder.add("Cube", boxMesh(glm::vec3(-1.0f), glm::vec3(1.0f), Facing::in),
                builder.addMaterial("grey", glm::vec3(rho)));
    builder.addPoint("Source", glm::vec3(0.0f), glm::vec3(candela));
    return builder.finish();
}

Scene pointSourceRoom()
{
    SceneBuilder builder("point source room");
    builder.add("Room", boxMesh(glm::vec3(0.0f), fromZUp(4.0f, 4.0f, 3.0f), Facing::in),
                builder.addMaterial("black", glm::vec3(0.0f)));
    builder.addPoint("Source", fromZUp(2.0f, 2.0f, 2.9f), glm::vec3(1000.0f));
    return builder.finish();
}

Scene areaSourceRoom()
{
    SceneBuilder builder("area source room");
    const int black = builder.addMaterial("black", glm::vec3(0.0f));
    const int panel = builder.addEmitter("panel", glow(10000.0f));
    CellPlan plan;
    plan.xs = plan.zs = {0.0f, 1.5f, 2.5f, 4.0f};
    plan.ys = {0.0f, 3.0f};
    plan.isAir = [](glm::vec3) { return true; };
    plan.materialOf = [=](glm::vec3 p, glm::vec3 n) {
        return n.y < 0.0f && p.x == 2.0f && p.z == 2.0f ? panel : black;
    };
    for (Mesh& mesh : cellShell(plan)) {
        const int material = mesh.material;
        builder.add(material == panel ? "Panel" : "Room", std::move(mesh), material);
    }
    return builder.finish();
}

Scene reflectionScene(float side, float rho, float lux)
{
    SceneBuilder builder("reflection");
    addReflectionPlanes(builder, side, rho, lux);
    return builder.finish();
}

Scene obstructionScene(float rho, float lux)
{
    SceneBuilder builder("obstruction");
    addReflectionPlanes(builder, 4.0f, rho, lux);
    builder.add("Screen", quadFromZUp({-10.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 0.5f}, {20.0f, 0.0f, 0.0f}),
                builder.addMaterial("black screen", glm::vec3(0.0f)));
    return builder.finish();
}

Scene parallelPlates(float rhoLow, float rhoHigh, float exitance, float side, float gap)
{
    SceneBuilder builder("parallel plates");
    const float half = 0.5f * side;
    builder.add("Low", quadMesh({-half, 0.0f, -half}, {0.0f, 0.0f, side}, {side, 0.0f, 0.0f}),
                builder.addEmitter("low", glow(exitance), glm::vec3(rhoLow)));
    builder.add("High", quadMesh({-half, gap, -half}, {side, 0.0f, 0.0f}, {0.0f, 0.0f, side}),
                builder.addMaterial("high", glm::vec3(rhoHigh)));
    return builder.finish();
}

Scene concentricSpheres(float rhoInner, float rhoOuter, float exitance, float rInner, float rOuter)
{
    SceneBuilder builder("concentric spheres");
    builder.add("Inner", sphereMesh(glm::vec3(0.0f), rInner, 64),
                builder.addEmitter("inner", glow(exitance), glm::vec3(rhoInner)));
    builder.add("Outer", sphereMesh(glm::vec3(0.0f), rOuter, 64, Facing::in),
                builder.addMaterial("outer", glm::vec3(rhoOuter)));
    return builder.finish();
}

Scene cavityCube(float rho, float flux)
{
    SceneBuilder builder("cavity cube");
    builder.add("Cavity", boxMesh(glm::vec3(-2.0f), glm::vec3(2.0f), Facing::in),
                builder.addMaterial("grey", glm::vec3(rho)));
    builder.addPoint("Source", {0.7f, 0.4f, -0.9f}, glm::vec3(flux / (4.0f * kPi)));
    return builder.finish();
}

Scene cavityL(float rho, float flux)
{
    SceneBuilder builder("cavity L");
    CellPlan plan;
    plan.xs = plan.zs = {0.0f, 2.0f, 4.0f};
    plan.ys = {0.0f, 3.0f};
    plan.isAir = [](glm::vec3 p) { return p.x < 2.0f || p.z < 2.0f; };
    const int grey = builder.addMaterial("grey", glm::vec3(rho));
    plan.materialOf = [=](glm::vec3, glm::vec3) { return grey; };
    builder.add("Cavity", cellShell(plan));
    builder.addPoint("Source", {0.8f, 1.9f, 3.1f}, glm::vec3(flux / (4.0f * kPi)));
    return builder.finish();
}

} // namespace lightloom
