// SPDX-License-Identifier: Apache-2.0
#include "core/base/rng.h"
#include "core/base/units.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr float kLength = 14.0f, kHeight = 4.0f, kWidth = 8.0f;
constexpr float kPartLow = 6.85f, kPartHigh = 7.15f; // free-standing wall, x; z 2.5 .. 5.5, 3 m high

std::uint8_t byteOf(double v) { return static_cast<std::uint8_t>(glm::clamp(v, 0.0, 255.0)); }

/// Oak boards, sRGB: 8 boards side by side, each in two lengths, with grain along x. Tiles without a seam.
Image woodImage()
{
    constexpr int kSize = 128, kBoard = 16;
    Image image{"oak boards", kSize, kSize, {}};
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            const int row = y / kBoard, joint = (row * 48) % kSize;
            const bool isGap = y % kBoard == 0 || x == joint || x == (joint + 64) % kSize;
            const int piece = ((x - joint + kSize) % kSize) / 64;
            const std::uint64_t board = mixBits(static_cast<std::uint64_t>(row * 2 + piece + 1));
            const std::uint64_t grain = mixBits(board + static_cast<std::uint64_t>(y) * 1031u);
            const double tone =
                1.0 + 0.14 * (double(board % 256) / 255.0 - 0.5) + 0.08 * (double(grain % 256) / 255.0 - 0.5);
            const double dark = isGap ? 0.6 : 1.0;
            for (const double channel : {176.0, 138.0, 98.0}) image.rgba.push_back(byteOf(channel * tone * dark));
            image.rgba.push_back(255);
        }
    }
    return image;
}

constexpr int kTile = 64; // pixels of one picture in the sheet
using Rgb = std::array<int, 3>;

/// Six abstract pictures as functions of x, y in 0 .. 63.
Rgb pictureColour(int picture, int x, int y)
{
    const int dx = x - 32, dy = y - 32, r2 = dx * dx + dy * dy;
    switch (picture) {
    case 0: // red field with a dark band
        return y > 40 && y < 52 ? Rgb{70, 20, 24} : Rgb{196, 44 + y / 4, 36};
    case 1: // rings
        return r2 < 100   ? Rgb{240, 196, 60}
               : r2 < 380 ? Rgb{32, 70, 140}
               : r2 < 760 ? Rgb{230, 226, 210}
                          : Rgb{24, 40, 84};
    case 2: // stripes
        return x % 16 < 6 ? Rgb{30, 120, 92} : x % 16 < 9 ? Rgb{232, 206, 120} : Rgb{236, 232, 220};
    case 3: // checks that darken
        return (x / 8 + y / 8) % 2 ? Rgb{40 + 2 * y, 40 + 2 * y, 44 + 2 * y} : Rgb{226, 120, 40};
    case 4: // horizon
        return y < 36 ? Rgb{120 + 2 * y, 160 + y, 210} : Rgb{44, 84 - y / 2, 60};
    default: // a diagonal
        return x + y < 60 ? Rgb{228, 222, 206} : x + y < 68 ? Rgb{20, 20, 20} : Rgb{150, 60, 110};
    }
}

Image pictureSheet()
{
    Image image{"pictures", 4 * kTile, 2 * kTile, {}}; // powers of two; the last column stays unused
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            for (const int c : pictureColour(std::min(3 * (y / kTile) + x / kTile, 5), x % kTile, y % kTile)) {
                image.rgba.push_back(static_cast<std::uint8_t>(c));
            }
            image.rgba.push_back(255);
        }
    }
    return image;
}

int addTextured(SceneBuilder& builder, const std::string& name, const Texture& texture)
{
    Material material;
    material.name = name;
    material.metallic = 0.0f;
    material.baseColorTexture = texture;
    return builder.addMaterial(std::move(material));
}

/// Board image repeats every 1.6 m.
void addFloorCoordinates(Mesh& mesh)
{
    for (const glm::vec3 p : mesh.positions) mesh.uv[0].emplace_back(p.x / 1.6f, p.z / 1.6f);
}

void addRoom(SceneBuilder& builder)
{
    Texture boards;
    boards.image = builder.addImage(woodImage());
    const int floor = addTextured(builder, "oak floor", boards);
    const int walls = builder.addMaterial("white walls", {0.80f, 0.79f, 0.76f});
    const int ceiling = builder.addMaterial("white ceiling", glm::vec3(0.82f));
    const int part = builder.addMaterial("blue-grey partition", {0.34f, 0.40f, 0.46f});
    const glm::vec3 cool = tinted({0.93f, 1.0f, 1.06f}, 2000.0f / (kPi * 1.2f * 0.6f)); // 2000 lm on 1.2 x 0.6 m
    const int firstPanel = builder.addEmitter("panel 1", cool);
    builder.addEmitter("panel 2", cool);
    builder.addEmitter("panel 3", cool);
    CellPlan plan;
    plan.xs = {0.0f, 2.4f, 3.6f, 6.4f, kPartLow, kPartHigh, 7.6f, 10.4f, 11.6f, kLength};
    plan.ys = {0.0f, 3.0f, kHeight};
    plan.zs = {0.0f, 2.5f, 3.7f, 4.3f, 5.5f, kWidth};
    plan.isAir = [](glm::vec3 p) {
        return !(p.x > kPartLow && p.x < kPartHigh && p.y < 3.0f && p.z > 2.5f && p.z < 5.5f);
    };
    plan.materialOf = [=](glm::vec3 p, glm::vec3 n) {
        if (p.y == 0.0f) return floor;
        if (n.y < 0.0f) {
            if (p.z < 3.7f || p.z > 4.3f) return ceiling;
            if (p.x > 2.4f && p.x < 3.6f) return firstPanel;
            if (p.x > 6.4f && p.x < 7.6f) return firstPanel + 1;
            return p.x > 10.4f && p.x < 11.6f ? firstPanel + 2 : ceiling;
        }
        const bool isRoom = p.x == 0.0f || p.x == kLength || p.z == 0.0f || p.z == kWidth;
        return isRoom ? walls : part;
    };
    for (Mesh& mesh : cellShell(plan)) {
        const std::array<const char*, 7> names{"Room/Floor",      "Room/Walls",       "Room/Ceiling",
                                               "Room/Partition",  "Lamps/Panel west", "Lamps/Panel middle",
                                               "Lamps/Panel east"};
        const int material = mesh.material;
        if (material == floor) addFloorCoordinates(mesh);
        builder.add(names[static_cast<std::size_t>(material)], std::move(mesh), material);
    }
}

struct Hanging {
    const char* title;
    glm::vec3 centre, normal; ///< on the wall, facing the room
};

constexpr float kWide = 1.3f, kHigh = 1.3f;
constexpr float kBar = 0.05f, kDepth = 0.04f; // of a frame: width seen, and how far it stands off the wall
constexpr float kProud = 0.003f;              // a canvas stands before its frame's front,
constexpr float kSunk = 0.005f;               // reaches into it,
constexpr float kLap = 0.002f;                // and over its inner edge

/// A frame of four bars, a closed body from `low` to `high`, `across` its thin axis.
Mesh frameMesh(glm::vec3 low, glm::vec3 high, int across)
{
    CellPlan plan;
    std::array<std::vector<float>*, 3> planes{&plan.xs, &plan.ys, &plan.zs};
    glm::vec3 innerLow = low, innerHigh = high;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float>& at = *planes[static_cast<std::size_t>(axis)];
        at = {low[axis], high[axis]};
        if (axis == across) continue;
        innerLow[axis] += kBar + kLap, innerHigh[axis] -= kBar + kLap;
        at.insert(at.begin() + 1, {innerLow[axis], innerHigh[axis]});
    }
    plan.airOutside = true;
    plan.isAir = [=](glm::vec3 p) {
        return glm::all(glm::greaterThan(p, innerLow)) && glm::all(glm::lessThan(p, innerHigh));
    };
    return std::move(cellShell(plan).front());
}

/// A canvas stretched around its edges, without a back: its border lies inside the frame. Were it a sheet before the
/// frame, the dark gap behind it would count as surface that light reaches, and take half of the light before it.
Mesh canvasMesh(glm::vec3 corner, glm::vec3 u, glm::vec3 v)
{
    Mesh mesh = texturedQuadMesh(corner, u, v);
    const glm::vec3 in = (kProud + kSunk) * glm::normalize(glm::cross(v, u));
    for (std::uint32_t i = 0; i < 4; ++i) {
        mesh.positions.push_back(mesh.positions[i] + in);
        mesh.uv[0].push_back(glm::vec2(mesh.uv[0][i]));
        const std::uint32_t next = (i + 1) % 4;
        mesh.triangles.push_back({i, 4 + i, 4 + next});
        mesh.triangles.push_back({i, 4 + next, next});
    }
    return mesh;
}

void addPictures(SceneBuilder& builder)
{
    const std::array<Hanging, 6> hangings{{{"Red field", {3.4f, 1.6f, 0.0f}, {0, 0, 1}},
                                           {"Rings", {10.6f, 1.6f, 0.0f}, {0, 0, 1}},
                                           {"Stripes", {3.4f, 1.6f, kWidth}, {0, 0, -1}},
                                           {"Checks", {10.6f, 1.6f, kWidth}, {0, 0, -1}},
                                           {"Horizon", {kPartLow, 1.6f, 4.0f}, {-1, 0, 0}},
                                           {"Diagonal", {kPartHigh, 1.6f, 4.0f}, {1, 0, 0}}}};
    const int sheet = builder.addImage(pictureSheet());
    const int frame = builder.addMetal("brushed aluminium", {0.91f, 0.92f, 0.92f}, 0.35f);
    for (std::size_t i = 0; i < hangings.size(); ++i) {
        const Hanging& h = hangings[i];
        Texture texture;
        texture.image = sheet;
        texture.wrapS = texture.wrapT = Texture::Wrap::clamp;
        texture.scale = {0.25f, 0.5f};
        texture.offset = {static_cast<float>(i % 3) / 4.0f, static_cast<float>(i / 3) / 2.0f};
        const int canvas = addTextured(builder, h.title, texture);
        const glm::vec3 up(0.0f, 1.0f, 0.0f), right = glm::cross(up, h.normal);
        const glm::vec3 front = h.centre + (kDepth + kProud) * h.normal;
        builder.add(fmt::format("Pictures/{}", h.title),
                    canvasMesh(front - 0.5f * (kWide * right + kHigh * up), kWide * right, kHigh * up), canvas);
        // the frame reaches 1 cm into the wall, so that nothing lies in the wall's plane
        const glm::vec3 side = 0.5f * ((kWide + 2.0f * kBar) * right + (kHigh + 2.0f * kBar) * up);
        const glm::vec3 a = h.centre - side - 0.01f * h.normal, b = h.centre + side + kDepth * h.normal;
        builder.add(fmt::format("Frames/{}", h.title),
                    frameMesh(glm::min(a, b), glm::max(a, b), h.normal.x != 0.0f ? 0 : 2), frame);
        const float away = h.normal.x != 0.0f ? 1.7f : 1.9f;
        builder.addSpot(fmt::format("Lamps/Spot on {}", h.title), h.centre + away * h.normal + 2.25f * up, h.centre,
                        tinted({1.0f, 0.83f, 0.62f}, 2000.0f), glm::radians(12.0f), glm::radians(24.0f));
    }
}

void addSculptures(SceneBuilder& builder)
{
    const float sunk = -0.005f;
    const int plinth = builder.addMaterial("plinth", glm::vec3(0.70f));
    const int gold = builder.addMetal("polished gold", {0.95f, 0.72f, 0.33f}, 0.0f);
    const int steel = builder.addMetal("polished steel", {0.76f, 0.77f, 0.78f}, 0.0f);
    builder.add("Sculptures/Plinth of the ring", boxMesh({3.15f, sunk, 3.75f}, {3.65f, 0.9f, 4.25f}), plinth);
    builder.add("Sculptures/Golden ring",
                torusMesh({3.4f, 1.385f, 4.0f}, glm::normalize(glm::vec3(1.0f, 0.0f, 0.7f)), 0.38f, 0.11f, 72, 28),
                gold);
    builder.add("Sculptures/Plinth of the ball", boxMesh({10.35f, sunk, 3.75f}, {10.85f, 0.9f, 4.25f}), plinth);
    builder.add("Sculptures/Steel ball", sphereMesh({10.6f, 1.195f, 4.0f}, 0.3f, 40), steel);
    builder.add("Furniture/Bench", boxMesh({4.6f, sunk, 5.9f}, {6.2f, 0.45f, 6.35f}),
                builder.addMaterial("ash bench", {0.55f, 0.45f, 0.33f}));
}

} // namespace

Scene gallery()
{
    SceneBuilder builder("gallery");
    addRoom(builder);
    addPictures(builder);
    addSculptures(builder);
    const glm::vec3 warm = tinted({1.0f, 0.74f, 0.46f}, 1200.0f / (4.0f * kPi));
    builder.addPoint("Lamps/Pendant over the bench", {5.4f, 2.6f, 6.1f}, warm);
    builder.addPoint("Lamps/Pendant at the entrance", {13.0f, 2.6f, 6.6f}, warm);
    builder.addCamera("Entrance", {13.5f, 1.65f, 7.4f}, {8.6f, 1.4f, 2.4f}, 60.0f);
    builder.addCamera("West half", {0.6f, 1.65f, 7.2f}, {4.9f, 1.3f, 2.6f}, 62.0f);
    builder.addCamera("Golden ring", {1.7f, 1.55f, 5.4f}, {3.5f, 1.25f, 3.9f}, 45.0f);
    builder.addCamera("Behind the partition", {9.4f, 1.6f, 1.2f}, {7.1f, 1.5f, 4.2f}, 55.0f);
    builder.setExposure(6.0f);
    return builder.finish();
}

} // namespace lightloom
