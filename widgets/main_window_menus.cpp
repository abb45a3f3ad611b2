// SPDX-License-Identifier: GPL-3.0-or-later
// How the window is put together: actions, menus, docks, bars. What they do stands in main_window.cpp.
#include "shaders/common.h"
#include "widgets/bake_bridge.h"
#include "widgets/bake_panel.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/main_window.h"
#include "widgets/message_bar.h"
#include "widgets/param_panel.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "widgets/start_page.h"
#include "widgets/viewport.h"
#include <QAction>
#include <QActionGroup>
#include <QApplication>
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QLabel>
#include <QMenuBar>
#include <QMessageBox>
#include <QScrollArea>
#include <QSettings>
#include <QStackedWidget>
#include <QStatusBar>
#include <QToolButton>
#include <QVBoxLayout>

namespace lightloom {

namespace {
constexpr int kMostRecent = 8;
} // namespace

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

void MainWindow::addModeAction(const QString& text, Qt::Key key, ViewMode mode, const QString& tip)
{
    QAction* action = makeAction(text, QKeySequence(key), tip);
    action->setCheckable(true);
    action->setChecked(mode == ViewMode::octree);
    modes_->addAction(action);
    connect(action, &QAction::triggered, this, [this, mode] {
        if (viewport_ != nullptr) viewport_->setMode(mode);
    });
}

void MainWindow::makeActions()
{
    open_ = makeAction(tr("&Open..."), QKeySequence::Open, tr("Open a glTF scene"));
    quit_ = makeAction(tr("&Quit"), QKeySequence::Quit, tr("Close the window"));
    modes_ = new QActionGroup(this);
    // 2 to 4 are kept for methods that are not here yet
    addModeAction(tr("&Octree"), Qt::Key_1, ViewMode::octree, tr("Direct light and the baked indirect light"));
    addModeAction(tr("&Direct"), Qt::Key_5, ViewMode::direct, tr("Light that comes straight from the lamps (preview)"));
    addModeAction(tr("&Plain"), Qt::Key_6, ViewMode::plain, tr("Form without light"));
    indirect_ = makeAction(tr("&Indirect only"), QKeySequence(Qt::Key_I), tr("Show the baked indirect light alone"));
    indirect_->setCheckable(true);
    frame_ = makeAction(tr("&Frame all"), QKeySequence(Qt::Key_F), tr("Move back until the whole scene is in view"));
    brighter_ = makeAction(tr("&Brighter"), QKeySequence(Qt::CTRL | Qt::Key_Up), tr("Expose a third of a stop more"));
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
    for (QAction* action : {pause_, cancel_}) action->setEnabled(false);

    connect(open_, &QAction::triggered, this, &MainWindow::chooseFile);
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
        if (viewport_ != nullptr) viewport_->setBusy(isBaking_ && !on);
        pause_->setIconText(on ? tr("Go on") : tr("Pause"));
        statusStage_->setText(on ? tr("Paused") : bakePanel_->stageText());
    });
    connect(cancel_, &QAction::triggered, this, [this] {
        pause_->setChecked(false);
        bridge_->cancel();
    });
    connect(resetParams_, &QAction::triggered, this, [this] { setParams(BakeParams{}); });
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
    file->addAction(open_);
    recent_ = file->addMenu(tr("Open &recent"));
    QMenu* samples = file->addMenu(tr("&Sample scenes"));
    for (const QString& sample : sampleSceneFiles()) {
        samples->addAction(sceneTitle(sample), this, [this, sample] { openScene(sample); });
    }
    samples->setEnabled(!samples->isEmpty());
    file->addSeparator();
    file->addAction(quit_);
    menuBar()->addMenu(tr("&Edit"))->addAction(resetParams_);
    QMenu* view = menuBar()->addMenu(tr("&View"));
    view->addActions(modes_->actions());
    view->addAction(indirect_);
    view->addSeparator();
    view->addAction(frame_);
    cameraMenu_ = view->addMenu(tr("&Cameras"));
    cameraMenu_->setEnabled(false);
    view->addSeparator();
    view->addActions({brighter_, darker_});
    view->addSeparator();
    view->addAction(lightTheme_);
    panels_ = view->addMenu(tr("Pa&nels"));
    for (QDockWidget* dock : findChildren<QDockWidget*>()) panels_->addAction(dock->toggleViewAction());
    QMenu* bake = menuBar()->addMenu(tr("&Bake"));
    bake->addActions({start_, pause_, cancel_});
    QMenu* help = menuBar()->addMenu(tr("&Help"));
    help->addActions({shortcuts_, about_});
    fillRecent();
}

void MainWindow::buildToolbar(QHBoxLayout& row)
{
    const auto addButton = [&row](QAction* action) {
        auto* button = new QToolButton;
        button->setDefaultAction(action);
        button->setToolButtonStyle(Qt::ToolButtonTextOnly);
        button->setFocusPolicy(Qt::TabFocus);
        row.addWidget(button);
    };
    for (QAction* action : modes_->actions()) addButton(action);
    row.addSpacing(10);
    addButton(indirect_);
    row.addStretch(1);
    auto* preview = new QLabel(tr("direct light: preview"));
    preview->setForegroundRole(QPalette::PlaceholderText);
    preview->setToolTip(
        tr("Direct light in the window comes from shadow maps and sample lights. `lightloom-cli render` "
           "traces it exactly."));
    row.addWidget(preview);
    row.addSpacing(10);
    exposure_ = new QDoubleSpinBox;
    exposure_->setRange(-10.0, 30.0);
    exposure_->setDecimals(1);
    exposure_->setSingleStep(1.0 / 3.0);
    exposure_->setValue(10.0);
    exposure_->setPrefix(tr("EV "));
    exposure_->setAccessibleName(tr("Exposure value at ISO 100"));
    exposure_->setToolTip(tr("Exposure value at ISO 100: one more shows half as bright. 1.2 x 2^EV cd/m² is white."));
    tone_ = new QComboBox;
    tone_->addItem(tr("No tone curve"), shader::kToneNone);
    tone_->addItem(tr("Soft highlights"), shader::kToneSoft);
    tone_->setCurrentIndex(1);
    tone_->setAccessibleName(tr("Tone curve"));
    tone_->setToolTip(tr("Soft highlights: straight up to 70 % of white, a shoulder above."));
    row.addWidget(exposure_);
    row.addWidget(tone_);
    connect(exposure_, &QDoubleSpinBox::valueChanged, this, [this](double ev) {
        if (viewport_ != nullptr) viewport_->setExposure(static_cast<float>(ev));
    });
    connect(tone_, &QComboBox::currentIndexChanged, this, [this] {
        if (viewport_ != nullptr) viewport_->setTone(tone_->currentData().toInt());
    });
}

void MainWindow::buildCentre()
{
    workPage_ = new QWidget;
    auto* column = new QVBoxLayout(workPage_);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    auto* tools = new QHBoxLayout;
    tools->setContentsMargins(6, 3, 6, 3);
    buildToolbar(*tools);
    column->addLayout(tools);
    const Result<Done> gl = probeGl();
    if (gl) {
        viewport_ = new Viewport;
        column->addWidget(viewport_, 1);
    } else {
        auto* instead = new QLabel(tr("No picture: %1.\nBakes and figures work all the same.")
                                       .arg(QString::fromStdString(gl.error().message)));
        instead->setObjectName(QStringLiteral("noOpenGl"));
        instead->setAlignment(Qt::AlignCenter);
        instead->setWordWrap(true);
        column->addWidget(instead, 1);
    }
    snapshots_ = new SnapshotBar;
    column->addWidget(snapshots_);
    auto* start = new StartPage;
    connect(start, &StartPage::openWanted, this, &MainWindow::chooseFile);
    connect(start, &StartPage::sampleWanted, this, &MainWindow::openScene);
    pages_ = new QStackedWidget;
    pages_->addWidget(start);
    pages_->addWidget(workPage_);
    messages_ = new MessageBar;
    auto* centre = new QWidget;
    auto* all = new QVBoxLayout(centre);
    all->setContentsMargins(0, 0, 0, 0);
    all->setSpacing(0);
    all->addWidget(messages_);
    all->addWidget(pages_, 1);
    setCentralWidget(centre);
    // Space and letters belong to buttons and fields in the docks; here they are commands
    for (QAction* action : {pause_, cancel_}) {
        action->setShortcutContext(Qt::WidgetWithChildrenShortcut);
        centre->addAction(action);
    }
}

void MainWindow::buildDocks()
{
    const auto addDock = [this](const QString& title, const char* name, QWidget* inside, Qt::DockWidgetArea area) {
        auto* dock = new QDockWidget(title, this);
        dock->setObjectName(QString::fromLatin1(name));
        dock->setFeatures(QDockWidget::DockWidgetClosable | QDockWidget::DockWidgetMovable);
        dock->setWidget(inside);
        addDockWidget(area, dock);
        return dock;
    };
    sceneDock_ = new SceneDock;
    QDockWidget* left = addDock(tr("Scene"), "sceneDock", sceneDock_, Qt::LeftDockWidgetArea);
    bakePanel_ = new BakePanel(start_, pause_, cancel_);
    paramPanel_ = new ParamPanel(Method::lightOctree);
    auto* area = new QScrollArea;
    area->setWidgetResizable(true);
    area->setFrameShape(QFrame::NoFrame);
    area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    area->setWidget(paramPanel_);
    area->setMinimumWidth(paramPanel_->sizeHint().width() + 24);
    auto* inside = new QWidget;
    auto* column = new QVBoxLayout(inside);
    column->setContentsMargins(0, 0, 0, 0);
    column->addWidget(bakePanel_);
    column->addWidget(area, 1);
    QDockWidget* right = addDock(tr("Bake"), "bakeDock", inside, Qt::RightDockWidgetArea);
    resizeDocks({left, right}, {200, 320}, Qt::Horizontal);
}

void MainWindow::buildStatus()
{
    statusStage_ = new QLabel;
    statusLux_ = new QLabel(tr("- lx"));
    statusFrame_ = new QLabel(tr("- ms"));
    statusSize_ = new QLabel;
    statusFrame_->setToolTip(tr("Time of the last picture. Coarse: drawn at lower resolution while the camera moves."));
    statusBar()->addWidget(statusStage_, 1);
    for (QLabel* label : {statusLux_, statusFrame_, statusSize_}) statusBar()->addPermanentWidget(label);
    statusBar()->setSizeGripEnabled(false);
}

void MainWindow::setTheme(Theme theme)
{
    applyTheme(theme);
    if (viewport_ != nullptr) viewport_->setBackground(viewportBackground(theme));
}

void MainWindow::restore()
{
    const bool isLight = settings_ != nullptr && settings_->value("lightTheme", false).toBool();
    {
        const QSignalBlocker quiet(lightTheme_);
        lightTheme_->setChecked(isLight);
    }
    setTheme(isLight ? Theme::light : Theme::dark);
    if (settings_ == nullptr) return;
    restoreGeometry(settings_->value("geometry").toByteArray());
    restoreState(settings_->value("docks").toByteArray());
    tone_->setCurrentIndex(settings_->value("tone", 1).toInt() == 0 ? 0 : 1);
}

void MainWindow::rememberFile(const QString& file)
{
    if (settings_ == nullptr) return;
    const QString full = QFileInfo(file).absoluteFilePath();
    QStringList files = settings_->value("recent").toStringList();
    files.removeAll(full);
    files.prepend(full);
    settings_->setValue("recent", QStringList(files.mid(0, kMostRecent)));
    settings_->setValue("folder", QFileInfo(full).absolutePath());
    fillRecent();
}

void MainWindow::fillRecent()
{
    recent_->clear();
    const QStringList files = settings_ != nullptr ? settings_->value("recent").toStringList() : QStringList();
    for (const QString& file : files) {
        recent_->addAction(QFileInfo(file).fileName(), this, [this, file] { openScene(file); })->setStatusTip(file);
    }
    recent_->setEnabled(!files.isEmpty());
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
    auto* box = new QMessageBox(QMessageBox::NoIcon, tr("Keys and mouse"),
                                QStringLiteral("<table>%1</table>").arg(rows), QMessageBox::Close, this);
    box->setAttribute(Qt::WA_DeleteOnClose);
    box->setModal(false);
    box->show();
}

} // namespace lightloom
