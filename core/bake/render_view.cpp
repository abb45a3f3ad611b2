// SPDX-License-Identifier: Apache-2.0
#include "core/bake/render_view.h"
#include "core/base/low_discrepancy.h"
#include "core/base/units.h"
#include "core/trace/final_gather.h"
#include "core/trace/path_walk.h"
#include "shaders/common.h"
#include <atomic>
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

constexpr int kTile = 16;
constexpr int kMostMirrors = 32; ///< between facing mirrors, say
constexpr std::uint64_t kViewStream = hashName("render view");

struct Radiance {
    glm::vec3 direct{0.0f}, indirect{0.0f};
};

/// Follows camera rays. One per thread and tile: holds no state of its own between rays.
class Eye {
public:
    Eye(const RayScene& rays, const LightSampler& lights, const Mix& mix, const IndirectField* field,
        const ViewJob& job)
        : rays_(rays), lights_(lights), mix_(mix), field_(field), job_(job), directSamples_(share(job.directSamples)),
          gatherRays_(share(job.gatherRays)), paths_(rays, lights, mix)
    {
        if (field_) cached_ = [this](glm::vec3 p, glm::vec3 n, glm::vec3& lux) { return field_->lookup(p, n, lux); };
    }

    [[nodiscard]] Radiance along(glm::vec3 origin, glm::vec3 travel, Rng& rng) const
    {
        Radiance seen;
        glm::vec3 throughput(1.0f);
        bool isGlossy = false; // behind a rough metal: all that follows is indirect, and lamps are already counted
        for (int bounce = 0; bounce < kMostMirrors; ++bounce) {
            Hit hit;
            if (!rays_.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) break;
            const Surface surface = surfaceAt(rays_, hit);
            const glm::vec3 n = hit.facing();
            const Radiance here = leaving(hit, surface, n, -travel, !isGlossy, rng);
            seen.indirect += throughput * (isGlossy ? here.direct + here.indirect : here.indirect);
            if (!isGlossy) seen.direct += throughput * here.direct;

            Scatter next;
            const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
            if (!surface.hasSpecular() && job_.indirect != ViewJob::Indirect::paths) break;
            if (!scatter(surface, n, -travel, u, next)) break;
            origin = rays_.leave(hit.position, n);
            if (job_.indirect == ViewJob::Indirect::paths && !next.isMirror) {
                seen.indirect +=
                    throughput * next.weight * paths_.radiance(origin, next.away, false, job_.pathDepth, rng);
                break;
            }
            if (!next.isSpecular) break; // its diffuse part was taken above
            throughput *= next.weight;
            isGlossy |= !next.isMirror;
            if (isGlossy && job_.indirect == ViewJob::Indirect::none) break;
            travel = next.away;
        }
        return seen;
    }

private:
    [[nodiscard]] int share(int perPixel) const { return glm::max(1, (perPixel + job_.samples - 1) / job_.samples); }

    [[nodiscard]] Radiance leaving(const Hit& hit, const Surface& surface, glm::vec3 n, glm::vec3 toEye,
                                   bool withEmission, Rng& rng) const
    {
        Radiance light;
        const glm::vec3 p = hit.position;
        const int e = withEmission ? lights_.emitterOf(hit.triangle) : -1;
        if (e >= 0) {
            light.direct += surface.emission * gainOf(mix_, lights_.emitters()[static_cast<std::size_t>(e)].group);
        }
        light.direct += directGlossy(rays_, lights_, mix_, surface, p, n, toEye, directSamples_, rng);
        if (surface.diffuse == glm::vec3(0.0f)) return light;
        const glm::vec3 matt = surface.diffuse / kPi;
        light.direct += matt * directIlluminance(rays_, lights_, mix_, p, n, directSamples_, rng);
        if (!field_ || job_.indirect != ViewJob::Indirect::field) return light;
        glm::vec3 lux(0.0f);
        if (!field_->lookup(p, n, lux)) {
            lux = gatherIndirect(rays_, lights_, mix_, cached_, p, n, gatherRays_, 1, rng);
        }
        light.indirect += matt * lux;
        return light;
    }

    const RayScene& rays_;
    const LightSampler& lights_;
    const Mix& mix_;
    const IndirectField* field_;
    const ViewJob& job_;
    int directSamples_, gatherRays_;
    PathWalk paths_;
    CachedIndirect cached_;
};

/// Rays through the pixels of a perspective camera.
class Lens {
public:
    explicit Lens(const ViewJob& job)
        : camera_(job.camera), orientation_(glm::mat3_cast(job.camera.orientation)), width_(job.width),
          height_(job.height), tanHalf_(std::tan(0.5f * job.camera.yFov))
    {
    }
    void ray(int x, int y, glm::vec2 within, glm::vec3& origin, glm::vec3& travel) const
    {
        const auto w = static_cast<float>(width_), h = static_cast<float>(height_);
        const float right = (2.0f * (static_cast<float>(x) + within.x) / w - 1.0f) * tanHalf_ * w / h;
        const float up = (1.0f - 2.0f * (static_cast<float>(y) + within.y) / h) * tanHalf_;
        const glm::vec3 toPlane = orientation_ * glm::vec3(right, up, -1.0f);
        origin = camera_.position + toPlane * camera_.nearPlane;
        travel = glm::normalize(toPlane);
    }

private:
    const Camera& camera_;
    glm::mat3 orientation_;
    int width_, height_;
    float tanHalf_;
};

/// Adds one camera ray at a time to every pixel, so that a stop leaves an even picture.
class ViewRun {
public:
    ViewRun(const Eye& eye, const ViewJob& job)
        : eye_(eye), job_(job), lens_(job), tilesX_((job.width + kTile - 1) / kTile),
          tilesY_((job.height + kTile - 1) / kTile), direct_(pixelCount()), indirect_(pixelCount()),
          taken_(pixelCount())
    {
    }
    [[nodiscard]] std::size_t tiles() const
    {
        return static_cast<std::size_t>(tilesX_) * static_cast<std::size_t>(tilesY_);
    }

    void tile(std::size_t number, int sample, const std::stop_token& stop)
    {
        const int left = static_cast<int>(number) % tilesX_ * kTile, top = static_cast<int>(number) / tilesX_ * kTile;
        for (int y = top; y < glm::min(top + kTile, job_.height); ++y) {
            if (stop.stop_requested()) return;
            for (int x = left; x < glm::min(left + kTile, job_.width); ++x) pixel(x, y, sample);
        }
    }

    [[nodiscard]] View result() const
    {
        View view{FloatImage(job_.width, job_.height), FloatImage(job_.width, job_.height), job_.samples};
        for (std::size_t i = 0; i < pixelCount(); ++i) {
            view.samples = glm::min(view.samples, taken_[i]);
            const double scale = 1.0 / glm::max(1, taken_[i]);
            view.direct.pixels[i] = glm::vec3(direct_[i] * scale);
            view.indirect.pixels[i] = glm::vec3(indirect_[i] * scale);
        }
        return view;
    }

private:
    [[nodiscard]] std::size_t pixelCount() const
    {
        return static_cast<std::size_t>(job_.width) * static_cast<std::size_t>(job_.height);
    }

    void pixel(int x, int y, int sample)
    {
        const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(job_.width) + static_cast<std::size_t>(x);
        Rng shift(job_.seed, kViewStream, i); // one shift per pixel makes its samples one even set
        Rng rng(job_.seed, mixBits(kViewStream + i), static_cast<std::uint64_t>(sample));
        glm::vec3 origin, travel;
        lens_.ray(x, y, ShiftedPoints(job_.samples, shift)[sample], origin, travel);
        const Radiance seen = eye_.along(origin, travel, rng);
        direct_[i] += glm::dvec3(seen.direct);
        indirect_[i] += glm::dvec3(seen.indirect);
        ++taken_[i];
    }

    const Eye& eye_;
    const ViewJob& job_;
    Lens lens_;
    int tilesX_, tilesY_;
    std::vector<glm::dvec3> direct_, indirect_;
    std::vector<int> taken_;
};

} // namespace

View renderView(const RayScene& rays, const LightSampler& lights, const Mix& mix, const IndirectField* field,
                const ViewJob& job, Workers& workers, const std::stop_token& stop,
                const std::function<void(double)>& progress)
{
    const Eye eye(rays, lights, mix, field, job);
    ViewRun run(eye, job);
    const double all = static_cast<double>(run.tiles()) * job.samples;
    std::atomic<std::uint64_t> done = 0;
    for (int sample = 0; sample < job.samples; ++sample) {
        const bool whole = workers.run(run.tiles(), stop, [&](std::size_t tile) {
            run.tile(tile, sample, stop);
            if (progress) progress(static_cast<double>(++done) / all);
        });
        if (!whole || stop.stop_requested()) break;
    }
    return run.result();
}

FloatImage wholeView(const View& view)
{
    FloatImage whole = view.direct;
    for (std::size_t i = 0; i < whole.pixels.size(); ++i) whole.pixels[i] += view.indirect.pixels[i];
    return whole;
}

float suitingEv(const FloatImage& radiance)
{
    double logs = 0.0;
    std::size_t lit = 0;
    for (const glm::vec3& p : radiance.pixels) {
        const float l = luminance(p);
        if (!(l > 0.0f) || !std::isfinite(l)) continue;
        logs += std::log2(static_cast<double>(l));
        ++lit;
    }
    if (lit == 0) return 0.0f;
    // exposureScale(ev) * average = .18
    return static_cast<float>(logs / static_cast<double>(lit) -
                              std::log2(0.18 / static_cast<double>(shader::exposureScale(0.0f))));
}

ByteImage onScreen(const FloatImage& radiance, float ev)
{
    FloatImage shown = radiance;
    const float scale = shader::exposureScale(ev);
    for (glm::vec3& p : shown.pixels) p = shader::toneCurve(p * scale, shader::kToneSoft);
    return toBytes(shown);
}

} // namespace lightloom
