// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/picture_worker.h"
#include "widgets/background.h"
#include "widgets/seldom.h"

namespace lightloom {

namespace {

constexpr int kRoughly = 4;           ///< a rough picture of a photon map is smaller by this, each way
constexpr int kBlock = 2;             ///< side of blocks of pixels in rough pictures by lightcuts
constexpr int kSmaller[] = {1, 2, 4}; ///< these are smaller by, each way, the last one first: direct light is dear too
constexpr int kRoughShadows = 16;     ///< shadow rays per shining surface and pixel in these
/// Camera rays per pixel in these, and before any picture is shown: edges without steps. They are cheap, cuts are not.
constexpr int kRoughSamples = 8, kSmoothSamples = 4;
constexpr double kFirstRay = 0.9; ///< of the work until then, which is a cut for every pixel
constexpr double kFirstSlice = 0.2, kLastSlice = 1.5, kGrows = 0.2; ///< seconds; part of all before

/// Part of the work until the last picture by lightcuts is shown, after so many camera rays per pixel.
double partBefore(double rays)
{
    if (rays < 1.0) return kFirstRay * rays;
    return std::min(1.0, kFirstRay + (1.0 - kFirstRay) * (rays - 1.0) / (kSmoothSamples - 1));
}

std::vector<std::shared_ptr<const PhotonMap>> mapsOf(const PictureQuestion& question)
{
    std::vector<std::shared_ptr<const PhotonMap>> maps;
    if (!question.photons) return maps;
    for (const auto& layer : question.photons->layers()) maps.push_back(layer.map);
    return maps;
}

/// `layers` hold caches of the same photons, gathered alike.
bool fit(const std::vector<PhotonMapField::Layer>& layers, const PhotonMapField& field)
{
    return std::ranges::equal(layers, field.layers(),
                              [](const auto& a, const auto& b) { return a.map == b.map && a.kernel == b.kernel; });
}

} // namespace

PictureWorker::PictureWorker(QObject* parent)
    : QObject(parent), thread_([this](const std::stop_token& quit) { work(quit); })
{
}

PictureWorker::~PictureWorker()
{
    thread_.request_stop();
    thread_.join();
}

std::uint64_t PictureWorker::ask(PictureQuestion question)
{
    std::lock_guard lock(mutex_);
    drawing_.request_stop();
    if (mapsOf(question) != fillingFor_) filling_.request_stop(); // else what is filled will serve it
    question_ = std::move(question);
    isForgotten_ = false;
    wake_.notify_one();
    return ++serial_;
}

void PictureWorker::cancel()
{
    std::lock_guard lock(mutex_);
    question_.reset();
    isForgotten_ = true;
    drawing_.request_stop();
    filling_.request_stop();
    wake_.notify_one();
}

void PictureWorker::setHeld(bool held)
{
    std::lock_guard lock(mutex_);
    isHeld_ = held;
    if (held) {
        drawing_.request_stop();
        filling_.request_stop();
    }
    wake_.notify_one();
}

void PictureWorker::work(const std::stop_token& quit)
{
    lowerPriority(kCompareNice);
    Workers workers; // its threads inherit the priority
    const FlushDenormals flush;
    Desk desk;
    const auto isBusy = [&] { return desk.question && !desk.isDone(); };
    while (true) {
        std::unique_lock lock(mutex_);
        const auto isTurn = [&] { return !isHeld_ && (isForgotten_ || question_ || isBusy()); };
        if (!wake_.wait(lock, quit, isTurn) || quit.stop_requested()) return;
        std::stop_source slice;
        drawing_ = slice;
        const std::stop_callback linked(quit, [&slice] { slice.request_stop(); });
        if (std::exchange(isForgotten_, false)) desk.question.reset();
        if (question_) {
            desk.serial = serial_;
            takeUp(*std::exchange(question_, std::nullopt), desk);
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
            MadePicture none;
            none.serial = desk.serial;
            none.problem = tr("the picture needs more memory than there is; make the window smaller");
            desk = Desk();
            Q_EMIT shown(none);
        }
    }
}

void PictureWorker::takeUp(PictureQuestion question, Desk& desk)
{
    desk.question = std::move(question);
    desk.pictures.clear();
    const bool isSame =
        desk.question->voxels && desk.question->voxels == desk.voxels && desk.question->show == desk.show;
    if (isSame && desk.field) return; // another view of the same lights
    desk.field.reset();
    desk.voxels.reset();
    const auto& photons = desk.question->photons;
    if (!desk.question->voxels && fit(desk.cached, *photons))
        desk.field = std::make_shared<PhotonMapField>(photons->area(), desk.cached, photons->mix());
}

void PictureWorker::fill(Desk& desk, Workers& workers, const std::stop_token& quit)
{
    if (desk.question->voxels) {
        desk.field = std::make_shared<VoxelCuts>(desk.question->voxels, desk.question->lights, desk.question->show);
        desk.voxels = desk.question->voxels;
        desk.show = desk.question->show;
        return;
    }
    std::stop_source stop;
    const std::stop_callback linked(quit, [&stop] { stop.request_stop(); });
    {
        std::lock_guard lock(mutex_);
        if (question_ || isHeld_ || isForgotten_) return; // taken up before anything is begun
        filling_ = stop;
        fillingFor_ = mapsOf(*desk.question);
    }
    BakeControl control(workers, {}, stop.get_token());
    Seldom seldom;
    const auto filled = withCaches(*desk.question->photons, control, [&](double part) {
        if (seldom.isDue()) Q_EMIT shown({nullptr, nullptr, part, nullptr, 1, desk.serial, {}});
    });
    {
        std::lock_guard lock(mutex_);
        fillingFor_.clear();
    }
    if (!filled) return;
    desk.cached = filled->layers();
    desk.field = filled;
}

void PictureWorker::draw(Desk& desk, Workers& workers, const std::stop_token& stop)
{
    const PictureQuestion& q = *desk.question;
    if (desk.pictures.empty()) {
        const auto add = [&](ViewJob job) {
            const Mix& mix = q.voxels ? q.voxels->mix() : q.photons->mix();
            desk.pictures.emplace_back(q.rays, q.lights, mix, desk.field, std::move(job));
        };
        const auto addSmaller = [&](ViewJob job, int times) {
            job.width = std::max(1, job.width / times);
            job.height = std::max(1, job.height / times);
            add(std::move(job));
        };
        add(q.job);
        ViewJob rough = q.job;
        if (q.voxels) {
            rough.block = kBlock;
            rough.samples = kRoughSamples;
            rough.directSamples = kRoughShadows;
            for (const int times : kSmaller) addSmaller(rough, times);
        } else {
            addSmaller(rough, kRoughly);
        }
    }
    ProgressiveView& making = desk.pictures.back();
    const bool isLast = desk.pictures.size() == 1;
    const double seconds = std::clamp(kGrows * making.seconds(), kFirstSlice, kLastSlice);
    Seldom seldom;
    View view = making.advance(seconds, workers, stop, [&](double part) {
        if (isLast && q.voxels && seldom.isDue()) Q_EMIT workedOn(desk.serial, partBefore(part * q.job.samples));
    });
    if (view.samples == 0 || (stop.stop_requested() && !view.isWhole)) return; // part of a camera ray per pixel
    if (q.voxels && view.samples < std::min(kSmoothSamples, making.job().samples)) return; // edges would have steps
    // in pixels of the window
    const int block = making.job().block * (q.voxels ? std::max(1, q.job.width / making.job().width) : 1);
    // a photon map's whole picture is rougher than its small one for an instant only
    if (!isLast && (view.isWhole || !q.voxels)) desk.pictures.pop_back();
    const auto cuts = view.cutSizes.empty() ? nullptr : std::make_shared<const CutMap>(cutMap(view));
    Q_EMIT shown({std::make_shared<const View>(std::move(view)), desk.field, 1.0, cuts, block, desk.serial, {}});
}

} // namespace lightloom
