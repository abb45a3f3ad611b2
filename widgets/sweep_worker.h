// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/compare/sweep.h"
#include <QObject>
#include <QString>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace lightloom {

/// A sweep and what judges it.
struct SweepOrder {
    SweepPlan plan;
    QString sceneFile; ///< beside which the judge is kept
    std::uint64_t points = kJudgePoints;
    float noise = 0.02f; ///< of the judge, at each point, as a fraction of the mean
    std::uint64_t serial = 0;
};

/// How far a sweep has come.
struct SweepProgress {
    bool isJudge = false;         ///< the reference is being traced; else rows are made
    double fraction = 0;          ///< of that
    double remainingSeconds = -1; ///< negative: not known
    std::uint64_t serial = 0;
};

/// One thread of lowest priority that runs a sweep at a time. Rows share photons and the like with each other, not with
/// the window's own bakes. While held (a bake runs) it waits.
class SweepWorker final : public QObject {
    Q_OBJECT
public:
    explicit SweepWorker(QObject* parent = nullptr);
    ~SweepWorker() override; ///< stops what runs

    std::uint64_t start(SweepOrder order); ///< in place of a running one; gives its serial
    void cancel();                         ///< rows that were told stay good
    void setHeld(bool held);

Q_SIGNALS:
    void progressed(lightloom::SweepProgress progress);
    void rowDone(quint64 serial, lightloom::SweepRow row);
    /// `error` empty: done, or cancelled (then `isCancelled`).
    void finished(quint64 serial, QString error, bool isCancelled);

private:
    void work(const std::stop_token& quit);
    Result<Done> run(const SweepOrder& order, BakeProducts& products, Workers& workers, const std::stop_token& stop);
    Result<Judge> judge(const SweepOrder& order, const SceneProducts& at, Workers& workers,
                        const std::stop_token& stop);
    /// False: stopped meanwhile.
    bool waitWhileHeld(const std::stop_token& stop);

    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::optional<SweepOrder> order_;
    std::stop_source running_, tracing_; ///< the sweep, a stretch of its judge
    BakeControl* control_ = nullptr;     ///< of the bakes that run
    std::uint64_t serial_ = 0;
    bool isHeld_ = false;
    std::jthread thread_; // last: it uses all of the above
};

} // namespace lightloom

Q_DECLARE_METATYPE(lightloom::SweepProgress)
Q_DECLARE_METATYPE(lightloom::SweepRow)
