// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/trace/surface.h"
#include <array>
#include <memory>
#include <stop_token>
#include <string_view>

namespace lightloom {

/// Instruction sets Embree may use. `automatic` is avx2, or the widest the machine has below it, so that machines
/// agree: avx512 and avx2 differ in the last digits of a third of all hits.
enum class Isa { automatic, sse2, avx2, avx512 };
inline constexpr std::array<std::string_view, 4> kIsaNames{"auto", "sse2", "avx2", "avx512"};

/// Where a ray met a surface. Scene space.
struct Hit {
    float distance = 0.0f;
    std::uint32_t triangle = 0;  ///< number among all triangles of the scene, see RayScene::triangle
    std::uint32_t instance = 0;  ///< index into Scene::instances
    glm::vec2 barycentric{0.0f}; ///< weights of vertices 1 and 2
    glm::vec3 position{0.0f};    ///< on the triangle (from the barycentrics, not origin + t * direction)
    glm::vec3 normal{0.0f};      ///< geometric, unit, of the triangle's front side
    bool isFront = true;         ///< the ray came to the front side
    /// Geometric normal of the side the ray came to.
    [[nodiscard]] glm::vec3 facing() const { return isFront ? normal : -normal; }
};

struct Ray {
    glm::vec3 origin{0.0f}, travel{0.0f, 0.0f, -1.0f}; ///< `travel` unit
};

/// Eight rays side by side.
struct alignas(32) Rays8 {
    static constexpr std::size_t kCount = 8;
    float origin[3][kCount], travel[3][kCount]; ///< `travel` unit
    [[nodiscard]] glm::vec3 travelOf(std::size_t i) const { return {travel[0][i], travel[1][i], travel[2][i]}; }
};

/// What they met.
struct alignas(32) Met8 {
    static constexpr std::uint32_t kNothing = 0xFFFFFFFFu;
    std::uint32_t triangle[Rays8::kCount], instance[Rays8::kCount]; ///< as in Hit; `triangle` may be kNothing
    float u[Rays8::kCount], v[Rays8::kCount], distance[Rays8::kCount];
};

/// Eight pairs of points side by side.
struct alignas(32) Sights8 {
    static constexpr std::size_t kCount = 8;
    float from[3][kCount], to[3][kCount];
    void set(std::size_t i, glm::vec3 a, glm::vec3 b)
    {
        for (int axis = 0; axis < 3; ++axis) from[axis][i] = a[axis], to[axis][i] = b[axis];
    }
};

/// One triangle in its place. A cache line each: a hit reads one.
struct alignas(64) SceneTriangle {
    glm::vec3 a, b, c;      ///< scene space, in the order that faces front (mirrored instances are turned)
    glm::vec3 normal;       ///< unit, front; zero for a triangle without area
    std::uint32_t instance; ///< index into Scene::instances
    std::uint32_t indexInMesh;
};

/// The scene's triangles in Embree, for rays. Cut-out (alpha mask) texels let rays through. Built once, then any number
/// of threads may trace. Ray origins on surfaces are moved off them by `offset()`.
class RayScene {
public:
    /// Errors: out of memory; cancelled (a stop is seen within Embree's build too).
    static Result<std::shared_ptr<const RayScene>> build(std::shared_ptr<const Scene> scene, Isa isa = Isa::automatic,
                                                         std::stop_token stop = {});
    /// The same triangles for an edit of the scene with the same surface (`surfaceHash`): the triangles are shared.
    /// O(instances).
    [[nodiscard]] std::shared_ptr<const RayScene> withScene(std::shared_ptr<const Scene> scene) const;
    ~RayScene();
    RayScene(const RayScene&) = delete;
    RayScene& operator=(const RayScene&) = delete;

    [[nodiscard]] const Scene& scene() const { return *scene_; }
    [[nodiscard]] const std::shared_ptr<const Scene>& sharedScene() const { return scene_; }

    /// Nearest surface along `origin + t * travel`, t in (0, most). `travel` unit. False: none.
    [[nodiscard]] bool intersect(glm::vec3 origin, glm::vec3 travel, float most, Hit& hit) const;
    /// The same for the first `count` of eight rays without an end. The triangles they met are on their way to the
    /// processor then.
    void intersect(const Rays8& rays, std::size_t count, Met8& met) const;
    /// Where ray `i` met the surface that it met.
    [[nodiscard]] Hit hitOf(const Rays8& rays, const Met8& met, std::size_t i) const
    {
        Hit hit;
        hit.distance = met.distance[i];
        hit.triangle = met.triangle[i];
        hit.instance = met.instance[i];
        hit.barycentric = {met.u[i], met.v[i]};
        placeOn(triangles_[hit.triangle], rays.travelOf(i), hit);
        return hit;
    }
    /// True if anything opaque lies between the two points; both are taken as they are: move them off surfaces first.
    [[nodiscard]] bool isBlocked(glm::vec3 from, glm::vec3 to) const;
    /// The same for the first `count` of eight pairs, as bits: one ray takes a third of the time where they run alike.
    [[nodiscard]] std::uint32_t areBlocked(const Sights8& sights, std::size_t count) const;
    /// The same along a direction, to distance `most`.
    [[nodiscard]] bool isBlocked(glm::vec3 origin, glm::vec3 travel, float most) const;

    /// `p` moved off its surface along `side` (unit normal of the side to leave from): scene-relative, watertight.
    [[nodiscard]] glm::vec3 leave(glm::vec3 p, glm::vec3 side) const { return p + side * offset_; }
    /// 1e-5 of the scene's diagonal.
    [[nodiscard]] float offset() const { return offset_; }

    [[nodiscard]] std::uint32_t triangleCount() const;
    [[nodiscard]] const SceneTriangle& triangle(std::uint32_t index) const { return triangles_[index]; }
    [[nodiscard]] glm::vec3 triangleNormal(std::uint32_t index) const { return triangle(index).normal; }
    [[nodiscard]] float triangleArea(std::uint32_t index) const; ///< m2
    [[nodiscard]] std::uint32_t firstTriangle(std::uint32_t instance) const;
    [[nodiscard]] const Material& material(std::uint32_t triangle) const;
    [[nodiscard]] const InstanceLook& look(std::uint32_t instance) const { return looks_[instance]; }
    [[nodiscard]] std::string_view isaName() const; ///< what Embree really uses, part of a bake's record

    /// Embree's handle (RTCScene), for benches that compare with bare Embree.
    [[nodiscard]] void* embreeScene() const;

private:
    struct State;
    RayScene(std::shared_ptr<const State> state, std::shared_ptr<const Scene> scene);
    /// Sets position, normal and side of a hit on `t` at its barycentrics.
    static void placeOn(const SceneTriangle& t, glm::vec3 travel, Hit& hit)
    {
        const glm::vec2 b = hit.barycentric;
        hit.position = t.a * (1.0f - b.x - b.y) + t.b * b.x + t.c * b.y;
        hit.normal = t.normal;
        hit.isFront = glm::dot(hit.normal, travel) < 0.0f;
    }
    std::shared_ptr<const State> state_;
    std::shared_ptr<const Scene> scene_;
    const SceneTriangle* triangles_; // the state's
    float offset_;
    std::vector<InstanceLook> looks_; // by instance
};

} // namespace lightloom
