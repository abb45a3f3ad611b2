// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/main_window.h"
#include "core/ivg/ivg_solver.h"
#include "core/octree/octree_solver.h"
#include "core/params/param_text.h"
#include "core/voxel/voxel_solver.h"
#include "widgets/atlas_desk.h"
#include "widgets/bake_bridge.h"
#include "widgets/bake_panel.h"
#include "widgets/compare_desk.h"
#include "widgets/edit_command.h"
#include "widgets/export_dialog.h"
#include "widgets/guest_desk.h"
#include "widgets/message_bar.h"
#include "widgets/param_panel.h"
#include "widgets/pick_desk.h"
#include "widgets/picture_desk.h"
#include "widgets/scene_dock.h"
#include "widgets/scene_loader.h"
#include "widgets/snapshot_bar.h"
#include "widgets/start_page.h"
#include "widgets/sweep_panel.h"
#include "widgets/view_worker.h"
#include "widgets/viewport.h"
#include "widgets/voxel_panel.h"
#include <QAction>
#include <QCloseEvent>
#include <QCoreApplication>
#include <QDir>
#include <QDoubleSpinBox>
#include <QDragEnterEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QLabel>
#include <QLocale>
#include <QMenu>
#include <QMimeData>
#include <QSettings>
#include <QStackedWidget>
#include <QUndoStack>
#include <QUrl>
#include <fmt/format.h>

namespace lightloom {

namespace {

constexpr int kEditDelayMs = 150; ///< edits within it make one bake
constexpr int kFrameTellMs = 250; ///< between changes of the frame time in the status line

QString sceneIn(const QMimeData* mime)
{
    for (const QUrl& url : mime->urls()) {
        const QString file = url.toLocalFile();
        if (file.endsWith(QStringLiteral(".glb"), Qt::CaseInsensitive) ||
            file.endsWith(QStringLiteral(".gltf"), Qt::CaseInsensitive)) {
            return file;
        }
    }
    return {};
}

constexpr int kParamEdits = 1'000'000; ///< numbers of undo steps that may be joined: lamps first, then parameters

/// An edit may be undone under another method.
struct MethodParams {
    BakeParams params;
    Method method;
    bool operator==(const MethodParams&) const = default;
};

QString fromView(std::string_view s) { return QString::fromUtf8(s.data(), static_cast<qsizetype>(s.size())); }

/// What the snapshot was made with; a coarse one may be shown.
BakeParams bakedParams(const BakeView& view)
{
    if (view.snapshot.isFinal || view.isGrid()) return view.params;
    if (view.isVoxels()) return roughVoxelParams(view.params);
    BakeParams params = view.snapshot.isRough ? roughParams(view.params) : view.params;
    params.octreeDepth = view.snapshot.level;
    params.octreeDetail = 0; // these leaves come last
    return params;
}

/// In what way the snapshot is less than the bake that was asked for.
std::string missingIn(const BakeView& view)
{
    if (view.snapshot.isFinal) return {};
    if (view.isGrid()) return "fewer photons than asked for; the bake was not finished";
    const BakeParams baked = bakedParams(view);
    if (view.isVoxels()) {
        return fmt::format("{} voxels along a side of {}; the bake was not finished", view.snapshot.level,
                           view.params.voxelSize);
    }
    std::string text = fmt::format("depth {} of {}", view.snapshot.level, view.params.octreeDepth);
    if (view.params.octreeDetail > 0) text += ", no deeper leaves";
    if (!view.snapshot.isRough) return text + "; the bake was not finished";
    return fmt::format("rough: {} photons per lamp (lamps that were kept have more), K = {}, {}; the bake was not "
                       "finished",
                       baked.photonCount, baked.gatherCount, text);
}

QString luxText(double lux)
{
    if (lux < 0.0) return QStringLiteral("?");
    return QLocale().toString(lux, 'f', lux < 10.0 ? 2 : lux < 100.0 ? 1 : 0);
}

} // namespace

MainWindow::MainWindow(QSettings* settings)
    : settings_(settings), undoStack_(new QUndoStack(this)), loader_(new SceneLoader(this)),
      bridge_(new BakeBridge(this)), worker_(new ViewWorker(this))
{
    setWindowTitle(tr("Lightloom"));
    setAcceptDrops(true);
    makeActions();
    buildCentre();
    buildDocks();
    buildStatus();
    buildMenus();
    exportDialog_ = new ExportDialog(this, [this] { return exportOrder(); });
    connectWorkers();
    connectCompare();
    connectLamps();
    connectGuests();
    editDelay_.setSingleShot(true);
    editDelay_.setInterval(kEditDelayMs);
    connect(&editDelay_, &QTimer::timeout, this, &MainWindow::useParams);
    frameTold_.setSingleShot(true);
    frameTold_.setInterval(kFrameTellMs);
    restore();
}

MainWindow::~MainWindow()
{
    // workers first: what they still send finds no window then
    savePool_.waitForDone();
    delete exportDialog_;
    delete compareDesk_;
    delete pictureDesk_;
    delete atlasDesk_;
    delete guestDesk_;
    delete bridge_;
    delete worker_;
    delete loader_;
}

bool MainWindow::isPaused() const { return bridge_->isPaused(); }

void MainWindow::connectWorkers()
{
    connect(loader_, &SceneLoader::loaded, this, &MainWindow::sceneRead);
    connect(loader_, &SceneLoader::failed, this, [this](const QString& message) {
        messages_->show(message, tr("Open another..."), [this] { chooseFile(); });
        statusStage_->clear();
        Q_EMIT openFailed();
    });
    connect(bridge_, &BakeBridge::shown, this, &MainWindow::takeView, Qt::QueuedConnection);
    connect(
        bridge_, &BakeBridge::progressed, this,
        [this](const Progress& progress) {
            if (progress.serial != jobSerial_ || !isBaking_) return;
            // each change of a label composes the whole window again: 30 ms of work where the processor draws
            const int wait = viewport_ != nullptr ? viewport_->pacer().tellMs() : FramePacer::kQuickTellMs;
            if (progress.fraction < 1.0 && toldClock_.isValid() && toldClock_.elapsed() < wait) return;
            toldClock_.start();
            bakePanel_->show(progress);
            statusStage_->setText(bakePanel_->stageText());
        },
        Qt::QueuedConnection);
    connect(bridge_, &BakeBridge::finished, this, &MainWindow::bakeFinished, Qt::QueuedConnection);
    connect(
        worker_, &ViewWorker::looked, this,
        [this](const BakeView& view) {
            snapshots_->replaceShown(view);
            if (snapshots_->shown() != nullptr) showView(*snapshots_->shown());
        },
        Qt::QueuedConnection);
    connect(worker_, &ViewWorker::measured, this, &MainWindow::showMeasurement, Qt::QueuedConnection);
    connect(sceneDock_, &SceneDock::lampEdited, this, &MainWindow::lampEdited);
    connect(sceneDock_, &SceneDock::cameraChosen, this, [this](int index) {
        if (viewport_ != nullptr) viewport_->useCamera(data_->scene->cameras[static_cast<std::size_t>(index)]);
    });
    connect(snapshots_, &SnapshotBar::chosen, this, [this] { showView(*snapshots_->shown()); });
    connect(paramPanel_, &ParamPanel::edited, this, &MainWindow::paramsEdited);
    if (viewport_ == nullptr) return;
    // a label that changes composes the window anew: not with every frame
    connect(viewport_, &Viewport::frameDrawn, &frameTold_, [this] {
        if (!frameTold_.isActive()) frameTold_.start();
    });
    connect(&frameTold_, &QTimer::timeout, this, &MainWindow::showFrame);
    const auto tellDirect = [this](const QString& text) {
        if (statusDirect_->text() != text) statusDirect_->setText(text);
    };
    const auto tellOf = [this, tellDirect](const QString& text) {
        tellDirect(viewport_->showsMade() ? tr("direct: traced") : text);
    };
    connect(viewport_, &Viewport::viewMoved, this, [tellDirect] { tellDirect(tr("direct: preview")); });
    connect(viewport_, &Viewport::settled, this, [tellOf] { tellOf(tr("direct: preview")); });
    connect(viewport_, &Viewport::refined, this, [tellOf] { tellOf(tr("direct: refined")); });
    connect(viewport_, &Viewport::problem, this, [this](const QString& text) { messages_->show(text); });
    connect(viewport_, &Viewport::exposureMetered, this, [this](float ev) {
        const QSignalBlocker quiet(exposure_);
        exposure_->setValue(static_cast<double>(ev));
    });
    connect(viewport_, &Viewport::hovered, this, [this](bool isOnSurface, glm::vec3 p, glm::vec3 n) {
        cursor_.reset();
        if (isOnSurface) cursor_ = Place{p, n};
        measure();
    });
}

void MainWindow::openScene(const QString& file)
{
    if (!mayDropEdits()) return;
    givenUp_ = data_ ? data_->scene->lights : std::vector<PunctualLight>();
    statusStage_->setText(tr("Reading %1").arg(QFileInfo(file).fileName()));
    loader_->open(file);
}

void MainWindow::sceneRead(const std::shared_ptr<const DrawData>& opened, const QString& file)
{
    if (mayDropLaterEdits()) {
        setScene(opened, file);
    } else {
        statusStage_->setText(tr("%1 was not opened").arg(QFileInfo(file).fileName()));
    }
}

void MainWindow::setScene(std::shared_ptr<const DrawData> opened, const QString& file)
{
    const bool isFirst = !data_, isAgain = file == file_;
    data_ = std::move(opened);
    file_ = file;
    const Scene& scene = *data_->scene;
    setWindowTitle(tr("%1[*] - Lightloom").arg(sceneTitle(file)));
    snapshots_->clear();
    bakePanel_->clear();
    export_->setEnabled(false);
    rowSerial_.reset();
    cursor_.reset();
    sceneDock_->setScene(data_->scene);
    look_.mix = sceneDock_->mix();
    lamps_ = sceneDock_->lampSettings();
    params_ = paramPanel_->params();
    undoStack_->clear();
    ++look_.serial;
    bridge_->setLook(look_);
    cameraMenu_->clear();
    for (const Camera& camera : scene.cameras) {
        cameraMenu_->addAction(QString::fromStdString(camera.name), this, [this, camera] {
            if (viewport_ != nullptr) viewport_->useCamera(camera);
        });
    }
    cameraMenu_->setEnabled(!scene.cameras.empty());
    pages_->setCurrentWidget(workPage_);
    if (isFirst) showDocks();
    for (QAction* action : {start_, reload_, saveScene_}) action->setEnabled(true);
    if (viewport_ != nullptr) {
        viewport_->setScene(data_, isAgain);
        viewport_->setFocus();
        if (scene.exposureEv && !isAgain) {
            const QSignalBlocker quiet(exposure_);
            exposure_->setValue(static_cast<double>(*scene.exposureEv));
        }
    }
    sweepPanel_->setScene(data_->scene, file);
    voxelPanel_->setView({});
    if (compareDesk_ != nullptr) {
        pictureDesk_->forget();
        atlasDesk_->forget();
        pickDesk_->forget();
        guestDesk_->sceneChanged(scene.bounds);
        compareDesk_->setScene(file);
        compareDesk_->setMix(look_.mix);
    }
    forgetLampEdits();
    showNotes();
    rememberFile(file);
    sceneSerial_ = jobSerial_ + 1;
    startBake(true);
    Q_EMIT sceneOpened();
}

void MainWindow::showNotes()
{
    QStringList notes;
    if (!data_->lampMessage.empty()) notes += QString::fromStdString(data_->lampMessage);
    for (const std::string& warning : data_->scene->warnings) notes += QString::fromStdString(warning);
    if (notes.isEmpty()) {
        messages_->clear();
    } else {
        const auto more = notes.size() - 1;
        messages_->show(more > 0 ? tr("%1 (and %n more note(s))", nullptr, static_cast<int>(more)).arg(notes.first())
                                 : notes.first());
        messages_->setToolTip(notes.join('\n'));
    }
}

void MainWindow::startBake(bool urgent)
{
    editDelay_.stop();
    if (!data_) return;
    const Result<Done> fits = checkTogether(paramPanel_->params());
    if (!fits) {
        messages_->show(QString::fromStdString(fits.error().message), tr("Reset parameters"),
                        [this] { setParams(defaultParams(method_)); });
        return;
    }
    BakeJob job;
    job.scene = data_->scene;
    job.params = paramPanel_->params();
    sweepPanel_->setBase(job.params);
    // lamps that are on are baked at full: dimming is the mix's; lamps that are off cost nothing
    for (const glm::vec3& gain : look_.mix) job.mix.emplace_back(gain == glm::vec3(0.0f) ? 0.0f : 1.0f);
    job.roughFirst = true;
    bakedMix_ = job.mix;
    bakedParams_ = job.params;
    jobSerial_ = bridge_->start(method_, std::move(job), urgent);
    isBaking_ = true;
    bakePanel_->begin();
    tellBusy();
    pause_->setEnabled(true);
    cancel_->setEnabled(true);
}

void MainWindow::tellBusy()
{
    const bool isBusy = isBaking_ && !bridge_->isPaused();
    if (viewport_ != nullptr) viewport_->setBusy(isBusy);
    if (compareDesk_ != nullptr) compareDesk_->setBaking(isBusy);
    if (pictureDesk_ != nullptr) pictureDesk_->setBaking(isBusy);
    const bool isTracing = compareDesk_ != nullptr && compareDesk_->isTracing();
    sweepPanel_->holdFor(isBusy      ? tr("Waits for the bake")
                         : isTracing ? tr("Waits for the reference; R stops it")
                                     : QString());
}

void MainWindow::setParams(const BakeParams& params)
{
    paramPanel_->setParams(params);
    paramsEdited(params);
    useParams();
}

void MainWindow::paramsEdited(const BakeParams& params)
{
    if (params == params_) return;
    int changed = 0, last = -1;
    for (std::size_t i = 0; i < kParams.size(); ++i) {
        if (paramValue(params, kParams[i]) == paramValue(params_, kParams[i])) continue;
        ++changed;
        last = static_cast<int>(i);
    }
    const QString what = changed == 1 ? fromView(kParams[static_cast<std::size_t>(last)].label) : tr("parameters");
    const auto apply = [this](const MethodParams& value) {
        params_ = paramsFor(value.params, value.method, method_);
        paramPanel_->setParams(params_);
        editDelay_.start();
    };
    undoStack_->push(new EditCommand<MethodParams>(what, {params_, method_}, {params, method_}, apply,
                                                   changed == 1 ? kParamEdits + last : -1));
    params_ = params;
    editDelay_.start();
}

void MainWindow::useParams()
{
    const BakeParams& params = paramPanel_->params();
    const GridShow show = gridShow(params);
    if (!(show == look_.grid)) {
        look_.grid = show;
        if (show.remap != GridRemap::paper) look_.packing = GridPacking::exact;
        showGridLook();
        lookChanged();
    }
    useVoxelShow();
    const auto stage = firstDifference(bakedParams_, params, method_);
    if (stage && *stage != Stage::show) startBake(false);
}

void MainWindow::lampEdited(int lamp, bool isDimmed)
{
    const std::vector<LampSetting> settings = sceneDock_->lampSettings();
    const auto apply = [this](const std::vector<LampSetting>& value) {
        lamps_ = value;
        sceneDock_->setLampSettings(value);
        useMix();
    };
    const QString name = sceneDock_->lampName(lamp);
    undoStack_->push(
        new EditCommand<std::vector<LampSetting>>(isDimmed ? tr("dimming %1").arg(name) : tr("switching %1").arg(name),
                                                  lamps_, settings, apply, isDimmed ? lamp : -1));
    lamps_ = settings;
    useMix();
}

void MainWindow::useMix()
{
    look_.mix = sceneDock_->mix();
    if (viewport_ != nullptr) viewport_->setMix(look_.mix);
    if (compareDesk_ != nullptr) compareDesk_->setMix(look_.mix);
    lookChanged();
    for (std::size_t g = 0; g < look_.mix.size(); ++g) {
        const bool wasLeftOut = isOff(bakedMix_, static_cast<int>(g)), isOn = look_.mix[g] != glm::vec3(0.0f);
        if (wasLeftOut && isOn) {
            startBake(false); // it has no layer yet; the other lamps' photons are kept
            break;
        }
    }
}

void MainWindow::lookChanged()
{
    ++look_.serial;
    bridge_->setLook(look_);
    if (snapshots_->shown() != nullptr) worker_->look(*snapshots_->shown(), look_);
}

void MainWindow::takeView(const BakeView& view)
{
    if (view.snapshot.serial < sceneSerial_) return;                                          // of the scene before
    if (view.snapshot.serial < jobSerial_ && rowSerial_ && *rowSerial_ == jobSerial_) return; // overtaken
    if (rowSerial_ != view.snapshot.serial) {
        snapshots_->clear();
        bakePanel_->forgetDepths(); // an overtaken bake's picture may have come since this one began
        rowSerial_ = view.snapshot.serial;
    }
    snapshots_->add(view);
    export_->setEnabled(true);
    bakePanel_->add(view);
    showView(*snapshots_->shown());
    Q_EMIT lightShown(view.snapshot.isFinal);
}

void MainWindow::showView(const BakeView& view)
{
    if (!view.problem.isEmpty()) messages_->show(view.problem);
    if (view.lookSerial != look_.serial) worker_->look(view, look_);
    if (viewport_ != nullptr) viewport_->setLight(view);
    judgeView();
    bakePanel_->showNoise(view);
    exportDialog_->lightChanged();
    statusNoise_->setText(view.noise ? tr("noise %1 %").arg(100.0 * *view.noise, 0, 'f', 1) : QString());
    const double bytes = static_cast<double>(view.textureBytes());
    const QString size =
        bytes < 1e6 ? tr("%1 kB").arg(bytes / 1e3, 0, 'f', 0) : tr("%1 MB").arg(bytes / 1e6, 0, 'f', 1);
    const QString all = tr("%1 in textures, %2 MB with all lamps' layers")
                            .arg(size)
                            .arg(static_cast<double>(view.snapshot.field->memoryBytes()) / 1e6, 0, 'f', 1);
    const auto number = [](std::size_t n) { return QLocale().toString(static_cast<qulonglong>(n)); };
    if (view.isGrid()) {
        std::size_t open = view.gpuGrid ? view.gpuGrid->openVertices : 0;
        if (open > 0 && view.gpuGrid->inside) open += view.gpuGrid->inside->openVertices;
        statusSize_->setText(tr("%1  %2").arg(gridSizeText(view.snapshot, GridText::brief), size));
        statusSize_->setToolTip(tr("Irradiance grid as shown: %1; %2 vertices know light, %3")
                                    .arg(gridSizeText(view.snapshot), number(open), all));
    } else if (view.isVoxels()) {
        statusSize_->setText(tr("%1 voxels  %2").arg(number(view.leaves), size));
        statusSize_->setToolTip(tr("Voxels as shown: %1 entries, %2").arg(number(view.entries), all));
    } else {
        statusSize_->setText(tr("d%1  %2 leaves  %3").arg(view.snapshot.level).arg(number(view.leaves), size));
        statusSize_->setToolTip(tr("Light octree as shown: %1 entries, %2").arg(number(view.entries), all));
    }
}

void MainWindow::bakeFinished(quint64 serial, const QString& error, bool isCancelled, const WorkCounters& counters)
{
    if (serial != jobSerial_) return;
    isBaking_ = false;
    tellBusy();
    pause_->setEnabled(false);
    cancel_->setEnabled(false);
    const QString outcome = !error.isEmpty() ? tr("Failed") : isCancelled ? tr("Cancelled") : tr("Done");
    if (!error.isEmpty()) messages_->show(error, tr("Reset parameters"), [this] { setParams(defaultParams(method_)); });
    bakePanel_->end(outcome, counters);
    statusStage_->setText(outcome);
    Q_EMIT bakeEnded(error.isEmpty() && !isCancelled);
}

void MainWindow::showMeasurement(const Measurement& m)
{
    if (!m.isOnSurface) {
        statusLux_->setText(tr("- lx"));
        return;
    }
    const bool isKnown = m.directLux >= 0.0 && m.indirectLux >= 0.0;
    statusLux_->setText(isKnown ? tr("%1 lx at cursor").arg(luxText(m.directLux + m.indirectLux))
                                : tr("%1 lx indirect at cursor").arg(luxText(m.indirectLux)));
    statusLux_->setToolTip(
        tr("Illuminance: %1 lx direct, %2 lx indirect").arg(luxText(m.directLux), luxText(m.indirectLux)));
}

void MainWindow::showFrame()
{
    const double ms = viewport_->frameMs();
    statusFrame_->setText(
        tr("%1 ms%2").arg(ms, 0, 'f', ms < 10.0 ? 1 : 0).arg(viewport_->scale() < 1.0f ? tr(" coarse") : QString()));
}

void MainWindow::chooseFile()
{
    const QString folder = settings_ != nullptr ? settings_->value("folder").toString() : QString();
    auto* dialog = new QFileDialog(this, tr("Open a scene"), folder, tr("glTF scenes (*.glb *.gltf);;All files (*)"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setFileMode(QFileDialog::ExistingFile);
    connect(dialog, &QFileDialog::fileSelected, this, &MainWindow::openScene);
    dialog->open();
}

void MainWindow::showExport()
{
    const QFileInfo scene(file_);
    exportDialog_->setName(scene.dir().filePath(scene.completeBaseName() + "-light"));
    exportDialog_->show();
    exportDialog_->raise();
    exportDialog_->activateWindow();
}

std::optional<ExportOrder> MainWindow::exportOrder() const
{
    const BakeView* view = snapshots_->shown();
    if (view == nullptr || !view->rays || view->lookSerial != look_.serial) return {};
    ExportOrder order{*view, look_.mix, {}, {}};
    order.info.params = bakedParams(*view);
    order.info.incomplete = missingIn(*view);
    order.info.program = QCoreApplication::applicationVersion().toStdString();
    return order;
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event)
{
    if (sceneIn(event->mimeData()).isEmpty()) return;
    event->acceptProposedAction();
    startPage_->setDropping(true);
}

void MainWindow::dragLeaveEvent(QDragLeaveEvent*) { startPage_->setDropping(false); }

void MainWindow::dropEvent(QDropEvent* event)
{
    startPage_->setDropping(false);
    const QString file = sceneIn(event->mimeData());
    if (file.isEmpty()) return;
    event->acceptProposedAction();
    openScene(file);
}

void MainWindow::closeEvent(QCloseEvent* event)
{
    if (!mayDropEdits()) return event->ignore();
    remember();
    bridge_->cancel();
    QMainWindow::closeEvent(event);
}

} // namespace lightloom
