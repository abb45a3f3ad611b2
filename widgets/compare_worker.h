// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/compare/live_compare.h"
#include "widgets/bake_view.h"
#include <QObject>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace lightloom {

/// A reference picture as far as it has come. Never changed afterwards, cheap to copy.
struct ReferencePicture {
    std::shared_ptr<const View> view; ///< null: none
    ViewJob job;                      ///< that it answers; a rough picture is smaller
    std::uint64_t serial = 0;         ///< of its question
    double noise = -1.0;              ///< rms of the pixels' standard errors over the mean; negative: not known yet
    double seconds = 0.0;             ///< it took so far
    bool isRough = false;
    bool wasStored = false; ///< found on disk
};

/// How far a refinement of a bake is off the reference, as far as that has come.
struct ErrorPicture {
    std::shared_ptr<const ViewError> error; ///< null: not known, see `problem`
    QString problem;
    std::uint64_t serial = 0; ///< of the reference's question
    Snapshot snapshot;        ///< what was judged
    int block = 1;            ///< side of the squares of pixels that share its light so far
    bool isGivenUp = false;   ///< the question is dropped, and why stands in `problem`
};

/// One thread of low priority that traces the picture which bakes are held against, and judges them. While held (a bake
/// runs) it does nothing; a slice that runs is stopped within 100 ms, and what it had is gone on with.
class CompareWorker final : public QObject {
    Q_OBJECT
public:
    explicit CompareWorker(QObject* parent = nullptr);
    ~CompareWorker() override; ///< stops what runs

    /// The newest question wins; gives its serial.
    std::uint64_t ask(CompareQuestion question);
    void cancel(); ///< forgets the question
    /// Judges `view` from now on, by this kind of map.
    void judge(BakeView view, ErrorKind kind);
    void setHeld(bool held);

Q_SIGNALS:
    void shown(lightloom::ReferencePicture picture);
    void judged(lightloom::ErrorPicture picture);
    void judging(std::uint64_t serial, double part); ///< of the work until the next `judged`, 0 to 1

private:
    /// What the thread works on.
    struct Desk {
        std::optional<LiveCompare> live;
        std::uint64_t serial = 0;
        ViewJob job;
        Snapshot snapshot; ///< judged
        ErrorKind kind = ErrorKind::relative;
    };
    [[nodiscard]] bool hasNews() const { return isForgotten_ || question_ || candidate_; }
    void work(const std::stop_token& quit);
    void takeNews(Desk& desk, std::unique_lock<std::mutex>& lock);
    void workOn(Desk& desk, Workers& workers, const std::stop_token& stop);
    void giveUp(Desk& desk);
    void tellReference(const Desk& desk);
    void tellError(const Desk& desk);

    struct Candidate {
        Snapshot snapshot;
        ErrorKind kind = ErrorKind::relative;
    };
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::stop_source running_; ///< of the slice that runs
    std::optional<CompareQuestion> question_;
    std::optional<Candidate> candidate_;
    std::uint64_t serial_ = 0;
    bool isForgotten_ = false, isHeld_ = false;
    std::jthread thread_; // last: it uses all of the above
};

} // namespace lightloom

Q_DECLARE_METATYPE(lightloom::ReferencePicture)
Q_DECLARE_METATYPE(lightloom::ErrorPicture)
