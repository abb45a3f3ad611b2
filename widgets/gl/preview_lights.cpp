// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/preview_lights.h"
#include "core/trace/material.h"
#include "shaders/common.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>

namespace lightloom {

namespace {

constexpr float kWidestFlatSpot = 1.2f; ///< radians from the axis; a wider cone does not fit one flat map well

PreviewLight punctual(const PunctualLight& light)
{
    PreviewLight out;
    out.group = light.group;
    out.position = light.position;
    out.travel = light.travel;
    out.colour = light.intensity;
    switch (light.kind) {
    case PunctualLight::Kind::point:
        out.kind = shader::kLampPoint;
        break;
    case PunctualLight::Kind::spot:
        out.kind = shader::kLampSpot;
        out.cosInner = std::cos(light.innerCone);
        out.cosOuter = std::cos(light.outerCone);
        out.inCube = light.outerCone > kWidestFlatSpot;
        break;
    case PunctualLight::Kind::directional:
        out.kind = shader::kLampSun;
        out.inCube = false;
        break;
    }
    return out;
}

/// Triangles of a shining instance in scene space, for picking patches by area.
class ShiningSurface {
public:
    ShiningSurface(const Scene& scene, const Instance& instance)
        : scene_(scene), mesh_(scene.meshes[static_cast<std::size_t>(instance.mesh)]),
          material_(scene.materials[static_cast<std::size_t>(mesh_.material)])
    {
        const bool mirrored = instance.isMirrored();
        for (const glm::vec3& p : mesh_.positions) points_.push_back(glm::vec3(instance.toWorld * glm::vec4(p, 1.0f)));
        for (const glm::uvec3& t : mesh_.triangles) {
            const glm::vec3 across = glm::cross(points_[t.y] - points_[t.x], points_[t.z] - points_[t.x]);
            normals_.push_back(mirrored ? -across : across);
            area_ += 0.5 * static_cast<double>(glm::length(across));
            sums_.push_back(area_);
        }
    }

    [[nodiscard]] double area() const { return area_; }
    [[nodiscard]] bool isTwoSided() const { return material_.doubleSided; }

    /// Patches that share the surface out between them; a two-sided surface gets each twice, once facing back.
    void addPatches(int count, float offset, int group, std::vector<PreviewLight>& out) const
    {
        const glm::vec3 radiance = meanRadiance();
        const int sides = isTwoSided() ? 2 : 1;
        for (const Patch& patch : patches(std::max(1, count / sides))) {
            for (int side = 0; side < sides; ++side) {
                PreviewLight light;
                light.kind = shader::kLampSurface;
                light.group = group;
                light.colour = radiance;
                light.area = static_cast<float>(area_) * patch.share;
                light.travel = side == 0 ? patch.normal : -patch.normal;
                light.position = patch.position + light.travel * offset;
                light.points = pointsOf(patch, side == 1, offset);
                out.push_back(light);
            }
        }
    }

private:
    static constexpr int kPoints = 512; ///< that stand for the surface

    struct Patch {
        glm::vec3 position, normal;
        float share;              ///< of the area
        std::vector<int> members; ///< points that it stands for
    };

    [[nodiscard]] std::shared_ptr<const std::vector<PreviewLight::Point>> pointsOf(const Patch& patch, bool isBack,
                                                                                   float offset) const
    {
        // neighbours have neighbouring numbers: the golden ratio takes them from everywhere in turn
        const auto place = [](std::size_t rank) { return std::fmod(0.6180339887 * static_cast<double>(rank), 1.0); };
        std::vector<std::size_t> order(patch.members.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::sort(order, {}, place);
        auto out = std::make_shared<std::vector<PreviewLight::Point>>();
        for (const std::size_t rank : order) {
            const Patch at = point(patch.members[rank]);
            const glm::vec3 travel = isBack ? -at.normal : at.normal;
            out->push_back({at.position + travel * offset, travel});
        }
        return out;
    }

    /// Point `i` of kPoints, evenly spread by area.
    [[nodiscard]] Patch point(int i) const
    {
        const auto at = std::ranges::upper_bound(sums_, (i + 0.5) / kPoints * area_) - sums_.begin();
        const auto t = std::min(static_cast<std::size_t>(at), sums_.size() - 1);
        const glm::vec2 b = barycentric(i);
        const glm::uvec3& v = mesh_.triangles[t];
        const float length = glm::length(normals_[t]);
        return {points_[v.x] * (1.0f - b.x - b.y) + points_[v.y] * b.x + points_[v.z] * b.y,
                length > 0.0f ? normals_[t] / length : glm::vec3(0.0f, -1.0f, 0.0f),
                1.0f / kPoints,
                {}};
    }

    /// Clusters of the points (Lloyd's rounds from farthest-point seeds). Each is stood for by the point nearest its
    /// middle: the middle itself may lie inside a curved lamp, in its shadow.
    [[nodiscard]] std::vector<Patch> patches(int count) const
    {
        std::vector<Patch> all;
        for (int i = 0; i < kPoints; ++i) all.push_back(point(i));
        const auto squared = [](glm::vec3 d) { return glm::dot(d, d); };
        std::vector<glm::vec3> centres{all.front().position};
        while (static_cast<int>(centres.size()) < count) {
            const auto gap = [&](const Patch& p) {
                float least = std::numeric_limits<float>::max();
                for (const glm::vec3& c : centres) least = std::min(least, squared(p.position - c));
                return least;
            };
            centres.push_back(std::ranges::max_element(all, {}, gap)->position);
        }
        std::vector<std::size_t> owner(all.size(), 0);
        std::vector<float> share(centres.size(), 0.0f);
        for (int round = 0; round < 20; ++round) {
            std::vector<glm::vec3> sums(centres.size(), glm::vec3(0.0f));
            std::ranges::fill(share, 0.0f);
            for (std::size_t i = 0; i < all.size(); ++i) {
                const auto near = std::ranges::min_element(
                    centres, {}, [&](const glm::vec3& c) { return squared(all[i].position - c); });
                owner[i] = static_cast<std::size_t>(near - centres.begin());
                sums[owner[i]] += all[i].position;
                share[owner[i]] += all[i].share;
            }
            for (std::size_t c = 0; c < centres.size(); ++c) {
                if (share[c] > 0.0f) centres[c] = sums[c] / (share[c] * kPoints);
            }
        }
        std::vector<Patch> out;
        for (std::size_t c = 0; c < centres.size(); ++c) {
            const auto gap = [&](const Patch& p) {
                const bool mine = owner[static_cast<std::size_t>(&p - all.data())] == c;
                return mine ? squared(p.position - centres[c]) : std::numeric_limits<float>::max();
            };
            if (!(share[c] > 0.0f)) continue;
            out.push_back(*std::ranges::min_element(all, {}, gap));
            out.back().share = share[c];
            for (std::size_t i = 0; i < all.size(); ++i) {
                if (owner[i] == c) out.back().members.push_back(static_cast<int>(i));
            }
        }
        return out;
    }

    static glm::vec2 barycentric(int i)
    {
        const double n = i + 1.0;
        const double x = std::fmod(0.5 + n * 0.7548776662466927, 1.0), y = std::fmod(0.5 + n * 0.5698402909980532, 1.0);
        const double root = std::sqrt(x);
        return {static_cast<float>(root * (1.0 - y)), static_cast<float>(root * y)};
    }

    [[nodiscard]] glm::vec3 meanRadiance() const
    {
        const Texture& texture = material_.emissionTexture;
        if (!texture.isSet() || mesh_.uv[texture.uvSet].empty()) return material_.emission;
        glm::vec3 sum(0.0f);
        for (int i = 0; i < kPoints; ++i) {
            const double share = (i + 0.5) / kPoints * area_;
            const auto at = std::ranges::upper_bound(sums_, share) - sums_.begin();
            const glm::uvec3& v = mesh_.triangles[std::min(static_cast<std::size_t>(at), sums_.size() - 1)];
            const glm::vec2 b = barycentric(i);
            const auto& uv = mesh_.uv[texture.uvSet];
            const glm::vec2 where = uv[v.x] * (1.0f - b.x - b.y) + uv[v.y] * b.x + uv[v.z] * b.y;
            sum += glm::vec3(sampleTexture(scene_, texture, where, true));
        }
        return material_.emission * sum / static_cast<float>(kPoints);
    }

    const Scene& scene_;
    const Mesh& mesh_;
    const Material& material_;
    std::vector<glm::vec3> points_, normals_;
    std::vector<double> sums_;
    double area_ = 0.0;
};

/// As many as the preview has room for.
std::vector<PreviewLight> punctualLamps(const Scene& scene)
{
    std::vector<PreviewLight> lamps;
    for (const PunctualLight& light : scene.lights) {
        if (lamps.size() < static_cast<std::size_t>(shader::kMostLamps)) lamps.push_back(punctual(light));
    }
    return lamps;
}

/// How many patches each surface may have beside these lamps.
int patchesBeside(const std::vector<PreviewLight>& lamps, int surfaces)
{
    if (surfaces == 0) return 0;
    const int layers = 6 * static_cast<int>(std::ranges::count_if(lamps, &PreviewLight::inCube));
    return std::clamp((kMostCubeLayers - layers) / (6 * surfaces), 1, shader::kMostPerSurface);
}

} // namespace

void movePreviewLights(DrawData& data)
{
    const std::vector<PreviewLight> lamps = punctualLamps(*data.scene);
    if (patchesBeside(lamps, data.shiningSurfaces) == data.patchesEach) {
        std::ranges::copy(lamps, data.lights.begin());
    } else {
        addPreviewLights(data);
    }
}

void addPreviewLights(DrawData& data)
{
    const Scene& scene = *data.scene;
    data.lights = punctualLamps(scene);
    data.lampMessage.clear();
    int lamps = static_cast<int>(data.lights.size()), leftOut = static_cast<int>(scene.lights.size()) - lamps;
    std::vector<ShiningSurface> surfaces;
    std::vector<int> groups;
    for (const Instance& instance : scene.instances) {
        if (instance.group < 0) continue;
        ShiningSurface surface(scene, instance);
        if (!(surface.area() > 0.0)) continue;
        if (lamps == shader::kMostLamps) {
            ++leftOut;
            continue;
        }
        ++lamps;
        surfaces.push_back(std::move(surface));
        groups.push_back(instance.group);
    }
    data.shiningSurfaces = static_cast<int>(surfaces.size());
    data.patchesEach = patchesBeside(data.lights, data.shiningSurfaces);
    // far enough off that the lamp's own triangles lie behind the shadow maps' near planes
    const float offset = 2e-4f * scene.bounds.diagonal();
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        surfaces[i].addPatches(data.patchesEach, offset, groups[i], data.lights);
    }
    if (leftOut > 0) {
        data.lampMessage = fmt::format("The preview shows direct light of {} lamps; {} more are left out. Indirect "
                                       "light and `render` have them all.",
                                       lamps, leftOut);
    }
}

} // namespace lightloom
