// SPDX-License-Identifier: Apache-2.0
#include "core/trace/ray_scene.h"
#include "core/base/units.h"
#include "core/base/wide_vectors.h"
#include "core/trace/embree_options.h"
#include "core/trace/material.h"
#include <cmath>
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <limits>

namespace lightloom {
namespace {

template<class T, void (*Release)(T)>
struct Releaser {
    using pointer = T;
    void operator()(T handle) const { Release(handle); }
};
using Device = std::unique_ptr<RTCDevice, Releaser<RTCDevice, rtcReleaseDevice>>;
using Tree = std::unique_ptr<RTCScene, Releaser<RTCScene, rtcReleaseScene>>;
using Geometry = std::unique_ptr<RTCGeometry, Releaser<RTCGeometry, rtcReleaseGeometry>>;

Result<std::string> isaConfig(Isa isa)
{
    const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    const auto missing = [](const char* name) {
        return Error{Error::Kind::unsupported, fmt::format("this machine has no {}; use --isa auto or sse2", name)};
    };
    switch (isa) {
    case Isa::sse2:
        return std::string("sse2");
    case Isa::avx512:
        return avx512 ? Result<std::string>(std::string("avx512")) : missing("AVX-512");
    case Isa::avx2:
        return __builtin_cpu_supports("avx2") ? Result<std::string>(std::string("avx2")) : missing("AVX2");
    case Isa::automatic:
        break;
    }
    if (__builtin_cpu_supports("avx2")) return std::string("avx2");
    return std::string(__builtin_cpu_supports("avx") ? "avx" : "sse2");
}

/// Lets a ray through where the alpha mask is below its cutoff.
struct CutOut {
    const Scene* scene;
    const Mesh* mesh;
    const Material* material;

    [[nodiscard]] bool isHole(unsigned primitive, glm::vec2 barycentric) const
    {
        const glm::uvec3 t = mesh->triangles[primitive];
        const float b0 = 1.0f - barycentric.x - barycentric.y;
        float alpha = material->baseColor.w;
        const auto& uv = mesh->uv[material->baseColorTexture.uvSet];
        if (material->baseColorTexture.isSet() && !uv.empty()) {
            const glm::vec2 at = b0 * uv[t.x] + barycentric.x * uv[t.y] + barycentric.y * uv[t.z];
            alpha *= sampleTexture(*scene, material->baseColorTexture, at, true).w;
        }
        if (!mesh->colors.empty()) {
            alpha *=
                b0 * mesh->colors[t.x].w + barycentric.x * mesh->colors[t.y].w + barycentric.y * mesh->colors[t.z].w;
        }
        return alpha < material->alphaCutoff;
    }
};

void rejectHoles(const RTCFilterFunctionNArguments* args)
{
    const auto* cutOut = static_cast<const CutOut*>(args->geometryUserPtr);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] != -1) continue;
        const glm::vec2 b(RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i));
        if (cutOut->isHole(RTCHitN_primID(args->hit, args->N, i), b)) args->valid[i] = 0;
    }
}

Error stopped() { return {Error::Kind::cancelled, "building the ray scene was cancelled"}; }

bool monitor(void* stop, double) { return !static_cast<std::stop_token*>(stop)->stop_requested(); }

} // namespace

struct RayScene::State {
    std::shared_ptr<const Scene> scene; // that it was built from: cut-outs look at its images
    std::string isa;
    std::vector<SceneTriangle> triangles;
    std::vector<std::uint32_t> firstTriangle; // per instance, and the end
    std::vector<CutOut> cutOuts;              // stable addresses: reserved before use
    Device device;
    std::vector<Tree> shared; // trees of meshes that stand in several places, by mesh
    Tree tree;

    bool listTriangles(const std::stop_token& stop); ///< false: stopped
    Result<Done> buildTree(std::stop_token& stop);
    void addMesh(RTCScene into, const Instance& instance, bool inPlace, unsigned id);
    Result<Done> commit(RTCScene tree, std::stop_token& stop);
};

bool RayScene::State::listTriangles(const std::stop_token& stop)
{
    for (std::uint32_t i = 0; i < scene->instances.size(); ++i) {
        const Instance& instance = scene->instances[i];
        const Mesh& mesh = scene->meshes[static_cast<std::size_t>(instance.mesh)];
        firstTriangle.push_back(static_cast<std::uint32_t>(triangles.size()));
        const float turn = instance.isMirrored() ? -1.0f : 1.0f;
        std::vector<glm::vec3> placed(mesh.positions.size());
        for (std::size_t v = 0; v < placed.size(); ++v) {
            placed[v] = glm::vec3(instance.toWorld * glm::vec4(mesh.positions[v], 1.0f));
        }
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            if (t % 65'536 == 0 && stop.stop_requested()) return false;
            const glm::uvec3 v = mesh.triangles[t];
            SceneTriangle triangle{placed[v.x], placed[v.y], placed[v.z], glm::vec3(0.0f), i, t};
            // in double: the cross product of a needle's edges underflows in float at small scales
            const glm::dvec3 n = glm::cross(glm::dvec3(triangle.b) - glm::dvec3(triangle.a),
                                            glm::dvec3(triangle.c) - glm::dvec3(triangle.a));
            const double length = glm::length(n);
            if (length > 0.0) triangle.normal = turn * glm::vec3(n / length);
            triangles.push_back(triangle);
        }
    }
    firstTriangle.push_back(static_cast<std::uint32_t>(triangles.size()));
    return true;
}

void RayScene::State::addMesh(RTCScene into, const Instance& instance, bool inPlace, unsigned id)
{
    const Mesh& mesh = scene->meshes[static_cast<std::size_t>(instance.mesh)];
    const Geometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), mesh.positions.size()));
    auto* indices = static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), mesh.triangles.size()));
    if (!vertices || !indices) throw std::bad_alloc();
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const glm::vec3 p = mesh.positions[v];
        vertices[v] = inPlace ? glm::vec3(instance.toWorld * glm::vec4(p, 1.0f)) : p;
    }
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
    const Material& material = scene->materials[static_cast<std::size_t>(mesh.material)];
    if (material.alpha == Material::Alpha::mask) {
        cutOuts.push_back({scene.get(), &mesh, &material});
        rtcSetGeometryUserData(geometry.get(), &cutOuts.back());
        rtcSetGeometryIntersectFilterFunction(geometry.get(), rejectHoles);
        rtcSetGeometryOccludedFilterFunction(geometry.get(), rejectHoles);
    }
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(into, geometry.get(), id);
}

Result<Done> RayScene::State::commit(RTCScene what, std::stop_token& stop)
{
    rtcSetSceneFlags(what, RTC_SCENE_FLAG_ROBUST); // else a third of the rays at mesh vertices leak out
    rtcSetSceneBuildQuality(what, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneProgressMonitorFunction(what, monitor, &stop);
    rtcCommitScene(what);
    rtcSetSceneProgressMonitorFunction(what, nullptr, nullptr);
    const RTCError code = rtcGetDeviceError(device.get());
    if (stop.stop_requested()) return stopped();
    if (code == RTC_ERROR_OUT_OF_MEMORY) {
        return Error{Error::Kind::outOfMemory,
                     fmt::format("not enough memory for a ray tree over {} triangles", triangles.size())};
    }
    if (code != RTC_ERROR_NONE) {
        return Error{Error::Kind::unsupported,
                     fmt::format("Embree could not build the ray tree (code {})", static_cast<int>(code))};
    }
    return Done{};
}

Result<Done> RayScene::State::buildTree(std::stop_token& stop)
{
    tree.reset(rtcNewScene(device.get()));
    std::vector<int> uses(scene->meshes.size(), 0);
    for (const Instance& instance : scene->instances) ++uses[static_cast<std::size_t>(instance.mesh)];
    shared.resize(scene->meshes.size());
    cutOuts.reserve(scene->instances.size() + scene->meshes.size());

    for (unsigned i = 0; i < scene->instances.size(); ++i) {
        const Instance& instance = scene->instances[i];
        if (stop.stop_requested()) return stopped();
        const auto m = static_cast<std::size_t>(instance.mesh);
        if (uses[m] == 1) {
            addMesh(tree.get(), instance, true, i);
            continue;
        }
        if (!shared[m]) {
            shared[m].reset(rtcNewScene(device.get()));
            addMesh(shared[m].get(), instance, false, 0);
            if (const Result<Done> built = commit(shared[m].get(), stop); !built) return built;
        }
        const Geometry place(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(place.get(), shared[m].get());
        rtcSetGeometryTransform(place.get(), 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &instance.toWorld[0].x);
        rtcCommitGeometry(place.get());
        rtcAttachGeometryByID(tree.get(), place.get(), i);
    }
    return commit(tree.get(), stop);
}

Result<std::shared_ptr<const RayScene>> RayScene::build(std::shared_ptr<const Scene> scene, Isa isa,
                                                        std::stop_token stop)
try {
    const Result<std::string> config = isaConfig(isa);
    if (!config) return config.error();
    const auto state = std::make_shared<State>();
    state->scene = scene;
    state->isa = *config;
    state->device.reset(rtcNewDevice(embreeOptions(*config).c_str()));
    if (!state->device) return Error{Error::Kind::unsupported, "Embree does not run on this machine"};
    if (!state->listTriangles(stop)) return stopped();
    if (const Result<Done> built = state->buildTree(stop); !built) return built.error();
    return std::shared_ptr<const RayScene>(new RayScene(state, std::move(scene)));
} catch (const std::bad_alloc&) {
    return Error{Error::Kind::outOfMemory, "not enough memory for the scene's triangles"};
}

RayScene::RayScene(std::shared_ptr<const State> state, std::shared_ptr<const Scene> scene)
    : state_(std::move(state)), scene_(std::move(scene)), triangles_(state_->triangles.data()),
      // an empty or single-point scene still needs a positive step
      offset_(glm::max(1e-5f * scene_->bounds.diagonal(), std::numeric_limits<float>::min() * 1e6f)),
      looks_(instanceLooks(*scene_))
{
}

std::shared_ptr<const RayScene> RayScene::withScene(std::shared_ptr<const Scene> scene) const
{
    return std::shared_ptr<const RayScene>(new RayScene(state_, std::move(scene)));
}

RayScene::~RayScene() = default;

std::uint32_t RayScene::triangleCount() const { return static_cast<std::uint32_t>(state_->triangles.size()); }
std::uint32_t RayScene::firstTriangle(std::uint32_t instance) const { return state_->firstTriangle[instance]; }
std::string_view RayScene::isaName() const { return state_->isa; }
void* RayScene::embreeScene() const { return state_->tree.get(); }

float RayScene::triangleArea(std::uint32_t index) const
{
    const SceneTriangle& t = state_->triangles[index];
    return static_cast<float>(
        0.5 * glm::length(glm::cross(glm::dvec3(t.b) - glm::dvec3(t.a), glm::dvec3(t.c) - glm::dvec3(t.a))));
}

const Material& RayScene::material(std::uint32_t index) const
{
    const Instance& instance = scene_->instances[state_->triangles[index].instance];
    const Mesh& mesh = scene_->meshes[static_cast<std::size_t>(instance.mesh)];
    return scene_->materials[static_cast<std::size_t>(mesh.material)];
}

bool RayScene::intersect(glm::vec3 origin, glm::vec3 travel, float most, Hit& hit) const
{
    if (!isFinite(origin) || !isFinite(travel)) return false; // Embree does not filter NaN
    RTCRayHit query;
    query.ray = {origin.x, origin.y, origin.z, 0.0f, travel.x, travel.y, travel.z, 0.0f, most, 0xFFFFFFFFu, 0, 0};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(state_->tree.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;

    hit.distance = query.ray.tfar;
    const unsigned instance = query.hit.instID[0] != RTC_INVALID_GEOMETRY_ID ? query.hit.instID[0] : query.hit.geomID;
    hit.triangle = state_->firstTriangle[instance] + query.hit.primID;
    hit.instance = instance;
    hit.barycentric = {query.hit.u, query.hit.v};
    placeOn(triangles_[hit.triangle], travel, hit);
    return true;
}

namespace {

/// Whole vectors are written: narrower ones would still be on their way to memory when Embree reads wide ones.
/// Up to distance `most` along d; nothing is met where a ray is not finite or not among the first `count`.
[[gnu::always_inline]] inline void prepare(const Floats8 (&o)[3], const Floats8 (&d)[3], std::size_t count, float most,
                                           RTCRay8& ray, int* valid)
{
    const Floats8 zero{};
    const Ints8 none{}, lane{0, 1, 2, 3, 4, 5, 6, 7};
    float* const origin[] = {ray.org_x, ray.org_y, ray.org_z};
    float* const travel[] = {ray.dir_x, ray.dir_y, ray.dir_z};
    Floats8 sum = zero;
    for (int axis = 0; axis < 3; ++axis) {
        lanesOf<Floats8>(origin[axis], 0) = o[axis], lanesOf<Floats8>(travel[axis], 0) = d[axis];
        sum += o[axis] + d[axis];
    }
    const Ints8 isValid = (sum * 0.0f == 0.0f) & (lane < static_cast<int>(count)); // NaN unless all are finite
    lanesOf<Ints8>(valid, 0) = isValid;
    lanesOf<Floats8>(ray.tnear, 0) = lanesOf<Floats8>(ray.time, 0) = zero;
    lanesOf<Floats8>(ray.tfar, 0) = isValid ? zero + most : zero - 1.0f;
    lanesOf<Ints8>(ray.mask, 0) = none - 1;
    lanesOf<Ints8>(ray.id, 0) = lanesOf<Ints8>(ray.flags, 0) = none;
}

LIGHTLOOM_WIDE_VECTORS void prepare(const Rays8& rays, std::size_t count, RTCRayHit8& query, int* valid)
{
    Floats8 o[3], d[3];
    for (int axis = 0; axis < 3; ++axis)
        o[axis] = lanesOf<Floats8>(rays.origin[axis], 0), d[axis] = lanesOf<Floats8>(rays.travel[axis], 0);
    prepare(o, d, count, std::numeric_limits<float>::infinity(), query.ray, valid);
    static_assert(RTC_INVALID_GEOMETRY_ID == ~0u);
    lanesOf<Ints8>(query.hit.geomID, 0) = lanesOf<Ints8>(query.hit.instID[0], 0) = Ints8{} - 1;
}

/// Rays along all of the way but its very end are one length.
constexpr float kNearlyThere = 1.0f - 1e-6f;

LIGHTLOOM_WIDE_VECTORS void prepare(const Sights8& sights, std::size_t count, RTCRay8& ray, int* valid)
{
    Floats8 o[3], d[3];
    for (int axis = 0; axis < 3; ++axis)
        o[axis] = lanesOf<Floats8>(sights.from[axis], 0), d[axis] = lanesOf<Floats8>(sights.to[axis], 0) - o[axis];
    prepare(o, d, count, kNearlyThere, ray, valid); // where it is not finite, it counts as blocked
}

} // namespace

void RayScene::intersect(const Rays8& rays, std::size_t count, Met8& met) const
{
    static_assert(Rays8::kCount == kLanes);
    alignas(32) std::array<int, kLanes> valid;
    RTCRayHit8 query;
    prepare(rays, count, query, valid.data());
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect8(valid.data(), state_->tree.get(), &context, &query);
    std::ranges::copy(query.hit.u, met.u);
    std::ranges::copy(query.hit.v, met.v);
    std::ranges::copy(query.ray.tfar, met.distance);
    const std::uint32_t* firstTriangle = state_->firstTriangle.data();
    for (std::size_t i = 0; i < kLanes; ++i) {
        const unsigned geometry = query.hit.geomID[i], place = query.hit.instID[0][i];
        met.triangle[i] = Met8::kNothing;
        if (geometry == RTC_INVALID_GEOMETRY_ID) continue;
        met.instance[i] = place != RTC_INVALID_GEOMETRY_ID ? place : geometry;
        met.triangle[i] = firstTriangle[met.instance[i]] + query.hit.primID[i];
        __builtin_prefetch(triangles_ + met.triangle[i]);
    }
}

std::uint32_t RayScene::areBlocked(const Sights8& sights, std::size_t count) const
{
    static_assert(Sights8::kCount == kLanes);
    alignas(32) std::array<int, kLanes> valid;
    RTCRay8 query;
    prepare(sights, count, query, valid.data());
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded8(valid.data(), state_->tree.get(), &context, &query);
    std::uint32_t blocked = 0;
    for (std::size_t i = 0; i < count; ++i) blocked |= std::uint32_t(query.tfar[i] < 0.0f) << i;
    return blocked;
}

bool RayScene::isBlocked(glm::vec3 origin, glm::vec3 travel, float most) const
{
    if (!isFinite(origin) || !isFinite(travel)) return true;
    RTCRay ray{origin.x, origin.y, origin.z, 0.0f, travel.x, travel.y, travel.z, 0.0f, most, 0xFFFFFFFFu, 0, 0};
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(state_->tree.get(), &context, &ray);
    return ray.tfar < 0.0f;
}

bool RayScene::isBlocked(glm::vec3 from, glm::vec3 to) const { return isBlocked(from, to - from, kNearlyThere); }

} // namespace lightloom
