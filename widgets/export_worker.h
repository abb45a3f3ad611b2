// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/bake/export_bake.h"
#include "widgets/bake_view.h"
#include <QObject>
#include <QStringList>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace lightloom {

/// What is to be exported: the light that a view shows, under its mix.
struct ExportOrder {
    BakeView view; ///< with rays and lights
    Mix mix;       ///< of its field
    BakeInfo info; ///< of the bake the view is of; ISA and scene hash are filled in here
    ExportRequest request;
};

/// One thread that writes a bake for other programs, one order at a time, behind everything else.
class ExportWorker final : public QObject {
    Q_OBJECT
public:
    explicit ExportWorker(QObject* parent = nullptr);
    ~ExportWorker() override; ///< stops what runs

    /// Returns at once. A running export is stopped first.
    void start(ExportOrder order);
    void cancel();

Q_SIGNALS:
    void progressed(double fraction); ///< 0 to 1, at most 20 times a second
    /// `problem` empty: done, or cancelled (then no file was written). `report`: one line about the atlas.
    void finished(QStringList files, QString report, QString problem, bool isCancelled);

private:
    void work(const std::stop_token& quit);
    void run(ExportOrder& order, Workers& workers, const std::stop_token& stop);

    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::optional<ExportOrder> order_;
    std::stop_source running_;
    std::jthread thread_; // last: it uses all of the above
};

} // namespace lightloom
