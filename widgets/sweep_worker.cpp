// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/sweep_worker.h"
#include "core/photonmap/photon_products.h"
#include "widgets/background.h"

namespace lightloom {

namespace {

constexpr int kMostPaths = 1'048'576; ///< as the command line's: out of the way of the target

} // namespace

SweepWorker::SweepWorker(QObject* parent)
    : QObject(parent), thread_([this](const std::stop_token& quit) { work(quit); })
{
}

SweepWorker::~SweepWorker()
{
    thread_.request_stop();
    thread_.join();
}

std::uint64_t SweepWorker::start(SweepOrder order)
{
    std::lock_guard lock(mutex_);
    order.serial = ++serial_;
    order_ = std::move(order);
    running_.request_stop();
    wake_.notify_all();
    return serial_;
}

void SweepWorker::cancel()
{
    std::lock_guard lock(mutex_);
    order_.reset();
    running_.request_stop();
}

void SweepWorker::setHeld(bool held)
{
    std::lock_guard lock(mutex_);
    isHeld_ = held;
    if (control_ != nullptr) control_->setPaused(held);
    if (held) tracing_.request_stop(); // what it had is kept on disk and gone on with
    wake_.notify_all();
}

bool SweepWorker::waitWhileHeld(const std::stop_token& stop)
{
    std::unique_lock lock(mutex_);
    return wake_.wait(lock, stop, [this] { return !isHeld_; }) && !stop.stop_requested();
}

void SweepWorker::work(const std::stop_token& quit)
{
    lowerPriority(kSweepNice);
    Workers workers; // its threads inherit the priority
    const FlushDenormals flush;
    BakeProducts products;
    std::shared_ptr<const Scene> scene; // that the products are of
    while (true) {
        std::unique_lock lock(mutex_);
        if (!wake_.wait(lock, quit, [this] { return order_.has_value(); }) || quit.stop_requested()) return;
        const SweepOrder order = std::move(*order_);
        order_.reset();
        std::stop_source run;
        running_ = run;
        lock.unlock();
        const std::stop_callback linked(quit, [&run] { run.request_stop(); });
        if (scene != order.plan.scene) products.clear();
        scene = order.plan.scene;
        const Result<Done> done = [&]() -> Result<Done> {
            try {
                return this->run(order, products, workers, run.get_token());
            } catch (const std::bad_alloc&) {
                return Error{Error::Kind::outOfMemory, "the sweep needs more memory than there is; lower its values"};
            }
        }();
        if (quit.stop_requested()) return;
        const bool isCancelled = !done && done.error().kind == Error::Kind::cancelled;
        Q_EMIT finished(order.serial, done || isCancelled ? QString() : QString::fromStdString(done.error().message),
                        isCancelled);
    }
}

Result<Done> SweepWorker::run(const SweepOrder& order, BakeProducts& products, Workers& workers,
                              const std::stop_token& stop)
{
    if (!waitWhileHeld(stop)) return cancelled();
    BakeControl preparing(workers, {}, stop);
    const Result<SceneProducts> at =
        sceneProducts({order.plan.scene, order.plan.base, {}, order.plan.isa}, products, preparing);
    if (!at) return at.error();
    const Result<Judge> judged = judge(order, *at, workers, stop);
    if (!judged) return judged.error();
    BakeControl control(workers,
                        {{},
                         [&](const Progress& p) {
                             Q_EMIT progressed({false, p.fraction, p.remainingSeconds, order.serial});
                         }},
                        stop);
    struct Forget { // however the sweep ends
        SweepWorker& worker;
        ~Forget()
        {
            std::lock_guard lock(worker.mutex_);
            worker.control_ = nullptr;
        }
    } forget{*this};
    {
        std::lock_guard lock(mutex_);
        control_ = &control;
        control.setPaused(isHeld_);
    }
    return runSweep(order.plan, *judged, {}, products, control,
                    [&](SweepRow row) { Q_EMIT rowDone(order.serial, std::move(row)); });
}

/// A reference cannot be paused, but stopped and gone on with.
Result<Judge> SweepWorker::judge(const SweepOrder& order, const SceneProducts& at, Workers& workers,
                                 const std::stop_token& stop)
{
    const std::vector<ProbeRow> rows = probeRows(at, order.points, kJudgeSeed);
    if (rows.empty()) return Error{Error::Kind::badInput, "no surface has an area that light can reach"};
    const BakeParams& p = order.plan.base;
    const ReferenceJob job{kJudgeSeed, kMostPaths, order.noise, p.pathDepth, p.directSamples};
    const ReferenceStore store(order.sceneFile.toStdString());
    while (waitWhileHeld(stop)) {
        std::stop_source stretch;
        {
            std::lock_guard lock(mutex_);
            tracing_ = stretch;
            if (isHeld_) continue;
        }
        const std::stop_callback linked(stop, [&stretch] { stretch.request_stop(); });
        Result<Judge> judged = traceJudge(at, rows, job, store, workers, stretch.get_token(), [&](double fraction) {
            Q_EMIT progressed({true, fraction, -1.0, order.serial});
        });
        const bool isStopped = !judged && judged.error().kind == Error::Kind::cancelled;
        if (!isStopped || stop.stop_requested()) return judged;
    }
    return cancelled();
}

} // namespace lightloom
