// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/view_worker.h"
#include "core/base/units.h"
#include "core/trace/direct_light.h"

namespace lightloom {

namespace {

constexpr int kShadowRays = 64; ///< per shining surface; a figure under a cursor needs no more

Measurement measureAt(const BakeView& view, const Mix& mix, glm::vec3 p, glm::vec3 n)
{
    Measurement out;
    out.isOnSurface = true;
    out.position = p;
    glm::vec3 lux(0.0f);
    if (view.snapshot.field && view.snapshot.field->lookup(p, n, lux)) out.indirectLux = luminance(lux);
    out.directLux = -1.0;
    if (view.rays && view.lights) {
        Rng rng(1, 0, 0);
        out.directLux = luminance(directIlluminance(*view.rays, *view.lights, mix, p, n, kShadowRays, rng));
    }
    return out;
}

} // namespace

ViewWorker::ViewWorker(QObject* parent) : QObject(parent), thread_([this](const std::stop_token& quit) { work(quit); })
{
}

ViewWorker::~ViewWorker()
{
    thread_.request_stop();
    thread_.join();
}

void ViewWorker::look(BakeView view, Look look)
{
    std::lock_guard lock(mutex_);
    look_ = LookRequest{std::move(view), std::move(look)};
    wake_.notify_one();
}

void ViewWorker::measure(BakeView view, Mix mix, glm::vec3 p, glm::vec3 n)
{
    std::lock_guard lock(mutex_);
    measure_ = MeasureRequest{std::move(view), std::move(mix), p, n};
    wake_.notify_one();
}

void ViewWorker::pick(BakeView view, glm::vec3 p, glm::vec3 n)
{
    std::lock_guard lock(mutex_);
    pick_ = PickRequest{std::move(view), p, n};
    wake_.notify_one();
}

void ViewWorker::lines(BakeView view, int direction)
{
    std::lock_guard lock(mutex_);
    lines_ = LineRequest{std::move(view), direction};
    wake_.notify_one();
}

void ViewWorker::work(const std::stop_token& quit)
{
    const FlushDenormals flush;
    LineVoxels lineVoxels;
    while (true) {
        std::unique_lock lock(mutex_);
        const auto isAsked = [this] { return look_ || measure_ || pick_ || lines_; };
        if (!wake_.wait(lock, quit, isAsked) || quit.stop_requested()) return;
        if (look_) {
            LookRequest request = std::move(*look_);
            look_.reset();
            lock.unlock();
            Q_EMIT looked(withLook(std::move(request.view), request.look));
        } else if (pick_) {
            const PickRequest request = std::move(*pick_);
            pick_.reset();
            lock.unlock();
            Q_EMIT picked(pickedLeaf(request.view, request.p, request.n));
        } else if (lines_) {
            const LineRequest request = std::move(*lines_);
            lines_.reset();
            lock.unlock();
            Q_EMIT lined(voxelLineMarks(request.view, request.direction, lineVoxels));
        } else {
            const MeasureRequest request = std::move(*measure_);
            measure_.reset();
            lock.unlock();
            Q_EMIT measured(measureAt(request.view, request.mix, request.p, request.n));
        }
    }
}

} // namespace lightloom
