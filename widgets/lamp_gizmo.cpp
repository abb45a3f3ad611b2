// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/lamp_gizmo.h"
#include <array>
#include <cmath>
#include <map>
#include <tuple>

namespace lightloom {

namespace {

constexpr float kArrowHead = 0.16f, kSquare = 0.09f, kKnob = 0.06f; ///< of a handle's length
constexpr float kAimLength = 1.6f;                                  ///< of an axis arrow's
constexpr std::size_t kMostTriangles = 20'000; ///< of all glowing meshes together, that edges are looked for in
constexpr std::size_t kMostRim = 2'000;        ///< edges of one mesh
constexpr std::size_t kMostLines = 8'000;      ///< of all outlines together: each is drawn with every step of a drag

glm::vec3 axisOf(LampHandle handle)
{
    switch (handle) {
    case LampHandle::x:
        return {1.0f, 0.0f, 0.0f};
    case LampHandle::y:
        return {0.0f, 1.0f, 0.0f};
    default:
        return {0.0f, 0.0f, 1.0f};
    }
}

/// Two directions across `n` and each other.
std::array<glm::vec3, 2> across(glm::vec3 n)
{
    const glm::vec3 other = std::abs(n.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
    const glm::vec3 u = glm::normalize(glm::cross(other, n));
    return {u, glm::cross(n, u)};
}

bool isAimed(const PunctualLight& lamp) { return lamp.kind != PunctualLight::Kind::point; }
bool isPlaced(const PunctualLight& lamp) { return lamp.kind != PunctualLight::Kind::directional; }

void addArrow(LampHandle handle, glm::vec3 from, glm::vec3 to, std::vector<HandleLine>& out)
{
    out.push_back({handle, from, to});
    const float head = kArrowHead * glm::length(to - from);
    const glm::vec3 along = glm::normalize(to - from);
    for (const glm::vec3 side : across(along)) {
        for (const float turn : {-0.45f, 0.45f}) {
            out.push_back({handle, to, to - head * along + turn * head * side});
        }
    }
}

void addCube(LampHandle handle, glm::vec3 centre, float half, std::vector<HandleLine>& out)
{
    for (int i = 0; i < 8; ++i) {
        for (const int axis : {1, 2, 4}) {
            if ((i & axis) != 0) continue;
            const auto corner = [&](int c) {
                return centre + half * glm::vec3(c & 1 ? 1.0f : -1.0f, c & 2 ? 1.0f : -1.0f, c & 4 ? 1.0f : -1.0f);
            };
            out.push_back({handle, corner(i), corner(i | axis)});
        }
    }
}

/// The near point of a ball that the line of sight meets; where it passes by, the point of the ball nearest to it.
glm::vec3 onBall(glm::vec3 centre, float radius, const SightLine& sight, bool isFar)
{
    const glm::vec3 d = centre - sight.eye;
    const float t = glm::dot(d, sight.along), gap2 = glm::dot(d, d) - t * t, half2 = radius * radius - gap2;
    if (half2 <= 0.0f) return centre + radius * glm::normalize(sight.eye + t * sight.along - centre);
    return sight.eye + (t + (isFar ? 1.0f : -1.0f) * std::sqrt(half2)) * sight.along;
}

} // namespace

glm::vec3 lampPlace(const PunctualLight& lamp, glm::vec3 anchor) { return isPlaced(lamp) ? lamp.position : anchor; }

std::vector<HandleLine> handlesOf(const PunctualLight& lamp, glm::vec3 anchor, float size)
{
    std::vector<HandleLine> out;
    const glm::vec3 place = lampPlace(lamp, anchor);
    if (isPlaced(lamp)) {
        for (const LampHandle h : {LampHandle::x, LampHandle::y, LampHandle::z}) {
            addArrow(h, place + 0.2f * size * axisOf(h), place + size * axisOf(h), out);
        }
        addCube(LampHandle::free, place, kSquare * size, out);
    }
    if (isAimed(lamp)) {
        const glm::vec3 tip = place + kAimLength * size * lamp.travel;
        out.push_back({LampHandle::aim, place, tip});
        addCube(LampHandle::aim, tip, kKnob * size, out);
    }
    return out;
}

PunctualLight dragged(const PunctualLight& start, LampHandle handle, glm::vec3 anchor, float size,
                      const SightLine& from, const SightLine& to)
{
    PunctualLight lamp = start;
    const glm::vec3 place = lampPlace(start, anchor);
    if (handle == LampHandle::aim) {
        const float radius = kAimLength * size;
        // the knob stays on the side of the lamp that it was on
        const bool isFar = glm::dot(start.travel, from.along) > 0.0f;
        const glm::vec3 turned = onBall(place, radius, to, isFar) - onBall(place, radius, from, isFar);
        const glm::vec3 aim = start.travel * radius + turned;
        if (glm::length(aim) > 1e-3f * radius) lamp.travel = glm::normalize(aim);
    } else if (handle == LampHandle::free) {
        const glm::vec3 n = glm::normalize(place - from.eye);
        const auto a = onPlane(place, n, from), b = onPlane(place, n, to);
        if (a && b) lamp.position = start.position + (*b - *a);
    } else if (handle != LampHandle::none) {
        const auto a = alongAxis(place, axisOf(handle), from), b = alongAxis(place, axisOf(handle), to);
        if (a && b) lamp.position = start.position + axisOf(handle) * (*b - *a);
    }
    return lamp;
}

std::vector<Mark> markerOf(const PunctualLight& lamp, glm::vec3 anchor, float size, glm::vec4 colour)
{
    std::vector<Mark> out;
    const glm::vec3 place = lampPlace(lamp, anchor);
    const auto line = [&](glm::vec3 a, glm::vec3 b) { out.push_back({a, b, colour, 1.8f}); };
    const float s = 0.22f * size;
    if (lamp.kind == PunctualLight::Kind::point) {
        for (const glm::vec3 d :
             {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1), glm::vec3(0.6f, 0.6f, 0.6f),
              glm::vec3(-0.6f, 0.6f, 0.6f), glm::vec3(0.6f, -0.6f, 0.6f), glm::vec3(0.6f, 0.6f, -0.6f)}) {
            line(place - s * d, place + s * d);
        }
        return out;
    }
    const auto [u, v] = across(lamp.travel);
    if (lamp.kind == PunctualLight::Kind::directional) {
        for (const glm::vec3 at : {glm::vec3(0.0f), u, -u, v, -v}) {
            const glm::vec3 tip = place + s * (at + 2.0f * lamp.travel);
            line(tip - 3.0f * s * lamp.travel, tip);
            line(tip, tip - s * (0.6f * lamp.travel + 0.3f * u));
            line(tip, tip - s * (0.6f * lamp.travel - 0.3f * u));
        }
        return out;
    }
    const float spread = std::tan(std::min(lamp.outerCone, 1.2f));
    glm::vec3 before(0.0f);
    for (int i = 0; i <= 12; ++i) {
        const float angle = static_cast<float>(i) * 0.5235988f;
        const glm::vec3 rim = place + 2.5f * s * (lamp.travel + spread * (std::cos(angle) * u + std::sin(angle) * v));
        if (i > 0) line(before, rim);
        if (i % 3 == 0 && i < 12) line(place, rim);
        before = rim;
    }
    return out;
}

std::vector<Mark> marksOf(const std::vector<HandleLine>& handles, LampHandle held)
{
    const auto colourOf = [](LampHandle handle) {
        switch (handle) {
        case LampHandle::x:
            return glm::vec4(0.95f, 0.35f, 0.35f, 1.0f);
        case LampHandle::y:
            return glm::vec4(0.45f, 0.85f, 0.40f, 1.0f);
        case LampHandle::z:
            return glm::vec4(0.45f, 0.60f, 1.0f, 1.0f);
        default:
            return glm::vec4(1.0f, 0.80f, 0.30f, 1.0f);
        }
    };
    std::vector<Mark> out;
    for (const HandleLine& line : handles) {
        const bool isHeld = line.handle == held;
        out.push_back({line.a, line.b, isHeld ? glm::vec4(1.0f) : colourOf(line.handle), isHeld ? 3.4f : 2.4f});
    }
    return out;
}

namespace {

using Corner = std::tuple<float, float, float>;

/// Edges that only one triangle of the mesh has, in its own space.
std::vector<HandleLine> rimOf(const Mesh& mesh)
{
    std::map<std::pair<Corner, Corner>, int> uses;
    const auto corner = [&](std::uint32_t v) {
        return Corner{mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z};
    };
    for (const glm::uvec3 t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) ++uses[std::minmax(corner(t[i]), corner(t[(i + 1) % 3]))];
    }
    const auto point = [](const Corner& c) { return glm::vec3(std::get<0>(c), std::get<1>(c), std::get<2>(c)); };
    std::vector<HandleLine> out;
    for (const auto& [edge, count] : uses) {
        if (count == 1) out.push_back({LampHandle::none, point(edge.first), point(edge.second)});
    }
    return out;
}

std::vector<HandleLine> boxOf(const Mesh& mesh)
{
    glm::vec3 low(mesh.positions.front()), high(low);
    for (const glm::vec3 p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
    std::vector<HandleLine> out;
    addCube(LampHandle::none, glm::vec3(0.0f), 1.0f, out);
    for (HandleLine& line : out) {
        for (glm::vec3* p : {&line.a, &line.b}) *p = 0.5f * (low + high) + 0.5f * *p * (high - low);
    }
    return out;
}

} // namespace

std::vector<std::vector<HandleLine>> outlinesOf(const Scene& scene)
{
    std::vector<std::vector<HandleLine>> out(scene.groups.size());
    std::map<int, std::vector<HandleLine>> known; // by mesh, in its own space
    std::size_t triangles = 0, drawn = 0;
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
        if (instance.group < 0 || mesh.triangles.empty()) continue;
        const auto [entry, isNew] = known.try_emplace(instance.mesh);
        std::vector<HandleLine>& lines = entry->second;
        if (isNew && triangles + mesh.triangles.size() <= kMostTriangles) {
            triangles += mesh.triangles.size();
            lines = rimOf(mesh);
        }
        if (isNew && (lines.empty() || lines.size() > kMostRim)) lines = boxOf(mesh);
        drawn += lines.size();
        if (drawn > kMostLines) return out;
        const auto place = [&](glm::vec3 p) { return glm::vec3(instance.toWorld * glm::vec4(p, 1.0f)); };
        for (const HandleLine& line : lines) {
            out[static_cast<std::size_t>(instance.group)].push_back({line.handle, place(line.a), place(line.b)});
        }
    }
    return out;
}

} // namespace lightloom
