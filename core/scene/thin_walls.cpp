// SPDX-License-Identifier: Apache-2.0
// A uniform grid and a walk through it: this layer has no Embree, and a few thousand rays do not need one.
#include "core/scene/thin_walls.h"
#include "core/base/rng.h"
#include "core/base/sampling.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint64_t kMostTriangles = 4'000'000, kMostTests = 50'000'000, kMostEntries = 60'000'000;

struct Face {
    glm::vec3 a, ab, ac;
    [[nodiscard]] glm::vec3 areaVector() const { return glm::cross(ab, ac); }
};

std::vector<Face> facesOf(const Scene& scene)
{
    std::vector<Face> faces;
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
        const bool turned = instance.isMirrored();
        const auto place = [&](std::uint32_t v) {
            return glm::vec3(instance.toWorld * glm::vec4(mesh.positions[v], 1));
        };
        for (const glm::uvec3 t : mesh.triangles) {
            const glm::vec3 a = place(t.x), b = place(turned ? t.z : t.y), c = place(turned ? t.y : t.z);
            faces.push_back({a, b - a, c - a});
        }
    }
    return faces;
}

/// Distance along origin + t * travel to the face, infinite where it is missed (Moeller and Trumbore 1997).
float distanceTo(const Face& face, glm::vec3 origin, glm::vec3 travel)
{
    constexpr float kMiss = std::numeric_limits<float>::infinity();
    const glm::vec3 p = glm::cross(travel, face.ac);
    const float determinant = glm::dot(face.ab, p);
    if (determinant == 0.0f) return kMiss;
    const glm::vec3 s = origin - face.a;
    const float u = glm::dot(s, p) / determinant;
    const glm::vec3 q = glm::cross(s, face.ab);
    const float v = glm::dot(travel, q) / determinant;
    if (!(u >= 0.0f && v >= 0.0f && u + v <= 1.0f)) return kMiss;
    return glm::dot(face.ac, q) / determinant;
}

/// Faces by cells, as one array of lists.
class FaceGrid {
public:
    FaceGrid(const std::vector<Face>& faces, const Bounds& bounds) : faces_(faces)
    {
        const float pad = 1e-4f * bounds.diagonal();
        low_ = bounds.low - pad;
        const glm::vec3 size = bounds.size() + 2.0f * pad;
        auto along = static_cast<int>(std::clamp(2.0 * std::cbrt(static_cast<double>(faces.size())), 8.0, 128.0));
        do { // large slanted faces reach into many cells
            cell_ = glm::max(size.x, glm::max(size.y, size.z)) / static_cast<float>(along);
            count_ = glm::max(glm::ivec3(glm::ceil(size / cell_)), glm::ivec3(1));
            along /= 2;
        } while (countEntries() > kMostEntries && along >= 4);
        for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
        entries_.resize(starts_.back());
        std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
        for (std::uint32_t f = 0; f < faces.size(); ++f) {
            forCells(faces[f], [&](std::size_t cell) { entries_[next[cell]++] = f; });
        }
    }

    /// Number of the nearest face beyond `least`, -1 for none; `distance` gets how far.
    [[nodiscard]] std::int64_t nearest(glm::vec3 origin, glm::vec3 travel, float least, float& distance,
                                       std::uint64_t& tests) const
    {
        constexpr float kFar = std::numeric_limits<float>::max();
        glm::ivec3 at = cellOf(origin), step;
        glm::vec3 toNext, perCell;
        for (int i = 0; i < 3; ++i) {
            step[i] = travel[i] > 0.0f ? 1 : -1;
            const float border = low_[i] + static_cast<float>(at[i] + (step[i] > 0 ? 1 : 0)) * cell_;
            toNext[i] = travel[i] != 0.0f ? (border - origin[i]) / travel[i] : kFar;
            perCell[i] = travel[i] != 0.0f ? cell_ / std::abs(travel[i]) : kFar;
        }
        std::int64_t best = -1;
        distance = kFar;
        while (true) {
            const auto cell = indexOf(at);
            for (std::uint32_t e = starts_[cell]; e < starts_[cell + 1]; ++e, ++tests) {
                const float t = distanceTo(faces_[entries_[e]], origin, travel);
                if (!(t > least && t < distance)) continue;
                distance = t;
                best = entries_[e];
            }
            const int axis = toNext.x < toNext.y ? (toNext.x < toNext.z ? 0 : 2) : (toNext.y < toNext.z ? 1 : 2);
            if (distance <= toNext[axis]) return best; // nothing beyond this cell is nearer
            at[axis] += step[axis];
            if (at[axis] < 0 || at[axis] >= count_[axis]) return best;
            toNext[axis] += perCell[axis];
        }
    }

private:
    [[nodiscard]] glm::ivec3 cellOf(glm::vec3 p) const
    {
        return glm::clamp(glm::ivec3((p - low_) / cell_), glm::ivec3(0), count_ - 1);
    }
    [[nodiscard]] std::size_t indexOf(glm::ivec3 c) const
    {
        return (static_cast<std::size_t>(c.z) * static_cast<std::size_t>(count_.y) + static_cast<std::size_t>(c.y)) *
                   static_cast<std::size_t>(count_.x) +
               static_cast<std::size_t>(c.x);
    }
    template<class Take>
    void forCells(const Face& face, Take take) const
    {
        const glm::vec3 b = face.a + face.ab, c = face.a + face.ac, hair(1e-4f * cell_);
        const glm::ivec3 from = cellOf(glm::min(face.a, glm::min(b, c)) - hair);
        const glm::ivec3 to = cellOf(glm::max(face.a, glm::max(b, c)) + hair);
        for (int z = from.z; z <= to.z; ++z) {
            for (int y = from.y; y <= to.y; ++y) {
                for (int x = from.x; x <= to.x; ++x) take(indexOf({x, y, z}));
            }
        }
    }
    /// Fills `starts_` with the length of each cell's list, one place late; gives their sum.
    std::uint64_t countEntries()
    {
        starts_.assign(indexOf(count_ - 1) + 2, 0);
        std::uint64_t entries = 0;
        for (const Face& face : faces_) {
            forCells(face, [&](std::size_t cell) {
                ++starts_[cell + 1];
                ++entries;
            });
            if (entries > kMostEntries) break;
        }
        return entries;
    }

    const std::vector<Face>& faces_;
    glm::vec3 low_;
    float cell_ = 1.0f;
    glm::ivec3 count_{1};
    std::vector<std::uint32_t> starts_, entries_;
};

/// Looks at single points of the model.
class WallProbe {
public:
    WallProbe(const std::vector<Face>& faces, const Bounds& bounds)
        : faces_(faces), grid_(faces, bounds), least_(1e-5f * bounds.diagonal())
    {
    }

    /// The wall behind point `p` of a face with unit normal `n`.
    std::optional<ThinWall> behind(glm::vec3 p, glm::vec3 n)
    {
        constexpr float kOpposite = 0.9f; // cosine: 26 degrees
        float distance = 0.0f;
        const std::int64_t hit = grid_.nearest(p, -n, least_, distance, tests);
        if (hit < 0 || !(glm::dot(normalOf(hit), -n) >= kOpposite)) return std::nullopt;
        if (isInside(p, n) || isInside(p - distance * n, -n)) return std::nullopt;
        return ThinWall{distance, p};
    }

    std::uint64_t tests = 0; ///< of rays against triangles, so far

private:
    [[nodiscard]] glm::vec3 normalOf(std::int64_t face) const
    {
        return glm::normalize(faces_[static_cast<std::size_t>(face)].areaVector());
    }
    /// The point lies in a body, as the floor under a sofa that stands a little in the floor: no light comes there, so
    /// it is no side of a wall. Along a ray from the open each body is entered before it is left; one left more often
    /// than entered held the point. A room's own walls are only ever entered.
    bool isInside(glm::vec3 p, glm::vec3 away)
    {
        constexpr int kMostFaces = 64;
        int left = 0;
        for (int i = 0; i < kMostFaces && left <= 0; ++i) {
            float distance = 0.0f;
            const std::int64_t hit = grid_.nearest(p, away, least_, distance, tests);
            if (hit < 0) return false;
            left += glm::dot(normalOf(hit), away) > 0.0f ? 1 : -1;
            p += distance * away;
        }
        return left > 0;
    }

    const std::vector<Face>& faces_;
    FaceGrid grid_;
    float least_; ///< nearer than this is the face itself, or a sheet laid on it
};

/// A place in `areas` (running sums) for a uniform number.
std::size_t pick(const std::vector<double>& areas, double u)
{
    const auto found = std::upper_bound(areas.begin(), areas.end(), u * areas.back());
    return std::min(static_cast<std::size_t>(found - areas.begin()), areas.size() - 1);
}

} // namespace

ThinWallSearch findThinWalls(const Scene& scene, int samples)
{
    std::uint64_t triangles = 0;
    for (const Instance& instance : scene.instances) {
        triangles += scene.meshes[static_cast<std::size_t>(instance.mesh)].triangles.size();
    }
    ThinWallSearch search;
    if (triangles == 0 || triangles > kMostTriangles) return search;
    const std::vector<Face> faces = facesOf(scene);
    std::vector<double> areas(faces.size());
    double sum = 0.0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        sum += static_cast<double>(glm::length(faces[f].areaVector()));
        areas[f] = sum;
    }
    if (!(sum > 0.0)) return search;
    WallProbe probe(faces, scene.bounds);
    for (; search.samples < samples && probe.tests < kMostTests; ++search.samples) {
        Rng rng(1, hashName("thin walls"), static_cast<std::uint64_t>(search.samples));
        const Face& face = faces[pick(areas, rng.uniformDouble())];
        const float u1 = rng.uniform();
        const glm::vec2 b = sampleTriangle(u1, rng.uniform());
        const auto wall = probe.behind(face.a + b.x * face.ab + b.y * face.ac, glm::normalize(face.areaVector()));
        if (wall && (!search.thinnest || wall->thickness < search.thinnest->thickness)) search.thinnest = wall;
    }
    return search;
}

} // namespace lightloom
