// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/atlas/atlas.h"
#include "core/base/image.h"
#include "tests/light_helpers.h"
#include <QtTest>

/// What tests of atlases share.
namespace lightloom::test {

struct Unwrapped {
    LitScene lit;
    std::shared_ptr<const LightReach> reach;
    std::shared_ptr<const Atlas> atlas; ///< null where it failed
    std::string error;

    explicit Unwrapped(Scene scene, const AtlasOptions& options = {}, int threads = 2) : lit(std::move(scene))
    {
        Workers workers(threads);
        reach = LightReach::find(*lit.rays, *lit.lights, workers, {});
        const auto made = makeAtlas(*lit.rays, *reach, options, workers, {});
        if (made) {
            atlas = *made;
        } else {
            error = made.error().message;
        }
    }
    [[nodiscard]] std::string nodeOf(std::uint32_t side) const
    {
        return lit.scene->instances[lit.rays->triangle(side / 2).instance].node;
    }
};

/// Mean over 2 x 2 texels: the next mip.
inline FloatImage halfSize(const FloatImage& image)
{
    FloatImage half(image.width / 2, image.height / 2);
    for (int y = 0; y < half.height; ++y) {
        for (int x = 0; x < half.width; ++x) {
            half.at(x, y) = 0.25f * (image.at(2 * x, 2 * y) + image.at(2 * x + 1, 2 * y) + image.at(2 * x, 2 * y + 1) +
                                     image.at(2 * x + 1, 2 * y + 1));
        }
    }
    return half;
}

/// As a texture unit reads it: bilinear, clamped to the edge.
inline glm::vec3 bilinear(const FloatImage& image, glm::dvec2 uv)
{
    const glm::dvec2 at = uv * glm::dvec2(image.width, image.height) - 0.5;
    const glm::ivec2 low(glm::floor(at));
    const glm::dvec2 part = at - glm::floor(at);
    glm::dvec3 sum(0.0);
    for (int i = 0; i < 4; ++i) {
        const glm::ivec2 step(i & 1, i >> 1);
        const double weight = (step.x ? part.x : 1.0 - part.x) * (step.y ? part.y : 1.0 - part.y);
        const glm::ivec2 p = glm::clamp(low + step, glm::ivec2(0), glm::ivec2(image.width - 1, image.height - 1));
        if (weight > 0.0) sum += weight * glm::dvec3(image.at(p.x, p.y));
    }
    return glm::vec3(sum);
}

/// Weights of a triangle's corners, spread over it: corners, edges, inside.
inline std::vector<glm::dvec3> spreadWeights()
{
    std::vector<glm::dvec3> weights;
    constexpr int kSteps = 6;
    for (int i = 0; i <= kSteps; ++i) {
        for (int j = 0; i + j <= kSteps; ++j) weights.push_back(glm::dvec3(i, j, kSteps - i - j) / double(kSteps));
    }
    return weights;
}

inline glm::dvec2 uvAt(const std::array<glm::vec2, 3>& uv, glm::dvec3 w)
{
    return glm::dvec2(uv[0]) * w.x + glm::dvec2(uv[1]) * w.y + glm::dvec2(uv[2]) * w.z;
}

inline glm::dvec3 positionAt(const SceneTriangle& t, glm::dvec3 w)
{
    return glm::dvec3(t.a) * w.x + glm::dvec3(t.b) * w.y + glm::dvec3(t.c) * w.z;
}

} // namespace lightloom::test
