// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/compare_worker.h"
#include "widgets/background.h"
#include "widgets/seldom.h"

namespace lightloom {

CompareWorker::CompareWorker(QObject* parent)
    : QObject(parent), thread_([this](const std::stop_token& quit) { work(quit); })
{
}

CompareWorker::~CompareWorker()
{
    thread_.request_stop();
    thread_.join();
}

std::uint64_t CompareWorker::ask(CompareQuestion question)
{
    std::lock_guard lock(mutex_);
    question_ = std::move(question);
    isForgotten_ = false;
    running_.request_stop();
    wake_.notify_one();
    return ++serial_;
}

void CompareWorker::cancel()
{
    std::lock_guard lock(mutex_);
    question_.reset();
    isForgotten_ = true;
    running_.request_stop();
    wake_.notify_one();
}

void CompareWorker::judge(BakeView view, ErrorKind kind)
{
    std::lock_guard lock(mutex_);
    candidate_ = Candidate{std::move(view.snapshot), kind};
    running_.request_stop();
    wake_.notify_one();
}

void CompareWorker::setHeld(bool held)
{
    std::lock_guard lock(mutex_);
    isHeld_ = held;
    if (held) running_.request_stop();
    wake_.notify_one();
}

void CompareWorker::work(const std::stop_token& quit)
{
    lowerPriority(kCompareNice);
    Workers workers; // its threads inherit the priority
    const FlushDenormals flush;
    Desk desk;
    const auto isBusy = [&] { return desk.live && (desk.live->wantsField() || !desk.live->isWhole()); };
    while (true) {
        std::unique_lock lock(mutex_);
        const auto isTurn = [&] { return !isHeld_ && (hasNews() || isBusy()); };
        const bool isQuit = !wake_.wait(lock, quit, isTurn) || quit.stop_requested();
        try {
            if (isQuit) {
                lock.unlock();
                if (desk.live) desk.live->keepPart();
                return;
            }
            std::stop_source slice;
            running_ = slice;
            const std::stop_callback linked(quit, [&slice] { slice.request_stop(); });
            takeNews(desk, lock); // leaves it unlocked
            if (isBusy()) workOn(desk, workers, slice.get_token());
        } catch (const std::bad_alloc&) {
            if (isQuit) return;
            giveUp(desk);
        }
    }
}

void CompareWorker::giveUp(Desk& desk)
{
    desk.live.reset();
    ErrorPicture none;
    none.serial = desk.serial;
    none.isGivenUp = true;
    none.problem = tr("The reference picture needs more memory than there is; make the window smaller");
    Q_EMIT judged(none);
}

/// Gives up the lock before anything that takes time.
void CompareWorker::takeNews(Desk& desk, std::unique_lock<std::mutex>& lock)
{
    std::optional<CompareQuestion> question = std::exchange(question_, std::nullopt);
    std::optional<Candidate> candidate = std::exchange(candidate_, std::nullopt);
    const bool isForgotten = std::exchange(isForgotten_, false);
    const std::uint64_t serial = serial_;
    lock.unlock();
    if (candidate) {
        const bool isOther = desk.snapshot.field != candidate->snapshot.field;
        desk.snapshot = std::move(candidate->snapshot);
        desk.kind = candidate->kind;
        if (desk.live && isOther) desk.live->setField(desk.snapshot.field);
    }
    if (desk.live && (isForgotten || question)) desk.live->keepPart();
    if (isForgotten) desk.live.reset();
    if (question) {
        desk.serial = serial;
        desk.job = question->job;
        desk.live.emplace(std::move(*question));
        desk.live->setField(desk.snapshot.field);
        if (desk.live->reference()) tellReference(desk);
    } else if (candidate && desk.live) {
        tellError(desk); // another kind of map of what there is
    }
}

void CompareWorker::workOn(Desk& desk, Workers& workers, const std::stop_token& stop)
{
    LiveCompare& live = *desk.live;
    if (live.wantsField()) {
        Seldom seldom;
        const auto told = [&](double part) {
            if (seldom.isDue()) Q_EMIT judging(desk.serial, part);
        };
        if (live.advanceField(workers, stop, told)) tellError(desk);
        return;
    }
    if (!live.advanceReference(workers, stop)) return;
    tellReference(desk);
    tellError(desk);
}

void CompareWorker::tellReference(const Desk& desk)
{
    const LiveCompare& live = *desk.live;
    ReferencePicture picture{live.reference(), desk.job, desk.serial};
    picture.seconds = live.seconds();
    picture.isRough = live.isRough();
    picture.wasStored = live.wasStored();
    const double noise = pictureNoise(*picture.view);
    if (noise > 0.0) picture.noise = noise;
    Q_EMIT shown(picture);
}

void CompareWorker::tellError(const Desk& desk)
{
    const auto error = desk.live->error(desk.kind);
    if (!error) return;
    ErrorPicture picture;
    picture.serial = desk.serial;
    picture.snapshot = desk.snapshot;
    picture.block = desk.live->block();
    if (*error) {
        picture.error = std::make_shared<const ViewError>(**error);
    } else {
        picture.problem = QString::fromStdString(error->error().message);
    }
    Q_EMIT judged(picture);
}

} // namespace lightloom
