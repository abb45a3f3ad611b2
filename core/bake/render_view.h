// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/image.h"
#include "core/base/parallel.h"
#include "core/field/indirect_field.h"
#include "core/trace/light_sampler.h"
#include <functional>

namespace lightloom {

/// A picture of a scene, made on the CPU: exact direct light, indirect light from wherever it is asked for.
struct ViewJob {
    enum class Indirect { none, field, paths }; ///< direct light only; a baked field; path tracing (the reference)
    Camera camera;
    int width = 800, height = 600; ///< pixels
    Indirect indirect = Indirect::none;
    int samples = 16;       ///< camera rays per pixel
    int directSamples = 64; ///< shadow rays per surface emitter and pixel, spread over the camera rays
    int gatherRays = 256;   ///< per pixel, the same, where the field has no answer
    int pathDepth = 64;
    std::uint64_t seed = 1;
};

/// Radiance towards the camera, cd/m2. Both layers add up to the picture.
struct View {
    FloatImage direct;   ///< emitters, and light that comes straight from them; mirrors on the way do not count
    FloatImage indirect; ///< all the rest
    int samples = 0;     ///< camera rays every pixel has; fewer than asked after a stop
};

/// Camera rays start at the camera's near plane; outside the scene is black. Seen directly or in mirrors, a surface
/// shows emission + diffuse / pi * (direct + indirect illuminance) + what its glossy lobe reflects (one sampled ray,
/// beside exact direct light). `field` is needed for Indirect::field alone. Pixel p's sample i draws from stream
/// (seed, p, i): the same bits on any number of threads. A stop is seen within a tile's row; pixels are then as fine
/// as they got.
[[nodiscard]] View renderView(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                              const IndirectField* field, const ViewJob& job, Workers& workers,
                              const std::stop_token& stop, const std::function<void(double fraction)>& progress = {});

/// direct + indirect.
[[nodiscard]] FloatImage wholeView(const View& view);

/// Exposure value (ISO 100) that shows the picture's log-average luminance as middle grey (.18); black pixels do not
/// count. 0 for a black picture.
[[nodiscard]] float suitingEv(const FloatImage& radiance);

/// What a screen shows: exposed by `ev`, then the tone curve the window uses (shaders/common_colour.glsl, soft:
/// straight to .7 of white, above it a shoulder that keeps the hue and fades to white), then sRGB.
[[nodiscard]] ByteImage onScreen(const FloatImage& radiance, float ev);

} // namespace lightloom
