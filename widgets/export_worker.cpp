// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/export_worker.h"
#include "widgets/background.h"
#include <QElapsedTimer>
#include <QFile>

namespace lightloom {

namespace {

constexpr int kTellMs = 50;

QString lineAbout(const ExportReport& report)
{
    if (!report.atlas) return {};
    const AtlasReport& atlas = report.atlas->report;
    return ExportWorker::tr("%1 x %1 texels, %2 per metre, %3 charts, %4 % used, mean stretch %5")
        .arg(report.atlas->size)
        .arg(atlas.texelsPerMetre, 0, 'g', 3)
        .arg(atlas.charts)
        .arg(100.0 * atlas.utilisation, 0, 'f', 0)
        .arg(atlas.stretch.meanAnisotropy(), 0, 'f', 2);
}

} // namespace

ExportWorker::ExportWorker(QObject* parent)
    : QObject(parent), thread_([this](const std::stop_token& quit) { work(quit); })
{
}

ExportWorker::~ExportWorker()
{
    thread_.request_stop();
    thread_.join();
}

void ExportWorker::start(ExportOrder order)
{
    std::lock_guard lock(mutex_);
    order_ = std::move(order);
    running_.request_stop();
    wake_.notify_one();
}

void ExportWorker::cancel()
{
    std::lock_guard lock(mutex_);
    const bool isWaiting = order_.has_value(); // nobody took it yet, so nobody else tells
    order_.reset();
    running_.request_stop();
    if (isWaiting) Q_EMIT finished({}, {}, {}, true);
}

void ExportWorker::work(const std::stop_token& quit)
{
    lowerPriority(kCompareNice);
    Workers workers; // its threads inherit the priority
    const FlushDenormals flush;
    while (true) {
        std::unique_lock lock(mutex_);
        if (!wake_.wait(lock, quit, [this] { return order_.has_value(); }) || quit.stop_requested()) return;
        ExportOrder order = std::move(*order_);
        order_.reset();
        std::stop_source run;
        running_ = run;
        lock.unlock();
        const std::stop_callback linked(quit, [&run] { run.request_stop(); });
        this->run(order, workers, run.get_token());
        if (quit.stop_requested()) return;
    }
}

void ExportWorker::run(ExportOrder& order, Workers& workers, const std::stop_token& stop)
{
    std::mutex telling;
    QElapsedTimer told;
    const auto tell = [&](double fraction) {
        const std::lock_guard lock(telling);
        if (fraction < 1.0 && told.isValid() && told.elapsed() < kTellMs) return;
        told.start();
        Q_EMIT progressed(fraction);
    };
    order.info.isa = std::string(order.view.rays->isaName());
    order.info.sceneHash = sceneHash(order.view.rays->scene());
    const ExportSource source{*order.view.rays,           *order.view.lights, nullptr,
                              *order.view.snapshot.field, order.info,         order.mix};
    const Result<ExportReport> report = exportBake(source, order.request, workers, stop, tell);
    if (!report) {
        const bool isCancelled = report.error().kind == Error::Kind::cancelled;
        Q_EMIT finished({}, {}, isCancelled ? QString() : QString::fromStdString(report.error().message), isCancelled);
        return;
    }
    QStringList files;
    for (const auto& file : report->files) files += QFile::decodeName(file.string().c_str());
    Q_EMIT finished(files, lineAbout(*report), {}, false);
}

} // namespace lightloom
