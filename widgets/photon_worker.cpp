// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/photon_worker.h"
#include "widgets/background.h"

namespace lightloom {

namespace {

constexpr int kRoughly = 4;                                         ///< a rough picture is smaller by this, each way
constexpr double kFirstSlice = 0.2, kLastSlice = 1.5, kGrows = 0.2; ///< seconds; part of all before
constexpr auto kTellEvery = std::chrono::milliseconds(200);

std::vector<std::shared_ptr<const PhotonMap>> mapsOf(const PhotonMapField& field)
{
    std::vector<std::shared_ptr<const PhotonMap>> maps;
    for (const auto& layer : field.layers()) maps.push_back(layer.map);
    return maps;
}

/// `layers` hold caches of the same photons, gathered alike.
bool fit(const std::vector<PhotonMapField::Layer>& layers, const PhotonMapField& field)
{
    return std::ranges::equal(layers, field.layers(),
                              [](const auto& a, const auto& b) { return a.map == b.map && a.kernel == b.kernel; });
}

} // namespace

PhotonWorker::PhotonWorker(QObject* parent)
    : QObject(parent), thread_([this](const std::stop_token& quit) { work(quit); })
{
}

PhotonWorker::~PhotonWorker()
{
    thread_.request_stop();
    thread_.join();
}

std::uint64_t PhotonWorker::ask(PhotonQuestion question)
{
    std::lock_guard lock(mutex_);
    drawing_.request_stop();
    if (mapsOf(*question.photons) != fillingFor_) filling_.request_stop(); // else what is filled will serve it
    question_ = std::move(question);
    isForgotten_ = false;
    wake_.notify_one();
    return ++serial_;
}

void PhotonWorker::cancel()
{
    std::lock_guard lock(mutex_);
    question_.reset();
    isForgotten_ = true;
    drawing_.request_stop();
    filling_.request_stop();
    wake_.notify_one();
}

void PhotonWorker::setHeld(bool held)
{
    std::lock_guard lock(mutex_);
    isHeld_ = held;
    if (held) {
        drawing_.request_stop();
        filling_.request_stop();
    }
    wake_.notify_one();
}

void PhotonWorker::work(const std::stop_token& quit)
{
    lowerPriority(kCompareNice);
    Workers workers; // its threads inherit the priority
    const FlushDenormals flush;
    Desk desk;
    const auto isBusy = [&] { return desk.question && (!desk.field || !desk.fine || !desk.fine->isWhole()); };
    while (true) {
        std::unique_lock lock(mutex_);
        const auto isTurn = [&] { return !isHeld_ && (isForgotten_ || question_ || isBusy()); };
        if (!wake_.wait(lock, quit, isTurn) || quit.stop_requested()) return;
        std::stop_source slice;
        drawing_ = slice;
        const std::stop_callback linked(quit, [&slice] { slice.request_stop(); });
        if (std::exchange(isForgotten_, false)) desk.question.reset();
        if (question_) {
            desk.question = std::exchange(question_, std::nullopt);
            desk.serial = serial_;
            desk.field.reset();
            desk.rough.reset();
            desk.fine.reset();
            if (fit(desk.cached, *desk.question->photons)) {
                desk.field = std::make_shared<PhotonMapField>(desk.question->photons->area(), desk.cached,
                                                              desk.question->photons->mix());
            }
        }
        lock.unlock();
        if (!isBusy()) continue;
        try {
            if (desk.field) {
                draw(desk, workers, slice.get_token());
            } else {
                fill(desk, workers, quit);
            }
        } catch (const std::bad_alloc&) {
            PhotonPicture none;
            none.serial = desk.serial;
            none.problem = tr("the picture needs more memory than there is; make the window smaller");
            desk = Desk();
            Q_EMIT shown(none);
        }
    }
}

void PhotonWorker::fill(Desk& desk, Workers& workers, const std::stop_token& quit)
{
    std::stop_source stop;
    const std::stop_callback linked(quit, [&stop] { stop.request_stop(); });
    {
        std::lock_guard lock(mutex_);
        if (question_ || isHeld_ || isForgotten_) return; // taken up before anything is begun
        filling_ = stop;
        fillingFor_ = mapsOf(*desk.question->photons);
    }
    BakeControl control(workers, {}, stop.get_token());
    std::mutex telling;
    auto told = std::chrono::steady_clock::now();
    const auto filled = withCaches(*desk.question->photons, control, [&](double part) {
        std::lock_guard lock(telling);
        if (std::chrono::steady_clock::now() - told < kTellEvery) return;
        told = std::chrono::steady_clock::now();
        Q_EMIT shown({nullptr, nullptr, part, desk.serial, {}});
    });
    {
        std::lock_guard lock(mutex_);
        fillingFor_.clear();
    }
    if (!filled) return;
    desk.cached = filled->layers();
    desk.field = filled;
}

void PhotonWorker::draw(Desk& desk, Workers& workers, const std::stop_token& stop)
{
    const PhotonQuestion& q = *desk.question;
    if (!desk.fine) {
        ViewJob small = q.job;
        small.width = std::max(1, small.width / kRoughly);
        small.height = std::max(1, small.height / kRoughly);
        desk.rough.emplace(q.rays, q.lights, desk.field->mix(), desk.field, small);
        desk.fine.emplace(q.rays, q.lights, desk.field->mix(), desk.field, q.job);
    }
    const bool isRough = desk.rough.has_value();
    ProgressiveView& making = isRough ? *desk.rough : *desk.fine;
    const double seconds = std::clamp(kGrows * making.seconds(), kFirstSlice, kLastSlice);
    View view = making.advance(seconds, workers, stop);
    if (view.samples == 0 || (stop.stop_requested() && !view.isWhole)) return; // part of a camera ray per pixel
    if (isRough) desk.rough.reset();
    Q_EMIT shown({std::make_shared<const View>(std::move(view)), desk.field, 1.0, desk.serial, {}});
}

} // namespace lightloom
