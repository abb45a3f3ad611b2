// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/render_view.h"
#include "core/trace/final_gather.h"
#include "core/trace/path_walk.h"
#include "core/voxel/voxel_cuts.h"

/// What the passes over a picture share: rays through pixels, and what comes back along them.
namespace lightloom {

class VoxelCuts;

/// cd/m2 along a camera ray.
struct Radiance {
    glm::vec3 direct{0.0f}, indirect{0.0f};
    glm::vec3 emitted{0.0f}; ///< the part of `direct` that lamps in view send themselves
};

/// Follows camera rays. Holds no state between rays: any thread may use it. Keeps references.
class Eye {
public:
    Eye(const RayScene& rays, const LightSampler& lights, const Mix& mix, const IndirectField* field,
        const ViewJob& job, const CausticLamps* byPhotons = nullptr);
    Eye(const Eye&) = delete; // cached_ points here
    Eye& operator=(const Eye&) = delete;

    /// `middle` where given: light that is known already, for the first surface met.
    [[nodiscard]] Radiance along(glm::vec3 origin, glm::vec3 travel, Rng& rng,
                                 const MiddleLight* middle = nullptr) const;
    /// What a ray through the middle of a pixel meets, and the field's light there.
    [[nodiscard]] MiddleLight middle(glm::vec3 origin, glm::vec3 travel) const;
    [[nodiscard]] bool isByCuts() const { return cuts_ != nullptr; }

private:
    [[nodiscard]] int share(int perPixel) const { return glm::max(1, (perPixel + job_.samples - 1) / job_.samples); }
    [[nodiscard]] Radiance leaving(const Hit& hit, const Surface& surface, glm::vec3 n, glm::vec3 toEye,
                                   bool isStraight, Rng& rng, const MiddleLight* middle) const;
    struct Lux {
        glm::vec3 direct, indirect; // `direct`: of glowing surfaces, where cuts bring it
    };
    /// Whether the glossy lobe is wide enough to be lit by a cut.
    [[nodiscard]] bool isLitByCut(const Surface& surface) const;
    /// cd/m2 towards the eye that such a lobe sends of the field's light.
    [[nodiscard]] glm::vec3 glossByCut(const Surface& surface, glm::vec3 p, glm::vec3 n, glm::vec3 toEye) const;
    [[nodiscard]] Lightcut cutAt(glm::vec3 p, glm::vec3 n) const;
    [[nodiscard]] Lux fieldLux(glm::vec3 p, glm::vec3 n, Rng& rng, const MiddleLight* middle) const;

    const RayScene& rays_;
    const LightSampler& lights_;
    const Mix& mix_;
    const IndirectField* field_;
    const VoxelCuts* cuts_; ///< the field, where it is by lightcuts; else null
    bool usesCuts_ = false; ///< each surface that is met asks for one
    bool joins_ = false;    ///< its cuts bring glowing surfaces' own light along
    const ViewJob& job_;
    int directSamples_, gatherRays_;
    CachedIndirect cached_;
    PathWalk paths_;
};

/// Rays through the pixels of a perspective camera.
class Lens {
public:
    explicit Lens(const ViewJob& job); ///< keeps a reference to the camera
    explicit Lens(ViewJob&&) = delete;
    /// `within` the pixel, from its upper left corner, in [0,1)^2.
    void ray(int x, int y, glm::vec2 within, glm::vec3& origin, glm::vec3& travel) const;

private:
    const Camera& camera_;
    glm::mat3 orientation_;
    int width_, height_;
    float tanHalf_;
};

} // namespace lightloom
