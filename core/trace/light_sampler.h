// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/rng.h"
#include "core/scene/scene.h"
#include "core/trace/ray_scene.h"
#include <vector>

namespace lightloom {

/// One thing that shines: a punctual light, or all triangles of one emissive instance.
struct Emitter {
    enum class Kind { point, spot, directional, surface };
    Kind kind = Kind::point;
    int group = 0;
    int light = -1;             ///< index into Scene::lights, punctual kinds
    int instance = -1;          ///< index into Scene::instances, surface kind
    glm::vec3 flux{0.0f};       ///< lumen per channel (textures averaged)
    glm::vec3 centre{0.0f};     ///< centroid of its area, or the light's position
    float spreadSquared = 0.0f; ///< mean squared distance of its area from the centre, m2; 0 for punctual lights
};

/// What leaves an emitter as a photon.
struct EmittedPhoton {
    glm::vec3 position{0.0f}, travel{0.0f, 0.0f, -1.0f};
    glm::vec3 flux{0.0f}; ///< lumen carried if one photon were shot from the group; divide by the number shot
    glm::vec3 side{0.0f}; ///< normal the photon left along, already moved off; zero for punctual lights
    /// Of a photon that `launch` made: `travel` is still to be drawn, with this point of the unit square, from the
    /// cosine around `side`.
    bool isUnaimed = false;
    glm::vec2 aim{0.0f};
};

/// Light arriving at a point from one sample of an emitter, before the shadow ray and the cosine.
struct LightSample {
    glm::vec3 toLight{0.0f};     ///< unit
    float distance = 0.0f;       ///< to the end of the shadow ray; huge for directional lights
    glm::vec3 end{0.0f};         ///< end of the shadow ray, moved off the emitter
    glm::vec3 radiance{0.0f};    ///< cd/m2, surface kind; E = radiance * cos / pdf
    float pdf = 0.0f;            ///< per solid angle at the point, surface kind; 0 otherwise
    glm::vec3 illuminance{0.0f}; ///< lux on a plane facing the light, punctual kinds
    [[nodiscard]] bool isPunctual() const { return pdf == 0.0f; }
};

/// All emitters of a scene, grouped. Values per channel. Knows geometry through the RayScene it was built with.
class LightSampler {
public:
    /// `earlier` (may be null; not kept): lamps of an edit of the scene with the same surface, whose sums are taken
    /// over where they hold here too. The result is the same without it.
    explicit LightSampler(std::shared_ptr<const RayScene> rays, const LightSampler* earlier = nullptr);
    ~LightSampler();
    LightSampler(LightSampler&&) noexcept;

    [[nodiscard]] const std::shared_ptr<const RayScene>& rays() const;
    [[nodiscard]] const std::vector<Emitter>& emitters() const;
    /// Indices into `emitters()` of one light group.
    [[nodiscard]] const std::vector<int>& inGroup(int group) const;
    [[nodiscard]] glm::vec3 groupFlux(int group) const; ///< lumen per channel

    /// A photon from `group`: nine in ten pick an emitter in proportion to luminous flux, one in ten evenly (METHODS 1:
    /// a dim lamp beside a bright one still gets its share), then a point and direction by the emitter's own law; the
    /// flux makes up for the choice. False: the group is dark, or dark at the point picked (textures).
    [[nodiscard]] bool emit(int group, Rng& rng, EmittedPhoton& photon) const;

    /// The same photon, but where `isUnaimed` says so its direction is left to whoever draws many at once.
    [[nodiscard]] bool launch(int group, Rng& rng, EmittedPhoton& photon) const;

    /// A photon from one emitter, by its own law. False: dark at the point picked.
    [[nodiscard]] bool emitFrom(int emitter, Rng& rng, EmittedPhoton& photon) const;

    /// A sample of `emitter` seen from `p`: `u` uniform in the unit square. False: nothing arrives at `p` from it.
    /// Surface emitters: uniform by area within a triangle picked by area; only sides that emit count.
    [[nodiscard]] bool sample(int emitter, glm::vec3 p, glm::vec2 u, LightSample& out) const;

    /// Density (1/sr) with which `sample(emitterOf(triangle), origin, ...)` picks the point that was hit.
    [[nodiscard]] float pdf(glm::vec3 origin, const Hit& hit) const;
    /// Emitter a triangle belongs to, or -1.
    [[nodiscard]] int emitterOf(std::uint32_t triangle) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// KHR_lights_punctual cone fall-off: 1 inside the inner cone, 0 outside the outer one, squared linear between.
[[nodiscard]] float spotFalloff(const PunctualLight& light, float cosAngle);

} // namespace lightloom
