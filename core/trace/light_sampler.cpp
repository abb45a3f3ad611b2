// SPDX-License-Identifier: Apache-2.0
#include "core/trace/light_sampler.h"
#include "core/base/sampling.h"
#include "core/trace/emission_mean.h"
#include "core/trace/material.h"
#include "core/trace/spot_cone.h"
#include "core/trace/sun_aim.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace lightloom {
namespace {

constexpr double kPiD = std::numbers::pi;
/// Share of a group's photons dealt out evenly over its emitters, the rest by flux: the floor for dim lamps.
constexpr double kEvenShare = 0.1;
/// Suns whose photons are aimed, the strongest of each group: aiming takes some 10 ms each, and it cannot be stopped.
/// Other groups' suns have no say: photons are kept by what their own group is.
constexpr std::size_t kMostAims = 4;
/// Texture lookups spent on the mean of one emitter: about .1 s.
constexpr double kMostLookups = 4e6;
/// Below this cosine a patch counts as seen edge-on: nothing comes from it and no density stays finite.
constexpr float kLeastCosine = 1e-6f;

/// First entry of a rising sum that exceeds `at`.
std::size_t pick(const std::vector<double>& sums, double at)
{
    std::size_t i = 0; // halving without a branch that depends on `at`, which no processor can foresee
    for (std::size_t left = sums.size(); left > 0;) {
        const std::size_t half = (left + 1) / 2;
        i += sums[i + half - 1] <= at ? half : 0;
        left -= half;
    }
    if (i < sums.size()) return i;
    do --i; // rounding carried `at` past the end: the last entry that has a width
    while (i > 0 && sums[i] <= sums[i - 1]);
    return i;
}

/// How far `at` lies within entry `i` of a rising sum, in [0,1).
double within(const std::vector<double>& sums, std::size_t i, double at)
{
    const double low = i > 0 ? sums[i - 1] : 0.0, width = sums[i] - low;
    return width > 0.0 ? glm::clamp((at - low) / width, 0.0, 1.0 - 0x1p-24) : 0.0;
}

void drawDirection(EmittedPhoton& photon)
{
    if (!photon.isUnaimed) return;
    photon.travel = Frame(photon.side).toWorld(sampleCosineHemisphere(photon.aim.x, photon.aim.y));
    photon.isUnaimed = false;
}

/// Density per solid angle at `p` of a point picked by area; 0 for patches seen edge-on or touched.
float solidAngleDensity(glm::vec3 p, glm::vec3 onLight, glm::vec3 normal, float area)
{
    const glm::vec3 d = onLight - p;
    const float squared = glm::dot(d, d);
    if (!(squared > 0.0f)) return 0.0f;
    const float cosine = std::abs(glm::dot(d, normal)) / std::sqrt(squared);
    return cosine > kLeastCosine ? squared / (cosine * area) : 0.0f;
}

glm::vec3 pointOn(const SceneTriangle& t, glm::vec2 b) { return t.a * (1.0f - b.x - b.y) + t.b * b.x + t.c * b.y; }

/// The triangles of one emissive instance.
struct Shape {
    std::uint32_t first = 0;
    std::vector<double> areas; // summed up to and including each triangle, m2
    bool bothSides = false;
    [[nodiscard]] double area() const { return areas.empty() ? 0.0 : areas.back(); }
};

double luminous(glm::dvec3 c)
{
    return static_cast<double>(kLumaR) * c.x + static_cast<double>(kLumaG) * c.y + static_cast<double>(kLumaB) * c.z;
}

bool emitsAlike(const Material& a, const Material& b)
{
    return a.emission == b.emission && a.emissionTexture == b.emissionTexture && a.doubleSided == b.doubleSided;
}

/// Who is shot from in one group.
struct Dealer {
    std::vector<int> emitters;
    std::vector<double> sums;  // chances, summed
    std::vector<float> scales; // 1 / chance of each
    glm::dvec3 flux{0.0};
};

} // namespace

struct LightSampler::State {
    std::shared_ptr<const RayScene> rays;
    std::vector<Emitter> emitters;
    std::vector<glm::dvec3> flux;            // as Emitter::flux
    std::vector<Shape> shapes;               // by emitter, empty for punctual lights
    std::vector<SpotCone> cones;             // by emitter, spots only
    std::vector<std::optional<SunAim>> aims; // by emitter, directional lights only
    std::vector<Dealer> groups;
    std::vector<int> emitterOfInstance;
    glm::vec3 centre{0.0f}; // of a sphere around the scene, for directional lights
    float radius = 0.0f;

    void addPunctual(int index);
    void addSurface(int index, const State* earlier);
    bool takeSurface(int index, const State& earlier);
    void add(const Emitter& emitter, glm::dvec3 lumen);
    void aim(const State* earlier);
    void deal();
    [[nodiscard]] const PunctualLight& light(const Emitter& e) const
    {
        return rays->scene().lights[static_cast<std::size_t>(e.light)];
    }
    void emit(std::size_t emitter, Rng& rng, EmittedPhoton& out) const;
    void emitDirectional(const std::optional<SunAim>& aim, const Emitter& e, Rng& rng, EmittedPhoton& out) const;
    void emitPunctual(const Emitter& e, const SpotCone& cone, Rng& rng, EmittedPhoton& out) const;
    void emitSurface(const Emitter& e, const Shape& shape, Rng& rng, EmittedPhoton& out) const;
    bool samplePunctual(const Emitter& e, const SpotCone& cone, glm::vec3 p, LightSample& out) const;
    bool sampleSurface(const Shape& shape, glm::vec3 p, glm::vec2 u, LightSample& out) const;
};

void LightSampler::State::add(const Emitter& emitter, glm::dvec3 lumen)
{
    emitters.push_back(emitter);
    emitters.back().flux = glm::vec3(lumen);
    flux.push_back(lumen);
    shapes.resize(emitters.size());
    cones.resize(emitters.size());
    aims.resize(emitters.size());
    Dealer& group = groups[static_cast<std::size_t>(emitter.group)];
    group.emitters.push_back(static_cast<int>(emitters.size()) - 1);
    group.flux += lumen;
}

void LightSampler::State::addPunctual(int index)
{
    const PunctualLight& l = rays->scene().lights[static_cast<std::size_t>(index)];
    Emitter e;
    e.group = l.group;
    e.light = index;
    e.centre = l.position;
    double solidAngle = 4.0 * kPiD;
    SpotCone cone;
    if (l.kind == PunctualLight::Kind::spot) {
        e.kind = Emitter::Kind::spot;
        cone = SpotCone(l);
        solidAngle = cone.solidAngle();
    } else if (l.kind == PunctualLight::Kind::directional) {
        e.kind = Emitter::Kind::directional;
        solidAngle = kPiD * static_cast<double>(radius) * static_cast<double>(radius); // here an area: lux x m2
    }
    add(e, glm::dvec3(l.intensity) * solidAngle);
    cones.back() = cone;
}

/// The sums of an instance that glows as it did in `earlier`. False: it does not.
bool LightSampler::State::takeSurface(int index, const State& earlier)
{
    const auto i = static_cast<std::size_t>(index);
    if (i >= earlier.emitterOfInstance.size() || earlier.emitterOfInstance[i] < 0) return false;
    const std::uint32_t triangle = rays->firstTriangle(static_cast<std::uint32_t>(index));
    if (triangle == rays->firstTriangle(static_cast<std::uint32_t>(index) + 1)) return false;
    if (!emitsAlike(rays->material(triangle), earlier.rays->material(triangle))) return false;
    const auto e = static_cast<std::size_t>(earlier.emitterOfInstance[i]);
    Emitter emitter = earlier.emitters[e];
    emitter.group = rays->scene().instances[i].group;
    emitterOfInstance[i] = static_cast<int>(emitters.size());
    add(emitter, earlier.flux[e]);
    shapes.back() = earlier.shapes[e];
    return true;
}

void LightSampler::State::addSurface(int index, const State* earlier)
{
    if (earlier && takeSurface(index, *earlier)) return;
    const Scene& scene = rays->scene();
    const Instance& instance = scene.instances[static_cast<std::size_t>(index)];
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    Shape shape;
    shape.first = rays->firstTriangle(static_cast<std::uint32_t>(index));
    shape.bothSides = material.doubleSided;
    double area = 0.0, squares = 0.0;
    glm::dvec3 lumen(0.0), moment(0.0);
    const double lookups = glm::clamp(kMostLookups / static_cast<double>(mesh.triangles.size() + 1), 4.0, 262'144.0);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const double a = static_cast<double>(rays->triangleArea(shape.first + t));
        area += a;
        shape.areas.push_back(area);
        lumen += meanEmission(*rays, shape.first + t, lookups) * (a * kPiD * (shape.bothSides ? 2.0 : 1.0));
        const SceneTriangle& place = rays->triangle(shape.first + t);
        const glm::dvec3 v[3] = {place.a, place.b, place.c};
        moment += a / 3.0 * (v[0] + v[1] + v[2]);
        // the mean of |x|^2 over a triangle: its corners and centroid weighted 1 1 1 9
        squares += a / 12.0 *
                   (glm::dot(v[0], v[0]) + glm::dot(v[1], v[1]) + glm::dot(v[2], v[2]) +
                    glm::dot(v[0] + v[1] + v[2], v[0] + v[1] + v[2]));
    }
    Emitter e;
    e.kind = Emitter::Kind::surface;
    e.group = instance.group;
    e.instance = index;
    if (area > 0.0) {
        const glm::dvec3 centroid = moment / area;
        e.centre = glm::vec3(centroid);
        e.spreadSquared = static_cast<float>(std::max(0.0, squares / area - glm::dot(centroid, centroid)));
    }
    emitterOfInstance[static_cast<std::size_t>(index)] = static_cast<int>(emitters.size());
    add(e, lumen);
    shapes.back() = std::move(shape);
}

void LightSampler::State::aim(const State* earlier)
{
    const auto alike = [&](std::size_t e) -> const std::optional<SunAim>* {
        for (std::size_t i = 0; earlier && i < earlier->emitters.size(); ++i) {
            if (earlier->aims[i] && earlier->light(earlier->emitters[i]).travel == light(emitters[e]).travel)
                return &earlier->aims[i];
        }
        return nullptr;
    };
    for (const Dealer& group : groups) {
        std::vector<std::size_t> suns;
        for (const int i : group.emitters) {
            const auto e = static_cast<std::size_t>(i);
            if (emitters[e].kind == Emitter::Kind::directional && luminous(flux[e]) > 0.0) suns.push_back(e);
        }
        std::ranges::stable_sort(suns, std::greater<>(), [&](std::size_t e) { return luminous(flux[e]); });
        suns.resize(std::min(suns.size(), kMostAims));
        for (const std::size_t e : suns) {
            if (const auto* aim = alike(e))
                aims[e] = *aim;
            else
                aims[e].emplace(*rays, light(emitters[e]).travel, centre, radius);
        }
    }
}

void LightSampler::State::deal()
{
    for (Dealer& group : groups) {
        const auto shines = [&](int e) {
            const auto i = static_cast<std::size_t>(e);
            // a textured emitter may shine between the points its mean was taken at
            return luminous(flux[i]) > 0.0 || shapes[i].area() > 0.0;
        };
        const auto count = static_cast<double>(std::count_if(group.emitters.begin(), group.emitters.end(), shines));
        const double all = luminous(group.flux);
        double sum = 0.0;
        for (const int e : group.emitters) {
            double chance = 0.0;
            if (shines(e)) {
                const double even = 1.0 / count;
                const double share = all > 0.0 ? luminous(flux[static_cast<std::size_t>(e)]) / all : even;
                chance = (1.0 - kEvenShare) * share + kEvenShare * even;
            }
            group.scales.push_back(chance > 0.0 ? static_cast<float>(1.0 / chance) : 0.0f);
            group.sums.push_back(sum += chance);
        }
    }
}

void LightSampler::State::emit(std::size_t e, Rng& rng, EmittedPhoton& out) const
{
    const Emitter& what = emitters[e];
    out.isUnaimed = false;
    if (what.kind == Emitter::Kind::surface)
        emitSurface(what, shapes[e], rng, out);
    else if (what.kind == Emitter::Kind::directional)
        emitDirectional(aims[e], what, rng, out);
    else
        emitPunctual(what, cones[e], rng, out);
}

void LightSampler::State::emitDirectional(const std::optional<SunAim>& aim, const Emitter& e, Rng& rng,
                                          EmittedPhoton& out) const
{
    float weight = 1.0f;
    if (aim) {
        out.position = aim->pick(rng, weight);
    } else {
        const auto [u1, u2] = rng.uniformPair();
        const glm::vec2 d = radius * sampleDisc(u1, u2);
        out.position = centre + Frame(light(e).travel).toWorld({d.x, d.y, -2.0f * radius});
    }
    out.travel = light(e).travel;
    out.side = glm::vec3(0.0f);
    out.flux = e.flux * weight;
}

void LightSampler::State::emitPunctual(const Emitter& e, const SpotCone& cone, Rng& rng, EmittedPhoton& out) const
{
    const PunctualLight& l = light(e);
    const auto [u1, u2] = rng.uniformPair();
    out.position = l.position;
    out.side = glm::vec3(0.0f);
    out.flux = e.flux;
    out.travel = e.kind == Emitter::Kind::spot ? glm::normalize(Frame(l.travel).toWorld(cone.sample(u1, u2)))
                                               : sampleSphere(u1, u2);
}

void LightSampler::State::emitSurface(const Emitter& e, const Shape& shape, Rng& rng, EmittedPhoton& out) const
{
    const auto triangle =
        shape.first + static_cast<std::uint32_t>(pick(shape.areas, rng.uniformDouble() * shape.area()));
    const auto [u1, u2] = rng.uniformPair();
    const auto [c1, c2] = rng.uniformPair();
    const glm::vec2 b = sampleTriangle(u1, u2);
    const float turn = shape.bothSides && rng.uniform() < 0.5f ? -1.0f : 1.0f;
    const SceneTriangle& place = rays->triangle(triangle);
    out.side = turn * place.normal;
    out.position = rays->leave(pointOn(place, b), out.side);
    out.isUnaimed = true;
    out.aim = {c1, c2};
    if (rays->look(place.instance).isPlain) {
        out.flux = e.flux;
    } else {
        const double lumenPerNit = kPiD * shape.area() * (shape.bothSides ? 2.0 : 1.0);
        out.flux = glm::vec3(glm::dvec3(emissionAt(*rays, triangle, b)) * lumenPerNit);
    }
}

bool LightSampler::State::samplePunctual(const Emitter& e, const SpotCone& cone, glm::vec3 p, LightSample& out) const
{
    const PunctualLight& l = light(e);
    if (e.kind == Emitter::Kind::directional) {
        out.toLight = -l.travel;
        out.distance = glm::length(p - centre) + 2.0f * radius + 1.0f; // past everything the scene has
        out.end = p + out.toLight * out.distance;
        out.illuminance = l.intensity;
        return true;
    }
    const glm::vec3 d = l.position - p;
    const float squared = glm::dot(d, d);
    if (!(squared > 0.0f)) return false;
    out.distance = std::sqrt(squared);
    out.toLight = d / out.distance;
    out.end = l.position;
    const float fade = e.kind == Emitter::Kind::spot ? cone.falloff(-glm::dot(out.toLight, l.travel)) : 1.0f;
    out.illuminance = l.intensity * (fade / squared);
    return fade > 0.0f;
}

bool LightSampler::State::sampleSurface(const Shape& shape, glm::vec3 p, glm::vec2 u, LightSample& out) const
{
    if (!(shape.area() > 0.0)) return false;
    const double at = static_cast<double>(u.x) * shape.area();
    const std::size_t picked = pick(shape.areas, at);
    const auto triangle = shape.first + static_cast<std::uint32_t>(picked);
    const glm::vec2 b = sampleTriangle(static_cast<float>(within(shape.areas, picked, at)), u.y);
    const glm::vec3 onLight = pointOn(rays->triangle(triangle), b), normal = rays->triangleNormal(triangle);
    const bool isFront = glm::dot(p - onLight, normal) > 0.0f;
    if (!isFront && !shape.bothSides) return false;
    out.pdf = solidAngleDensity(p, onLight, normal, static_cast<float>(shape.area()));
    if (!(out.pdf > 0.0f)) return false;
    out.radiance = emissionAt(*rays, triangle, b);
    if (maxChannel(out.radiance) <= 0.0f) return false;
    out.toLight = glm::normalize(onLight - p);
    out.end = rays->leave(onLight, isFront ? normal : -normal);
    out.distance = glm::length(out.end - p);
    return true;
}

LightSampler::LightSampler(std::shared_ptr<const RayScene> rays, const LightSampler* earlier)
    : state_(std::make_unique<State>())
{
    State& s = *state_;
    const State* known = earlier ? earlier->state_.get() : nullptr;
    s.rays = std::move(rays);
    const Scene& scene = s.rays->scene();
    s.centre = scene.bounds.centre();
    s.radius = 0.5f * scene.bounds.diagonal() * (1.0f + 1e-5f); // rounding must leave no corner outside the disc
    s.groups.resize(scene.groups.size());
    s.emitterOfInstance.assign(scene.instances.size(), -1);
    for (std::size_t i = 0; i < scene.lights.size(); ++i) s.addPunctual(static_cast<int>(i));
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (scene.instances[i].group >= 0) s.addSurface(static_cast<int>(i), known);
    }
    s.aim(known);
    s.deal();
}
LightSampler::~LightSampler() = default;
LightSampler::LightSampler(LightSampler&&) noexcept = default;

const std::shared_ptr<const RayScene>& LightSampler::rays() const { return state_->rays; }
const std::vector<Emitter>& LightSampler::emitters() const { return state_->emitters; }
const std::vector<int>& LightSampler::inGroup(int group) const
{
    return state_->groups[static_cast<std::size_t>(group)].emitters;
}
glm::vec3 LightSampler::groupFlux(int group) const
{
    return glm::vec3(state_->groups[static_cast<std::size_t>(group)].flux);
}

bool LightSampler::launch(int group, Rng& rng, EmittedPhoton& photon) const
{
    const Dealer& dealer = state_->groups[static_cast<std::size_t>(group)];
    if (dealer.sums.empty() || !(dealer.sums.back() > 0.0)) return false;
    std::size_t i = 0;
    if (dealer.sums.size() > 1) i = pick(dealer.sums, rng.uniformDouble() * dealer.sums.back());
    state_->emit(static_cast<std::size_t>(dealer.emitters[i]), rng, photon);
    photon.flux *= dealer.scales[i];
    return maxChannel(photon.flux) > 0.0f;
}

bool LightSampler::emit(int group, Rng& rng, EmittedPhoton& photon) const
{
    const bool isLit = launch(group, rng, photon);
    drawDirection(photon);
    return isLit;
}

bool LightSampler::emitFrom(int emitter, Rng& rng, EmittedPhoton& photon) const
{
    state_->emit(static_cast<std::size_t>(emitter), rng, photon);
    drawDirection(photon);
    return maxChannel(photon.flux) > 0.0f;
}

bool LightSampler::sample(int emitter, glm::vec3 p, glm::vec2 u, LightSample& out) const
{
    const auto e = static_cast<std::size_t>(emitter);
    const Emitter& what = state_->emitters[e];
    out = LightSample{};
    return what.kind == Emitter::Kind::surface ? state_->sampleSurface(state_->shapes[e], p, u, out)
                                               : state_->samplePunctual(what, state_->cones[e], p, out);
}

float LightSampler::pdf(glm::vec3 origin, const Hit& hit) const
{
    const int e = emitterOf(hit.triangle);
    if (e < 0) return 0.0f;
    const Shape& shape = state_->shapes[static_cast<std::size_t>(e)];
    if (!hit.isFront && !shape.bothSides) return 0.0f;
    return solidAngleDensity(origin, hit.position, hit.normal, static_cast<float>(shape.area()));
}

int LightSampler::emitterOf(std::uint32_t triangle) const
{
    return state_->emitterOfInstance[state_->rays->triangle(triangle).instance];
}

float spotFalloff(const PunctualLight& light, float cosAngle) { return SpotCone(light).falloff(cosAngle); }

} // namespace lightloom
