// SPDX-License-Identifier: Apache-2.0
#include "core/transport/surface_bend.h"
#include "core/base/sampling.h"
#include <algorithm>
#include <cmath>
#include <numeric>

namespace lightloom {
namespace {

constexpr float kLike = 0.3f;     ///< cosine between normals of what is still the same surface
constexpr float kSameEdge = 0.9f; ///< cosine between normals beyond what counts as one edge
constexpr float kApart = 1e-3f;   ///< cells
constexpr float kFlat = 1e-3f;    ///< per cell: less is none
constexpr double kSpread = 1e-3;  ///< of neighbours about an entry, as a share of their greatest: less is no direction

/// Sums for the least squares of one entry, in a frame of its tangent plane: differences of place (a, b) and of normal
/// (c, d), (c, d) = S (a, b) for a symmetric S.
struct BendSums {
    float aa = 0.0f, ab = 0.0f, bb = 0.0f, ac = 0.0f, bcad = 0.0f, bd = 0.0f;
};

class BendFitter {
public:
    explicit BendFitter(const SurfaceVoxels& voxels) : voxels_(voxels), sums_(voxels.entries.size())
    {
        out_.number.resize(voxels.entries.size());
        out_.edges.resize(1); // what has none
    }

    /// Takes both entries' sight of the other.
    void join(std::uint32_t one, std::uint32_t other)
    {
        const Orientation &a = voxels_.entries[one], &b = voxels_.entries[other];
        const glm::vec3 way = (b.centroid - a.centroid) / voxels_.cellSize(), turn = b.normal - a.normal;
        const float alike = glm::dot(a.normal, b.normal);
        if (alike >= kLike) {
            add(one, way, turn, b.area);
            add(other, way, turn, a.area);
        } else if (alike > -kSameOrientation && glm::dot(way, a.normal) < kApart && glm::dot(way, b.normal) > -kApart) {
            addEdge(one, b.normal);
            addEdge(other, a.normal);
        }
    }
    void joinVoxels(std::uint32_t one, std::uint32_t other)
    {
        for (std::uint32_t e = voxels_.firstEntry[one]; e < voxels_.firstEntry[one + 1]; ++e)
            for (std::uint32_t f = voxels_.firstEntry[other]; f < voxels_.firstEntry[other + 1]; ++f) join(e, f);
    }
    [[nodiscard]] SurfaceBends finish();

private:
    [[nodiscard]] SurfaceBend bendOf(std::uint32_t entry) const;
    void addEdge(std::uint32_t entry, glm::vec3 normal)
    {
        if (out_.number[entry] == 0) {
            out_.number[entry] = static_cast<std::uint32_t>(out_.edges.size());
            out_.edges.push_back({});
        }
        for (glm::vec3& known : out_.edges[out_.number[entry]]) {
            if (known == glm::vec3(0.0f)) known = normal;
            if (glm::dot(known, normal) > kSameEdge) return;
        }
    }
    void add(std::uint32_t entry, glm::vec3 way, glm::vec3 turn, float weight)
    {
        const Frame frame(voxels_.entries[entry].normal);
        const float a = glm::dot(way, frame.tangent), b = glm::dot(way, frame.bitangent),
                    c = glm::dot(turn, frame.tangent), d = glm::dot(turn, frame.bitangent);
        BendSums& s = sums_[entry];
        s.aa += weight * a * a, s.ab += weight * a * b, s.bb += weight * b * b;
        s.ac += weight * a * c, s.bcad += weight * (b * c + a * d), s.bd += weight * b * d;
    }

    const SurfaceVoxels& voxels_;
    std::vector<BendSums> sums_;
    SurfaceBends out_;
};

SurfaceBends BendFitter::finish()
{
    for (std::uint32_t e = 0; e < sums_.size(); ++e) out_.bends.push_back(bendOf(e));
    return std::move(out_);
}

SurfaceBend BendFitter::bendOf(std::uint32_t entry) const
{
    const BendSums& s = sums_[entry];
    if (s.ac == 0.0f && s.bcad == 0.0f && s.bd == 0.0f) return {};
    // normal equations of (S11, S12, S22), by Cramer; a little is added to their diagonal for a row of neighbours
    const double little = kSpread * static_cast<double>(s.aa + s.bb);
    const double aa = static_cast<double>(s.aa) + little, bb = static_cast<double>(s.bb) + little, ab = s.ab;
    const double middle = aa + bb, determinant = aa * (middle * bb - ab * ab) - ab * ab * bb;
    if (!(determinant > 0.0)) return {};
    const double r1 = s.ac, r2 = s.bcad, r3 = s.bd;
    const double s11 = (r1 * (middle * bb - ab * ab) - ab * (r2 * bb - ab * r3)) / determinant;
    const double s12 = (aa * (r2 * bb - ab * r3) - r1 * ab * bb) / determinant;
    const double s22 = (aa * (middle * r3 - ab * r2) - ab * (ab * r3) + r1 * ab * ab) / determinant;
    // principal curvatures
    const double mean = 0.5 * (s11 + s22), half = 0.5 * (s11 - s22), radius = std::sqrt(half * half + s12 * s12);
    const double most = mean + radius, least = std::max(0.0, mean - radius);
    if (!(most > static_cast<double>(kFlat))) return {};
    const double angle = 0.5 * std::atan2(s12, half);
    const Frame frame(voxels_.entries[entry].normal);
    const glm::vec3 t =
        static_cast<float>(std::cos(angle)) * frame.tangent + static_cast<float>(std::sin(angle)) * frame.bitangent;
    return {static_cast<float>(least), static_cast<float>(std::sqrt(most - least)) * t};
}

/// The places of voxels in lexicographic order: those at one offset from each come in order too, so that one pass with
/// a pointer each finds them.
void joinNeighbours(const SurfaceVoxels& voxels, BendFitter& fitter)
{
    std::vector<std::uint32_t> order(voxels.voxels.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto keyOf = [](glm::ivec3 v) {
        return (static_cast<std::int64_t>(v.x + 1) << 40) + (static_cast<std::int64_t>(v.y + 1) << 20) + v.z + 1;
    };
    std::vector<std::int64_t> keys(order.size());
    std::ranges::sort(order, {}, [&](std::uint32_t v) { return keyOf(voxels.voxels[v]); });
    for (std::size_t i = 0; i < order.size(); ++i) keys[i] = keyOf(voxels.voxels[order[i]]);
    const std::int64_t here = keyOf(glm::ivec3(0));
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                const std::int64_t offset = keyOf(glm::ivec3(x, y, z)) - here;
                if (offset <= 0) continue; // the other half is met from the other side
                std::size_t other = 0;
                for (std::size_t i = 0; i < order.size(); ++i) {
                    while (other < keys.size() && keys[other] < keys[i] + offset) ++other;
                    if (other < keys.size() && keys[other] == keys[i] + offset)
                        fitter.joinVoxels(order[i], order[other]);
                }
            }
}

} // namespace

SurfaceBends surfaceBends(const SurfaceVoxels& voxels)
{
    BendFitter fitter(voxels);
    joinNeighbours(voxels, fitter);
    for (std::size_t v = 0; v < voxels.voxels.size(); ++v)
        for (std::uint32_t e = voxels.firstEntry[v]; e < voxels.firstEntry[v + 1]; ++e)
            for (std::uint32_t f = e + 1; f < voxels.firstEntry[v + 1]; ++f) fitter.join(e, f);
    return fitter.finish();
}

} // namespace lightloom
