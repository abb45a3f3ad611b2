// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/render_view.h"
#include <memory>

namespace lightloom {

/// A picture that is made a little at a time, for whoever watches: `renderView` in slices. However it is sliced, the
/// end is the same, to the bit. Without a target error (asserted): all pixels get finer together. One thread at a time.
class ProgressiveView {
public:
    /// `state`: empty, or what an earlier run of the same job left.
    ProgressiveView(std::shared_ptr<const RayScene> rays, std::shared_ptr<const LightSampler> lights, Mix mix,
                    std::shared_ptr<const IndirectField> field, ViewJob job, ViewState state = {});

    /// Goes on for about `seconds`: to the end of the camera ray per pixel that runs then, at least one, then likewise
    /// by rounds of photons (renderView), whose light is missing until then. After `stop` sooner; pixels may then
    /// differ by one ray. `told` hears often, from any thread, which part of the whole picture is done.
    [[nodiscard]] View advance(double seconds, Workers& workers, const std::stop_token& stop,
                               const std::function<void(double part)>& told = {});

    [[nodiscard]] const ViewJob& job() const { return job_; }
    [[nodiscard]] const ViewState& state() const { return state_; }
    [[nodiscard]] bool isWhole() const { return isWhole_; }
    [[nodiscard]] double seconds() const { return seconds_; } ///< spent in `advance`

private:
    std::shared_ptr<const RayScene> rays_;
    std::shared_ptr<const LightSampler> lights_;
    Mix mix_;
    std::shared_ptr<const IndirectField> field_;
    ViewJob job_;
    ViewState state_;
    bool isWhole_ = false;
    double seconds_ = 0;
};

} // namespace lightloom
