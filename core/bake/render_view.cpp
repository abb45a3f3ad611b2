// SPDX-License-Identifier: Apache-2.0
#include "core/bake/render_view.h"
#include "core/bake/view_caustics.h"
#include "core/base/units.h"
#include "shaders/common.h"
#include <cmath>

namespace lightloom {

View continueView(const RayScene& rays, const LightSampler& lights, const Mix& mix, const IndirectField* field,
                  const ViewJob& job, ViewState& state, Workers& workers, const std::stop_token& stop,
                  const std::function<void(double)>& progress)
{
    const CausticLamps lamps(rays, lights, mix);
    const bool byPhotons = job.indirect == ViewJob::Indirect::paths && job.caustics && !lamps.isEmpty();
    const Eye eye(rays, lights, mix, field, job, byPhotons ? &lamps : nullptr);
    const auto part = [&](double from, double to) {
        return [&progress, from, to](double f) {
            if (progress) progress(from + (to - from) * f);
        };
    };
    const std::function<void(double)> first = part(0.0, byPhotons ? 0.5 : 1.0), second = part(0.5, 1.0);
    ViewPass pass{eye, job, Lens(job), workers, stop, first};
    if (job.indirect == ViewJob::Indirect::field && field->isCostly() && !job.finalGather) {
        state.middles.resize(pass.blockCount());
        pass.middles = &state.middles;
    }
    View view = job.targetError > 0.0f ? adaptiveView(pass, state.ended) : evenView(pass, state.pixels);
    if (pass.middles && eye.isByCuts()) {
        view.cutSizes = pass.cutSizes();
        for (const MiddleLight& middle : state.middles) {
            view.glossByCut += middle.glossBy == GlossBy::cut;
            view.glossByRays += middle.glossBy == GlossBy::rays;
        }
    }
    if (!byPhotons) return view;
    const ViewPass photons{eye, job, Lens(job), workers, stop, second};
    if (view.isWhole) static_cast<void>(traceCaustics(photons, rays, lamps, state));
    addCaustics(state, job, view);
    return view;
}

View renderView(const RayScene& rays, const LightSampler& lights, const Mix& mix, const IndirectField* field,
                const ViewJob& job, Workers& workers, const std::stop_token& stop,
                const std::function<void(double)>& progress)
{
    ViewState state;
    return continueView(rays, lights, mix, field, job, state, workers, stop, progress);
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
