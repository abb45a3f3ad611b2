// SPDX-License-Identifier: Apache-2.0
#include "core/bake/progressive_view.h"
#include <cassert>
#include <chrono>
#include <cmath>

namespace lightloom {

ProgressiveView::ProgressiveView(std::shared_ptr<const RayScene> rays, std::shared_ptr<const LightSampler> lights,
                                 Mix mix, std::shared_ptr<const IndirectField> field, ViewJob job, ViewState state)
    : rays_(std::move(rays)), lights_(std::move(lights)), mix_(std::move(mix)), field_(std::move(field)),
      job_(std::move(job)), state_(std::move(state))
{
    assert(job_.targetError == 0.0f);
}

View ProgressiveView::advance(double seconds, Workers& workers, const std::stop_token& stop,
                              const std::function<void(double)>& told)
{
    using Clock = std::chrono::steady_clock;
    const Clock::time_point began = Clock::now();
    const auto spent = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
    std::stop_source slice;
    const std::stop_callback linked(stop, [&slice] { slice.request_stop(); });
    const auto progress = [&](double fraction) {
        if (told) told(fraction);
        // whole just after the last tile of a camera ray, when no tile of the next one has begun (where photons follow
        // the rays, of every second one); rounds of photons are whole whenever they tell
        const double rays = fraction * job_.samples;
        const bool isEven = state_.causticRounds > 0 || std::abs(rays - std::round(rays)) < 1e-6;
        if (isEven && spent() >= seconds) slice.request_stop();
    };
    View view = continueView(*rays_, *lights_, mix_, field_.get(), job_, state_, workers, slice.get_token(), progress);
    isWhole_ = view.isWhole;
    seconds_ += spent();
    return view;
}

} // namespace lightloom
