// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps that are moved and changed: who chooses them, what an edit sets going, and how it is kept.
#include "core/scene/gltf_writer.h"
#include "widgets/compare_desk.h"
#include "widgets/edit_command.h"
#include "widgets/lamp_desk.h"
#include "widgets/lamp_editor.h"
#include "widgets/main_window.h"
#include "widgets/message_bar.h"
#include "widgets/scene_dock.h"
#include "widgets/start_page.h"
#include "widgets/sweep_panel.h"
#include "widgets/viewport.h"
#include <QAction>
#include <QCloseEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QLabel>
#include <QMessageBox>
#include <QUndoStack>
#include <algorithm>

namespace lightloom {

namespace {

constexpr int kLampEdits = 2'000'000; ///< numbers of undo steps that may be joined, by lamp; after those of parameters
constexpr int kLampDelayMs = 15;      ///< steps of a drag within it make one bake

bool isAlike(const PunctualLight& a, const PunctualLight& b)
{
    return a.position == b.position && a.travel == b.travel && a.intensity == b.intensity &&
           a.innerCone == b.innerCone && a.outerCone == b.outerCone;
}

struct LampEdit {
    int light = 0;
    PunctualLight lamp;
    friend bool operator==(const LampEdit& a, const LampEdit& b)
    {
        return a.light == b.light && isAlike(a.lamp, b.lamp);
    }
};

QString nameOf(const PunctualLight& lamp)
{
    const std::string leaf = lamp.node.substr(lamp.node.rfind('/') + 1);
    return QString::fromStdString(leaf.empty() ? lamp.name : leaf);
}

} // namespace

void MainWindow::connectLamps()
{
    lampDelay_.setSingleShot(true);
    lampDelay_.setInterval(kLampDelayMs);
    connect(&lampDelay_, &QTimer::timeout, this, [this] { startBake(false); });
    connect(&sceneDock_->editor(), &LampEditor::edited, this,
            [this](int light, const PunctualLight& now, const QString& what) {
                const PunctualLight before = data_->scene->lights[static_cast<std::size_t>(light)];
                useLamp(light, now);
                keepLamp(light, before, tr("%1 of %2").arg(what, nameOf(now)), kLampEdits + light);
            });
    connect(saveScene_, &QAction::triggered, this, &MainWindow::saveScene);
    if (viewport_ == nullptr) {
        lampTool_->setEnabled(false);
        connect(sceneDock_, &SceneDock::lampChosen, this, [this](int group) {
            const auto& lights = data_->scene->lights;
            const auto found = std::ranges::find(lights, group, &PunctualLight::group);
            lampChosen(group, found == lights.end() ? -1 : static_cast<int>(found - lights.begin()));
        });
        return;
    }
    lampDesk_ = new LampDesk(viewport_, lampTool_, this);
    connect(sceneDock_, &SceneDock::lampChosen, this, [this](int group) {
        if (group >= 0) lampTool_->setChecked(true);
        lampDesk_->choose(group);
    });
    connect(lampDesk_, &LampDesk::chosen, this, &MainWindow::lampChosen);
    connect(lampDesk_, &LampDesk::dragged, this, &MainWindow::useLamp);
    connect(lampDesk_, &LampDesk::dropped, this, [this](int light, const PunctualLight& before) {
        keepLamp(light, before, tr("moving %1").arg(nameOf(before)), -1);
    });
}

void MainWindow::lampChosen(int group, int light)
{
    chosenGroup_ = group;
    chosenLight_ = light;
    sceneDock_->showLamp(data_ ? data_->scene : nullptr, group, light);
}

/// The lamp as it is from now on, also in the middle of a drag.
void MainWindow::useLamp(int light, const PunctualLight& lamp)
{
    const auto scene = std::make_shared<Scene>(*data_->scene); // shares images and meshes
    scene->lights[static_cast<std::size_t>(light)] = lamp;
    data_ = withLamps(*data_, scene);
    if (viewport_ != nullptr) {
        viewport_->setLamps(data_);
        lampDesk_->setLamps(scene);
        compareDesk_->lampsMoved();
    }
    sceneDock_->showLamp(scene, chosenGroup_, chosenLight_);
    setWindowModified(!std::ranges::equal(scene->lights, savedLights_, isAlike));
    if (!lampDelay_.isActive()) lampDelay_.start();
}

/// A step for undo, made already.
void MainWindow::keepLamp(int light, const PunctualLight& before, const QString& text, int merge)
{
    const LampEdit old{light, before}, now{light, data_->scene->lights[static_cast<std::size_t>(light)]};
    if (old == now) return;
    const auto apply = [this](const LampEdit& edit) {
        useLamp(edit.light, edit.lamp);
        sweepPanel_->setScene(data_->scene, file_);
    };
    undoStack_->push(new EditCommand<LampEdit>(text, old, now, apply, merge));
    sweepPanel_->setScene(data_->scene, file_);
}

void MainWindow::forgetLampEdits()
{
    lampDelay_.stop();
    savedLights_ = data_->scene->lights;
    setWindowModified(false);
    if (lampDesk_ != nullptr) {
        lampDesk_->setScene(data_->scene);
    } else {
        lampChosen(-1, -1);
    }
}

void MainWindow::saveScene()
{
    const QFileInfo from(file_);
    auto* dialog = new QFileDialog(this, tr("Save the scene"), from.dir().filePath(from.completeBaseName() + "-lamps"),
                                   tr("Binary glTF scenes (*.glb)"));
    dialog->setObjectName(QStringLiteral("saveScene"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setAcceptMode(QFileDialog::AcceptSave);
    dialog->setDefaultSuffix(QStringLiteral("glb"));
    connect(dialog, &QFileDialog::fileSelected, this, &MainWindow::saveSceneAs);
    dialog->open();
}

void MainWindow::saveSceneAs(const QString& file)
{
    statusStage_->setText(tr("Writing %1").arg(QFileInfo(file).fileName()));
    savePool_.start([this, file, scene = data_->scene] {
        const Result<Done> written = writeGltf(*scene, std::filesystem::path(file.toStdString()));
        const QString problem = written ? QString() : QString::fromStdString(written.error().message);
        QMetaObject::invokeMethod(this, [this, file, scene, problem] { sceneSaved(file, scene, problem); });
    });
}

void MainWindow::sceneSaved(const QString& file, const std::shared_ptr<const Scene>& scene, const QString& problem)
{
    if (!problem.isEmpty()) {
        messages_->show(problem, tr("Save elsewhere..."), [this] { saveScene(); });
        return;
    }
    statusStage_->setText(tr("Saved %1").arg(QFileInfo(file).fileName()));
    if (!isSameSurface(*scene, *data_->scene)) return; // another scene was opened meanwhile
    savedLights_ = scene->lights;
    setWindowModified(!std::ranges::equal(data_->scene->lights, savedLights_, isAlike));
    file_ = file;
    setWindowTitle(tr("%1[*] - Lightloom").arg(sceneTitle(file)));
    rememberFile(file);
}

/// Whether edits of lamps that no file has may go. Asks where there are some.
bool MainWindow::mayDropEdits()
{
    if (!isWindowModified()) return true;
    const auto answer =
        QMessageBox::question(this, tr("Lamps were changed"),
                              tr("Lamps of %1 were moved or changed, and no file has that yet.").arg(sceneTitle(file_)),
                              QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, QMessageBox::Save);
    if (answer == QMessageBox::Save) saveScene();
    return answer == QMessageBox::Discard;
}

bool MainWindow::mayDropLaterEdits()
{
    return !data_ || std::ranges::equal(data_->scene->lights, givenUp_, isAlike) || mayDropEdits();
}

} // namespace lightloom
