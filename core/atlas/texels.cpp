// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/texels.h"
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

constexpr double kTouch = 0.70710679; ///< from the centre of a texel to its corner
constexpr double kInwards = 0.05;     ///< texels
constexpr double kWellInside = 1e-3;  ///< texels from every edge
constexpr std::uint32_t kNone = ~0u;

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

glm::dvec2 nearestOnSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b)
{
    const glm::dvec2 ab = b - a;
    const double squared = glm::dot(ab, ab);
    const double t = squared > 0.0 ? glm::clamp(glm::dot(p - a, ab) / squared, 0.0, 1.0) : 0.0;
    return a + ab * t;
}

/// How far inside its edges a point of a face lies, texels; negative outside. Whatever way the corners run.
double depthInside(const FlatFace& face, glm::dvec2 p)
{
    const auto& c = face.corners;
    const double area = cross(c[1] - c[0], c[2] - c[0]);
    if (area == 0.0) return -1.0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 edge = c[(k + 1) % 3] - c[k];
        const double across = cross(edge, p - c[k]) / std::max(glm::length(edge), 1e-300);
        least = std::min(least, area > 0.0 ? across : -across);
    }
    return least;
}

glm::dvec2 nearestOnFace(const FlatFace& face, glm::dvec2 p)
{
    if (depthInside(face, p) >= 0.0) return p;
    glm::dvec2 best(0.0);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 q = nearestOnSegment(p, face.corners[k], face.corners[(k + 1) % 3]);
        if (const double away = glm::length(q - p); away < least) least = away, best = q;
    }
    return best;
}

/// Weights of the corners at a point of the face, each in [0, 1], 1 in all.
glm::dvec3 weightsAt(const FlatFace& face, glm::dvec2 p)
{
    const auto& c = face.corners;
    glm::dvec3 w(1.0 / 3.0);
    const double area = cross(c[1] - c[0], c[2] - c[0]);
    if (std::abs(area) > 1e-12) {
        w = {cross(c[1] - p, c[2] - p) / area, cross(c[2] - p, c[0] - p) / area, cross(c[0] - p, c[1] - p) / area};
    } else { // flat: along its longest edge
        std::size_t k = 0;
        const auto length = [&](std::size_t i) { return glm::length(c[(i + 1) % 3] - c[i]); };
        for (const std::size_t i : {1u, 2u}) {
            if (length(i) > length(k)) k = i;
        }
        if (length(k) > 0.0) {
            const double t = glm::length(nearestOnSegment(p, c[k], c[(k + 1) % 3]) - c[k]) / length(k);
            w = glm::dvec3(0.0);
            w[static_cast<int>(k)] = 1.0 - t;
            w[static_cast<int>((k + 1) % 3)] = t;
        }
    }
    w = glm::clamp(w, 0.0, 1.0);
    return w / (w.x + w.y + w.z);
}

/// Shading normal of a side where its corners weigh `w`.
glm::vec3 normalAt(const RayScene& rays, std::uint32_t side, glm::dvec3 w)
{
    const SceneTriangle& t = rays.triangle(side / 2);
    const Instance& instance = rays.scene().instances[t.instance];
    const Mesh& mesh = rays.scene().meshes[static_cast<std::size_t>(instance.mesh)];
    const glm::vec3 geometric = rays.triangleNormal(side / 2);
    glm::vec3 n = geometric;
    if (!mesh.normals.empty()) {
        const glm::uvec3 c = mesh.triangles[t.indexInMesh];
        const glm::vec3 local =
            mesh.normals[c.x] * float(w.x) + mesh.normals[c.y] * float(w.y) + mesh.normals[c.z] * float(w.z);
        const glm::dvec3 turned =
            glm::transpose(glm::inverse(glm::dmat3(glm::mat3(instance.toWorld)))) * glm::dvec3(local);
        const double length = glm::length(turned);
        if (length > 0.0 && std::isfinite(length)) n = glm::vec3(turned / length);
    }
    return side % 2 != 0 ? -n : n;
}

SurfaceTexel surfaceAt(const RayScene& rays, const FlatFace& face, glm::dvec2 centre, std::uint32_t texel)
{
    glm::dvec2 p = nearestOnFace(face, centre);
    if (p != centre) {
        const glm::dvec2 inwards = (face.corners[0] + face.corners[1] + face.corners[2]) / 3.0 - p;
        const double length = glm::length(inwards);
        if (length > 0.0) p += inwards * std::min(0.5, kInwards / length);
    }
    const glm::dvec3 w = weightsAt(face, p);
    const SceneTriangle& t = rays.triangle(face.side / 2);
    const glm::dvec3 position = glm::dvec3(t.a) * w.x + glm::dvec3(t.b) * w.y + glm::dvec3(t.c) * w.z;
    return {texel, glm::vec3(position), normalAt(rays, face.side, w)};
}

} // namespace

TouchedTexels touchedTexels(const RayScene& rays, const std::vector<FlatFace>& faces, glm::ivec2 low, glm::ivec2 high,
                            int width)
{
    const glm::ivec2 size = glm::max(high - low, 0);
    const auto count = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
    std::vector<std::uint32_t> nearest(count, kNone); // face
    std::vector<float> distances(count, std::numeric_limits<float>::infinity());
    std::vector<std::uint8_t> depth(count, 0); // faces that the centre lies well inside of
    const auto centreOf = [](int x, int y) { return glm::dvec2(x + 0.5, y + 0.5); };
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
        const auto& c = faces[f].corners;
        const glm::dvec2 least = glm::min(c[0], glm::min(c[1], c[2])), most = glm::max(c[0], glm::max(c[1], c[2]));
        const glm::ivec2 from = glm::max(glm::ivec2(glm::floor(least - 1.0)), low);
        const glm::ivec2 to = glm::min(glm::ivec2(glm::floor(most + 1.0)), high - 1);
        for (int y = from.y; y <= to.y; ++y) {
            for (int x = from.x; x <= to.x; ++x) {
                const glm::dvec2 centre = centreOf(x, y);
                const double away = glm::length(nearestOnFace(faces[f], centre) - centre);
                if (!(away <= kTouch)) continue;
                const std::size_t i = static_cast<std::size_t>(y - low.y) * static_cast<std::size_t>(size.x) +
                                      static_cast<std::size_t>(x - low.x);
                if (away == 0.0 && depth[i] < 2 && depthInside(faces[f], centre) > kWellInside) ++depth[i];
                if (!(static_cast<float>(away) < distances[i])) continue;
                distances[i] = static_cast<float>(away);
                nearest[i] = f;
            }
        }
    }
    TouchedTexels found;
    for (int y = low.y; y < high.y; ++y) {
        for (int x = low.x; x < high.x; ++x) {
            const std::size_t i = static_cast<std::size_t>(y - low.y) * static_cast<std::size_t>(size.x) +
                                  static_cast<std::size_t>(x - low.x);
            if (nearest[i] == kNone) continue;
            const auto texel = static_cast<std::uint32_t>(y * width + x);
            found.texels.push_back(surfaceAt(rays, faces[nearest[i]], centreOf(x, y), texel));
            found.covered += distances[i] == 0.0f;
            found.overlapping += depth[i] > 1;
        }
    }
    return found;
}

} // namespace lightloom
