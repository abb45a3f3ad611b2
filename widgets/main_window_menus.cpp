// SPDX-License-Identifier: GPL-3.0-or-later
// How the window is put together: actions, menus, docks, bars. What they do stands in main_window.cpp.
#include "core/params/param_text.h"
#include "shaders/common.h"
#include "widgets/bake_bridge.h"
#include "widgets/bake_panel.h"
#include "widgets/compare_desk.h"
#include "widgets/main_window.h"
#include "widgets/start_page.h"
#include "widgets/viewport.h"
#include <QAction>
#include <QActionGroup>
#include <QApplication>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QMenuBar>
#include <QMessageBox>
#include <QUndoStack>

namespace lightloom {

QAction* MainWindow::makeAction(const QString& text, const QKeySequence& keys, const QString& tip)
{
    auto* action = new QAction(text, this);
    action->setShortcut(keys);
    QString plain = text;
    plain.remove('&');
    action->setToolTip(keys.isEmpty() ? tip : tr("%1 (%2)").arg(tip, keys.toString(QKeySequence::NativeText)));
    action->setStatusTip(tip);
    action->setIconText(plain);
    return action;
}

QAction* MainWindow::addModeAction(const QString& text, const QKeySequence& keys, ViewMode mode, const QString& tip)
{
    QAction* action = makeAction(text, keys, tip);
    action->setCheckable(true);
    action->setChecked(mode == ViewMode::octree);
    action->setData(static_cast<int>(mode));
    modes_->addAction(action);
    if (lastMode_ == nullptr) lastMode_ = action;
    connect(action, &QAction::toggled, this, [this, action](bool on) {
        if (!on) lastMode_ = action;
    });
    connect(action, &QAction::triggered, this, [this, mode] { setMode(mode); });
    return action;
}

void MainWindow::addToneAction(const QString& text, const QString& brief, const QString& tip, int tone)
{
    QAction* action = makeAction(text, {}, tip);
    action->setCheckable(true);
    action->setIconText(brief); // the toolbar is short
    action->setData(tone);
    tones_->addAction(action);
}

void MainWindow::makeActions()
{
    open_ = makeAction(tr("&Open..."), QKeySequence::Open, tr("Open a glTF scene"));
    reload_ = makeAction(tr("Read a&gain"), QKeySequence(Qt::CTRL | Qt::Key_R),
                         tr("Read the scene's file again and keep the camera"));
    export_ = makeAction(tr("&Export..."), QKeySequence(Qt::CTRL | Qt::Key_E),
                         tr("Write the light for other programs: lightmap, glTF scene, volume"));
    saveScene_ = makeAction(tr("&Save scene as..."), QKeySequence::SaveAs,
                            tr("Write the scene with its lamps as they are now, as binary glTF"));
    lampTool_ = makeAction(tr("Move &lamps"), QKeySequence(Qt::Key_L),
                           tr("Show lamps in the picture: click one, drag its handles; Esc takes a drag back"));
    lampTool_->setCheckable(true);
    lampTool_->setIconText(tr("Lamps")); // the toolbar is short
    undo_ = undoStack_->createUndoAction(this, tr("&Undo"));
    undo_->setShortcut(QKeySequence::Undo);
    undo_->setStatusTip(tr("Take back the last edit of a lamp or a parameter"));
    redo_ = undoStack_->createRedoAction(this, tr("&Redo"));
    redo_->setShortcut(QKeySequence::Redo);
    redo_->setStatusTip(tr("Make the edit again that was taken back"));
    quit_ = makeAction(tr("&Quit"), QKeySequence::Quit, tr("Close the window"));
    modes_ = new QActionGroup(this);
    // what shows the same bake in other ways has Alt with it
    bakeModes_ = {addModeAction(tr("&Octree"), Qt::Key_1, ViewMode::octree,
                                tr("Direct light and the baked indirect light, from virtual lights")),
                  addModeAction(tr("&Grid"), Qt::Key_2, ViewMode::grid,
                                tr("Direct light and indirect light from an irradiance grid, also on objects that were "
                                   "not in the bake")),
                  addModeAction(tr("&Lightcuts"), Qt::Key_3, ViewMode::lightcuts,
                                tr("Direct light and light of surface voxels; a picture gathered from all of them "
                                   "comes over it")),
                  addModeAction(tr("&Colour octree"), Qt::ALT | Qt::Key_1, ViewMode::colours,
                                tr("The same octree without directions: each cell keeps the sum of its light alone")),
                  addModeAction(tr("Photon &map"), Qt::ALT | Qt::Key_2, ViewMode::photonMap,
                                tr("Irradiance kept at every 4th photon, the nearest answers; rendered bit by bit")),
                  addModeAction(tr("A&tlas"), Qt::ALT | Qt::Key_3, ViewMode::atlas,
                                tr("The bake's light kept in a lightmap: each pixel reads one texel"))};
    bakeModes_[3]->setIconText(tr("Colours")); // the toolbar is short
    bakeModes_[4]->setIconText(tr("Photons"));
    addModeAction(tr("&Reference"), Qt::Key_4, ViewMode::reference,
                  tr("The path-traced picture, as far as it has come; the bake until then"));
    addModeAction(tr("&Direct"), Qt::Key_5, ViewMode::direct, tr("Light that comes straight from the lamps (preview)"));
    addModeAction(tr("&Plain"), Qt::Key_6, ViewMode::plain, tr("Form without light"));
    swapModes_ = makeAction(tr("S&wap views"), QKeySequence(Qt::Key_Tab), tr("Back to the view before this one"));
    indirect_ = makeAction(tr("&Indirect only"), QKeySequence(Qt::Key_I), tr("Show the baked indirect light alone"));
    indirect_->setCheckable(true);
    indirect_->setIconText(tr("Indirect")); // the toolbar is short
    frame_ = makeAction(tr("&Frame all"), QKeySequence(Qt::Key_F), tr("Move back until the whole scene is in view"));
    brighter_ = makeAction(tr("&Brighter"), QKeySequence(Qt::CTRL | Qt::Key_Up), tr("Expose a third of a stop more"));
    tones_ = new QActionGroup(this);
    addToneAction(tr("&No tone curve"), tr("Linear"), tr("Show light as it is, cut off at white"), shader::kToneNone);
    addToneAction(tr("&Soft highlights"), tr("Soft"), tr("Straight up to 70 % of white, a shoulder above"),
                  shader::kToneSoft);
    tones_->actions().last()->setChecked(true);
    darker_ = makeAction(tr("D&arker"), QKeySequence(Qt::CTRL | Qt::Key_Down), tr("Expose a third of a stop less"));
    lightTheme_ = makeAction(tr("&Light theme"), {}, tr("Light greys instead of dark ones"));
    lightTheme_->setCheckable(true);
    start_ =
        makeAction(tr("&Bake again"), QKeySequence(Qt::CTRL | Qt::Key_B), tr("Start a bake with these parameters"));
    pause_ = makeAction(tr("&Pause"), QKeySequence(Qt::Key_Space), tr("Hold the bake; its picture stays"));
    pause_->setCheckable(true);
    cancel_ = makeAction(tr("&Cancel"), QKeySequence(Qt::Key_Escape), tr("Stop the bake; its newest picture stays"));
    resetParams_ = makeAction(tr("&Reset parameters"), {}, tr("All parameters back to their defaults"));
    shortcuts_ =
        makeAction(tr("&Keys and mouse"), QKeySequence::HelpContents, tr("List every key and what the mouse does"));
    about_ = makeAction(tr("&About Lightloom"), {}, tr("Version and licence"));
    for (QAction* action : {reload_, saveScene_, export_, start_, pause_, cancel_}) action->setEnabled(false);
    makeCompareActions();
    makeGridActions();
    makeVoxelActions();
    makeGuestActions();
    connectActions();
}

void MainWindow::connectActions()
{
    connect(open_, &QAction::triggered, this, &MainWindow::chooseFile);
    connect(reload_, &QAction::triggered, this, [this] { openScene(file_); });
    connect(export_, &QAction::triggered, this, &MainWindow::showExport);
    connect(swapModes_, &QAction::triggered, this, [this] { lastMode_->trigger(); });
    connect(quit_, &QAction::triggered, this, &QWidget::close);
    connect(indirect_, &QAction::toggled, this, [this](bool on) {
        if (viewport_ != nullptr) viewport_->setIndirectOnly(on);
    });
    connect(frame_, &QAction::triggered, this, [this] {
        if (viewport_ != nullptr) viewport_->frameScene();
    });
    connect(brighter_, &QAction::triggered, this, [this] { exposure_->setValue(exposure_->value() - 1.0 / 3.0); });
    connect(darker_, &QAction::triggered, this, [this] { exposure_->setValue(exposure_->value() + 1.0 / 3.0); });
    connect(lightTheme_, &QAction::toggled, this, [this](bool on) { setTheme(on ? Theme::light : Theme::dark); });
    connect(start_, &QAction::triggered, this, [this] { startBake(false); });
    connect(pause_, &QAction::toggled, this, [this](bool on) {
        bridge_->setPaused(on);
        tellBusy();
        pause_->setIconText(on ? tr("Go on") : tr("Pause"));
        statusStage_->setText(on ? tr("Paused") : bakePanel_->stageText());
    });
    connect(cancel_, &QAction::triggered, this, [this] {
        pause_->setChecked(false);
        bridge_->cancel();
    });
    connect(resetParams_, &QAction::triggered, this, [this] { setParams(defaultParams(method_)); });
    connect(shortcuts_, &QAction::triggered, this, &MainWindow::showShortcuts);
    connect(about_, &QAction::triggered, this, [this] {
        QMessageBox::about(this, tr("Lightloom"),
                           tr("<b>Lightloom %1</b><br>Lighting design with baked indirect light.<br><br>"
                              "This program is free software under the GNU General Public License, version 3 or "
                              "later; its core library is under the Apache License 2.0.")
                               .arg(QCoreApplication::applicationVersion()));
    });
}

void MainWindow::buildMenus()
{
    QMenu* file = menuBar()->addMenu(tr("&File"));
    file->addActions({open_, reload_});
    recent_ = file->addMenu(tr("Open &recent"));
    QMenu* samples = file->addMenu(tr("&Sample scenes"));
    for (const QString& sample : sampleSceneFiles()) {
        samples->addAction(sceneTitle(sample), this, [this, sample] { openScene(sample); });
    }
    samples->setEnabled(!samples->isEmpty());
    file->addSeparator();
    file->addActions({saveScene_, export_});
    file->addSeparator();
    file->addAction(quit_);
    QMenu* edit = menuBar()->addMenu(tr("&Edit"));
    edit->addActions({undo_, redo_});
    edit->addSeparator();
    edit->addAction(lampTool_);
    QMenu* guests = edit->addMenu(tr("&Object in the light"));
    guests->addActions(addGuests_);
    guests->addSeparator();
    guests->addAction(removeGuest_);
    edit->addAction(resetParams_);
    QMenu* view = menuBar()->addMenu(tr("&View"));
    view->addActions(modes_->actions());
    view->addActions({swapModes_, indirect_});
    view->addMenu(tr("&Show"))->addActions(shown_->actions());
    view->addAction(pick_);
    addGridMenu(*view);
    addVoxelMenu(*view);
    view->addSeparator();
    view->addAction(frame_);
    cameraMenu_ = view->addMenu(tr("&Cameras"));
    cameraMenu_->setEnabled(false);
    view->addSeparator();
    view->addActions({brighter_, darker_});
    view->addMenu(tr("T&one curve"))->addActions(tones_->actions());
    view->addSeparator();
    view->addAction(lightTheme_);
    panels_ = view->addMenu(tr("Pa&nels"));
    for (QDockWidget* dock : findChildren<QDockWidget*>()) panels_->addAction(dock->toggleViewAction());
    panels_->addSeparator();
    panels_->addAction(tr("Put all &back"), this, &MainWindow::putDocksBack)
        ->setStatusTip(tr("All panels where they are at first"));
    panels_->setEnabled(false);
    QMenu* bake = menuBar()->addMenu(tr("&Bake"));
    bake->addActions({start_, pause_, cancel_});
    QMenu* compare = menuBar()->addMenu(tr("&Compare"));
    compare->addActions({reference_, wipe_});
    QMenu* help = menuBar()->addMenu(tr("&Help"));
    help->addActions({shortcuts_, about_});
    fillRecent();
}

void MainWindow::showShortcuts()
{
    QString rows;
    const auto add = [&rows](const QString& keys, const QString& what) {
        rows += QStringLiteral("<tr><td><b>%1</b>&nbsp;&nbsp;</td><td>%2</td></tr>")
                    .arg(keys.toHtmlEscaped(), what.toHtmlEscaped());
    };
    for (const QAction* action : findChildren<QAction*>()) {
        if (action->shortcut().isEmpty() || action->statusTip().isEmpty()) continue;
        add(action->shortcut().toString(QKeySequence::NativeText), action->statusTip());
    }
    add(tr("Left drag"), tr("Orbit about the pivot"));
    add(tr("Middle or Shift+left drag"), tr("Pan"));
    add(tr("Wheel"), tr("Zoom to the cursor"));
    add(tr("Right drag, W A S D, Q E"), tr("Look around and walk; Shift runs"));
    add(tr("Double click"), tr("Set the pivot"));
    add(tr("Drag, wheel on an object in the light"), tr("Move it level (Shift: up and down), turn it"));
    add(tr("Alt+click"), tr("See what octree, grid or voxels keep there"));
    add(tr("Arrow keys, Home, End"), tr("Move the wipe while its handle has the focus; Shift moves it finer"));
    auto* box = new QMessageBox(QMessageBox::NoIcon, tr("Keys and mouse"),
                                QStringLiteral("<table>%1</table>").arg(rows), QMessageBox::Close, this);
    box->setAttribute(Qt::WA_DeleteOnClose);
    box->setModal(false);
    box->show();
}

} // namespace lightloom
