// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene_builder.h"
#include "core/trace/caustic_light.h"
#include "tests/light_helpers.h"

namespace lightloom::test {

/// A mirror at x = 0 facing +x, 1.2 m high and 2 m wide, a floor (black unless told otherwise), and a lamp at (1, 2,
/// 0): its image stands at
/// (-1, 2, 0) and lights the floor as far as x = 1.5, where its light just passes under the mirror's upper rim.
struct MirrorScene {
    static constexpr float kF0 = 0.8f;
    LitScene lit;
    explicit MirrorScene(float size = 0.0f, float candela = 100.0f, float floor = 0.0f)
        : lit(build(size, candela, floor))
    {
    }

    static Scene build(float size, float candela, float floor)
    {
        SceneBuilder builder("mirror and lamp");
        builder.add("Floor", quadMesh({0, 0, -3}, {0, 0, 6}, {6, 0, 0}),
                    builder.addMaterial("floor", glm::vec3(floor)));
        builder.add("Mirror", quadMesh({0, 0, -1}, {0, 1.2f, 0}, {0, 0, 2}),
                    builder.addMetal("mirror", glm::vec3(kF0), 0.0f));
        if (size > 0.0f) { // a downward panel of the same luminous intensity straight down
            const float h = 0.5f * size;
            builder.add("Lamp", quadMesh({1 - h, 2, -h}, {size, 0, 0}, {0, 0, size}),
                        builder.addEmitter("lamp", glm::vec3(candela / (size * size))));
        } else {
            builder.addPoint("Lamp", {1, 2, 0}, glm::vec3(candela));
        }
        return builder.finish();
    }
    /// Illuminance of the floor at (x, 0, z) from the image, 0 where its ray misses the mirror; Schlick's Fresnel term.
    static double exact(double x, double z, double candela = 100.0)
    {
        const glm::dvec3 image(-1, 2, 0), p(x, 0, z), d = p - image;
        const glm::dvec3 through = image + d * (1.0 / (x + 1.0)); // where it crosses x = 0
        if (through.y > 1.2 || std::abs(through.z) > 1.0) return 0.0;
        const double r = glm::length(d), cosine = d.x / r;
        const double f0 = double(kF0), fresnel = f0 + (double(kLargestAlbedo) - f0) * std::pow(1.0 - cosine, 5.0);
        return candela * fresnel * 2.0 / (r * r * r);
    }
    /// The mean of `exact` over the disc of radius r around the point: what photons estimate.
    static double overDisc(double x, double z, double r)
    {
        RunningMean mean;
        for (int i = 0; i < 200; ++i) {
            for (int k = 0; k < 200; ++k) {
                const double rho = r * std::sqrt((i + 0.5) / 200.0), phi = 2.0 * kPiD * (k + 0.5) / 200.0;
                mean.add(exact(x + rho * std::cos(phi), z + rho * std::sin(phi)));
            }
        }
        return mean.mean();
    }
    /// Standard error of the mean of `rounds` where illuminance `lux` comes in photons of equal flux.
    static double noise(const LitScene& lit, double lux, std::uint64_t rounds, double candela = 100.0)
    {
        const double photonFlux = 4.0 * kPiD * candela / double(CausticJob{}.photons);
        double variance = 0.0;
        for (std::uint64_t i = 0; i < rounds; ++i) {
            const double r = double(causticRadius(*lit.rays, i));
            variance += lux * photonFlux / (kPiD * r * r);
        }
        return std::sqrt(variance) / double(rounds);
    }
};

} // namespace lightloom::test
