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
    int samples = 16;       ///< camera rays per pixel; with a target, at most so many, in whole batches of 4
    float targetError = 0;  ///< work on each block of 4 x 4 pixels until the root mean square of its standard errors is
                            ///< expected at this fraction of the picture's mean luminance (lamps in view left out);
                            ///< 0: use all samples
    int directSamples = 64; ///< shadow rays per surface emitter and pixel, spread over the camera rays
    int gatherRays = 256;   ///< per pixel, the same, where the field has no answer, or everywhere:
    bool finalGather = false; ///< gather at what the eye sees, and ask the field at the gather rays' hits alone
    int pathDepth = 1024;
    std::uint64_t seed = 1;
    bool caustics = true; ///< by paths: photons for small lamps by way of mirrors (CausticLamps)
    int block = 1; ///< 1, 2, 4, 8 or 16, with a costly field: side of the squares of pixels that share its light where
                   ///< they see the same surface; above 1 a quick look, for a picture that is to come soon, and no
                   ///< light of its own elsewhere
    bool withDirect = true; ///< false: `View::direct` stays black, for whoever looks at the indirect light alone
};

/// Radiance towards the camera, cd/m2. `direct` and `indirect` add up to the picture.
struct View {
    FloatImage direct;        ///< emitters, and light that comes straight from them; mirrors on the way do not count
    FloatImage indirect;      ///< all the rest
    FloatImage standardError; ///< of direct + indirect, from the spread of batches: rough where there are few
    int samples = 0;          ///< camera rays every pixel has
    bool isWhole = false;     ///< every pixel is as was asked; false after a stop
    std::uint64_t rays = 0;   ///< camera rays, over all pixels
    std::uint64_t capped = 0; ///< pixels that used all samples before they met the target
    std::uint64_t causticRounds = 0; ///< of photons from small lamps by way of mirrors; 0: there are none
    std::vector<int> cutSizes{};     ///< by pixel, clusters and lights in the cut that lit the surface in its middle, 0
                                     ///< where there was none; empty: not by lightcuts
    std::uint64_t glossByCut = 0, glossByRays = 0; ///< pixels in whose middle a glossy metal got its light from a cut;
                                                   ///< by rays, its lobe being too narrow for that
};

/// What a pixel has taken in so far.
struct PixelSums {
    glm::dvec3 direct{0.0}, indirect{0.0}; ///< sums over its samples
    glm::dvec3 squares{0.0}, open{0.0};    ///< of its whole batches' means; sum of the batch that is not whole yet
    std::uint64_t samples = 0;
};
/// What a pixel is done with.
struct PixelLight {
    glm::vec3 direct{0.0f}, indirect{0.0f}, error{0.0f};
    std::uint32_t samples = 0; ///< 0: not done
};
/// What photons of small lamps brought to a pixel, over the rounds.
struct CausticPixel {
    glm::dvec3 sum{0.0}, squares{0.0}; ///< of the rounds' radiances, cd/m2
};
/// How a glossy metal gets its indirect light: from the lights of a cut, weighed by its lobe, where that is wide; from
/// one ray of each sample where it is narrow.
enum class GlossBy : std::uint8_t { none, cut, rays };
/// Indirect light on the surface in the middle of a block of pixels, for fields that are costly to ask: all samples of
/// the block that see this surface take it.
struct MiddleLight {
    bool isKnown = false, isThere = false; ///< looked for; found
    glm::vec3 position{0.0f}, normal{0.0f}, lux{0.0f};
    int cutSize = 0;           ///< of the lightcut that gave it; 0: none did
    glm::vec3 directLux{0.0f}; ///< straight from glowing surfaces, where a cut brings that along
    glm::vec3 gloss{0.0f};     ///< cd/m2 towards the eye that a wide glossy lobe sends of the field's light
    GlossBy glossBy = GlossBy::none;
    /// Whether a place is on the same surface, or on one that bends little.
    [[nodiscard]] bool isFor(glm::vec3 p, glm::vec3 n, float rounding) const
    {
        const glm::vec3 way = p - position;
        return isThere && glm::dot(n, normal) > 0.95f &&
               glm::abs(glm::dot(way, normal)) <= 0.2f * glm::length(way) + rounding;
    }
};
/// All that a run has found so far. Plain data: kept in files, and gone on with to the same bits.
struct ViewState {
    std::vector<PixelSums> pixels;      ///< of a job without a target, rows from the top
    std::vector<PixelLight> ended;      ///< of a job with one
    std::vector<CausticPixel> caustics; ///< empty where the scene has no such light
    std::uint64_t causticRounds = 0;
    std::vector<MiddleLight> middles; ///< of a costly field, by block; what is not there is found again
};

/// Camera rays start at the camera's near plane; outside the scene is black. Seen directly or in mirrors, a surface
/// shows emission + diffuse / pi * (direct + indirect illuminance) + what its glossy lobe reflects (one sampled ray,
/// beside exact direct light; by lightcuts their lights instead of the ray where roughness is at least .5). By paths,
/// light of small lamps that meets a mirror first comes by photons, averaged over discs of 1 % of the scene's diagonal
/// and less (CausticLamps; not what a glossy metal shows of it). `field` is needed for Indirect::field alone. Of voxels
/// whose cuts take lamps along (`voxel.lamps`) light straight from glowing surfaces comes by these. Pixel p's batch b
/// draws from stream (seed, p, b): the same bits on any number of threads. With a target the number of batches is
/// chosen without bias (CrossedMean). A stop is seen within a row or a batch; without a target all pixels are then
/// equally fine, with one those that were not begun show a first rough look.
[[nodiscard]] View renderView(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                              const IndirectField* field, const ViewJob& job, Workers& workers,
                              const std::stop_token& stop, const std::function<void(double fraction)>& progress = {});

/// The same, going on from `state`: empty, or what a stopped run of this job left. The end is the same, to the bit.
[[nodiscard]] View continueView(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                const IndirectField* field, const ViewJob& job, ViewState& state, Workers& workers,
                                const std::stop_token& stop, const std::function<void(double fraction)>& progress = {});

/// The picture of pixels that are done; those with no samples are black.
[[nodiscard]] View viewOf(const ViewJob& job, const std::vector<PixelLight>& pixels);

/// direct + indirect.
[[nodiscard]] FloatImage wholeView(const View& view);

/// What the surfaces in each pixel reflect evenly to all sides, per channel, 0 to 1: the mean over `job.samples` camera
/// rays. Black where one of them meets a gloss, or all meet nothing. A pixel's radiance times pi over this is the
/// illuminance (lux) of its surface. Empty if stopped.
[[nodiscard]] FloatImage mattReflectance(const RayScene& rays, const ViewJob& job, Workers& workers,
                                         const std::stop_token& stop);

/// Exposure value (ISO 100) that shows the picture's log-average luminance as middle grey (.18); black pixels do not
/// count. 0 for a black picture.
[[nodiscard]] float suitingEv(const FloatImage& radiance);

/// What a screen shows: exposed by `ev`, then the tone curve the window uses (shaders/common_colour.glsl, soft:
/// straight to .7 of white, above it a shoulder that keeps the hue and fades to white), then sRGB.
[[nodiscard]] ByteImage onScreen(const FloatImage& radiance, float ev);

} // namespace lightloom
