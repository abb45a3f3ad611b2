// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/frame_pacer.h"
#include <algorithm>

namespace lightloom {

namespace {
constexpr double kLongestMs = 3000.0;

int asDelay(double ms) { return static_cast<int>(std::clamp(ms, 1.0, kLongestMs)); }
} // namespace

void FramePacer::drew(float scale, bool isCoarse, double pictureMs, double allMs)
{
    lastMs_ = allMs;
    fullMs_ =
        pictureMs / (static_cast<double>(scale) * static_cast<double>(scale)); // nearly all of it goes by the pixel
    if (!isCoarse) return;
    if (pictureMs > kSmoothMs) coarseScale_ = std::max(kCoarsest, coarseScale_ * 0.8f);
    if (pictureMs < 0.4 * kSmoothMs) coarseScale_ = std::min(1.0f, coarseScale_ * 1.15f);
}

int FramePacer::pauseAfter(double ms) const { return isBusy_ ? asDelay(kPauses * ms) : 1; }
int FramePacer::sharpenMs() const { return isBusy_ ? asDelay(kPauses * std::max(fullMs_, 0.0)) : 1; }

} // namespace lightloom
