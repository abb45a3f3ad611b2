// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/bake/bake_session.h"
#include "widgets/bake_view.h"
#include <QObject>
#include <map>
#include <memory>
#include <mutex>

namespace lightloom {

/// The bake worker as Qt sees it: callbacks become queued signals with immutable data. All that a picture needs (mix,
/// texture layout) is made on the worker. Bake threads run at low priority, so that the picture stays smooth.
class BakeBridge final : public QObject {
    Q_OBJECT
public:
    explicit BakeBridge(QObject* parent = nullptr);
    ~BakeBridge() override; ///< stops what runs, paused or not

    /// Returns at once with the job's serial. `urgent`: do not wait for the running bake's coarse picture.
    std::uint64_t start(Method method, BakeJob job, bool urgent);
    void cancel();
    void setPaused(bool paused);
    [[nodiscard]] bool isPaused() const { return session_->isPaused(); }
    /// How what is published from now on is looked at.
    void setLook(Look look);

Q_SIGNALS:
    void shown(lightloom::BakeView view);
    void progressed(lightloom::Progress progress);
    /// `error` empty: done, or cancelled (then `isCancelled`).
    void finished(quint64 serial, QString error, bool isCancelled, lightloom::WorkCounters counters);

private:
    class Solvers;
    void publish(Snapshot snapshot);
    [[nodiscard]] Method methodOf(std::uint64_t serial); ///< of a job that is baked now: older ones are forgotten

    std::mutex mutex_;
    Look look_;
    std::map<std::uint64_t, Method> methods_; ///< of jobs, by serial
    BakeJob job_;                             ///< the newest
    std::uint64_t serial_ = 0;                ///< its
    std::unique_ptr<Workers> workers_;
    std::unique_ptr<BakeSession> session_;
};

} // namespace lightloom

Q_DECLARE_METATYPE(lightloom::Progress)
Q_DECLARE_METATYPE(lightloom::WorkCounters)
