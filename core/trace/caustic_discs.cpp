// SPDX-License-Identifier: Apache-2.0
#include "core/trace/caustic_discs.h"
#include "core/base/sampling.h"
#include "core/trace/embree_options.h"
#include <cmath>
#include <embree3/rtcore.h>
#include <new>

namespace lightloom {
namespace {

/// Sums of one disc, in quanta.
struct Catch {
    std::array<std::atomic<std::int64_t>, 3> flux{};
    std::array<std::atomic<std::int64_t>, CausticDiscs::kCells> cells{}; // of luminance
};

/// One photon on its way; what Embree's callback is handed.
struct Flight {
    RTCIntersectContext context; // first: Embree gives back a pointer to it
    const std::vector<CatchPoint>* points;
    std::vector<Catch>* catches;
    glm::vec3 origin, travel;
    std::array<std::int64_t, 3> flux;
    std::int64_t luminance;
};

std::size_t cellOf(const CatchPoint& point, glm::vec3 crossing)
{
    const Frame frame(point.normal);
    const glm::vec3 d = crossing - point.position;
    const float x = glm::dot(d, frame.tangent), y = glm::dot(d, frame.bitangent);
    const std::size_t ring = x * x + y * y < 0.5f * point.radius * point.radius ? 0 : 4;
    return ring + (x < 0.0f ? 1 : 0) + (y < 0.0f ? 2 : 0);
}

/// Counts every disc that is crossed, and lets the ray go on.
void countCrossing(const RTCFilterFunctionNArguments* args)
{
    auto* flight = reinterpret_cast<Flight*>(args->context);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] != -1) continue;
        args->valid[i] = 0;
        const unsigned k = RTCHitN_primID(args->hit, args->N, i);
        const CatchPoint& point = (*flight->points)[k];
        if (!(glm::dot(point.normal, flight->travel) < 0.0f)) continue; // from behind
        Catch& found = (*flight->catches)[k];
        for (std::size_t c = 0; c < 3; ++c) found.flux[c].fetch_add(flight->flux[c], std::memory_order_relaxed);
        const float t = RTCRayN_tfar(args->ray, args->N, i);
        const std::size_t cell = cellOf(point, flight->origin + t * flight->travel);
        found.cells[cell].fetch_add(flight->luminance, std::memory_order_relaxed);
    }
}

} // namespace

struct CausticDiscs::State {
    std::vector<CatchPoint> points;
    std::vector<Catch> catches;
    double quantum = 1.0;
    RTCDevice device = nullptr;
    RTCScene tree = nullptr;
    ~State()
    {
        if (tree) rtcReleaseScene(tree);
        if (device) rtcReleaseDevice(device);
    }
    void build();
};

void CausticDiscs::State::build()
{
    tree = rtcNewScene(device);
    RTCGeometry discs = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    auto* spheres = static_cast<glm::vec4*>(
        rtcSetNewGeometryBuffer(discs, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(glm::vec4), points.size()));
    auto* normals = static_cast<glm::vec3*>(
        rtcSetNewGeometryBuffer(discs, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), points.size()));
    const bool isMade = spheres && normals;
    for (std::size_t i = 0; isMade && i < points.size(); ++i) {
        spheres[i] = glm::vec4(points[i].position, points[i].radius);
        normals[i] = points[i].normal;
    }
    rtcSetGeometryOccludedFilterFunction(discs, countCrossing);
    rtcCommitGeometry(discs);
    rtcAttachGeometry(tree, discs);
    rtcReleaseGeometry(discs);
    rtcSetSceneFlags(tree, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(tree);
    if (!isMade || rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::bad_alloc();
}

CausticDiscs::CausticDiscs(const RayScene& rays, const std::vector<CatchPoint>& points, double scale)
    : state_(std::make_unique<State>())
{
    State& s = *state_;
    s.points = points;
    s.catches = std::vector<Catch>(points.size());
    // 2^52 quanta below the scale: no photon's rounding shows, and sums a thousand times as large still fit
    s.quantum = std::ldexp(1.0, std::ilogb(std::max(scale, 1e-300)) + 1 - 52);
    s.device = rtcNewDevice(embreeOptions(rays.isaName()).c_str());
    if (!s.device) throw std::bad_alloc();
    if (!points.empty()) s.build();
}
CausticDiscs::~CausticDiscs() = default;

void CausticDiscs::send(glm::vec3 from, glm::vec3 to, float past, glm::vec3 flux) const
{
    const glm::vec3 d = to - from;
    const float length = glm::length(d);
    if (!(length > 0.0f) || !isFinite(flux) || state_->points.empty()) return;
    Flight flight;
    rtcInitIntersectContext(&flight.context);
    flight.points = &state_->points;
    flight.catches = &state_->catches;
    flight.origin = from;
    flight.travel = d / length;
    const auto quanta = [&](double lumen) { return static_cast<std::int64_t>(std::llround(lumen / state_->quantum)); };
    for (int c = 0; c < 3; ++c) flight.flux[static_cast<std::size_t>(c)] = quanta(static_cast<double>(flux[c]));
    flight.luminance = quanta(static_cast<double>(luminance(flux)));
    const glm::vec3 w = flight.travel;
    RTCRay ray{from.x, from.y, from.z, 0.0f, w.x, w.y, w.z, 0.0f, length + past, 0xFFFFFFFFu, 0, 0};
    rtcOccluded1(state_->tree, &flight.context, &ray);
}

glm::dvec3 CausticDiscs::illuminance(std::size_t point) const
{
    const double r = static_cast<double>(state_->points[point].radius);
    const double scale = state_->quantum / (std::numbers::pi * r * r);
    const auto& flux = state_->catches[point].flux;
    return scale * glm::dvec3(static_cast<double>(flux[0]), static_cast<double>(flux[1]), static_cast<double>(flux[2]));
}

std::array<double, CausticDiscs::kCells> CausticDiscs::parts(std::size_t point) const
{
    const double r = static_cast<double>(state_->points[point].radius);
    const double scale = state_->quantum * kCells / (std::numbers::pi * r * r);
    std::array<double, kCells> parts{};
    for (std::size_t i = 0; i < kCells; ++i) parts[i] = scale * static_cast<double>(state_->catches[point].cells[i]);
    return parts;
}

float clearRadius(const RayScene& rays, glm::vec3 position, glm::vec3 normal, float most)
{
    constexpr int kDirections = 16;
    const Frame frame(normal);
    const glm::vec3 start = rays.leave(position, normal);
    float clear = most;
    for (int i = 0; i < kDirections; ++i) {
        const float phi = 2.0f * kPi * (static_cast<float>(i) + 0.5f) / kDirections;
        Hit hit;
        if (rays.intersect(start, frame.toWorld({std::cos(phi), std::sin(phi), 0.0f}), clear, hit))
            clear = hit.distance;
    }
    // between two directions the nearest wall may be a little nearer
    if (clear < most) clear *= std::cos(kPi / kDirections);
    return glm::max(clear, 0.02f * most);
}

} // namespace lightloom
