// SPDX-License-Identifier: GPL-3.0-or-later
// Where things are in the window: picture, docks, bars.
#include "shaders/common.h"
#include "widgets/bake_panel.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/legend_strip.h"
#include "widgets/main_window.h"
#include "widgets/message_bar.h"
#include "widgets/param_panel.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "widgets/start_page.h"
#include "widgets/viewport.h"
#include "widgets/voxel_panel.h"
#include <QAction>
#include <QActionGroup>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QMenu>
#include <QScrollArea>
#include <QStackedWidget>
#include <QStatusBar>
#include <QTabWidget>
#include <QToolBar>
#include <QToolButton>
#include <QVBoxLayout>

namespace lightloom {

/// The first of the toolbar: the mode that shows the bake, and a menu of the other ones.
QWidget* MainWindow::makeModeButton()
{
    auto* button = new QToolButton;
    auto* menu = new QMenu(button);
    menu->addActions(bakeModes_);
    button->setMenu(menu);
    button->setPopupMode(QToolButton::MenuButtonPopup);
    button->setDefaultAction(bakeModes_.first());
    connect(modes_, &QActionGroup::triggered, button, [this, button](QAction* action) {
        if (bakeModes_.contains(action)) button->setDefaultAction(action);
    });
    return button;
}

void MainWindow::buildToolbar()
{
    QToolBar& row = *tools_; // what does not fit goes into its menu
    row.setToolButtonStyle(Qt::ToolButtonTextOnly);
    row.addWidget(makeModeButton());
    for (QAction* action : modes_->actions()) {
        if (!bakeModes_.contains(action)) row.addAction(action);
    }
    row.addSeparator();
    row.addActions({lampTool_, indirect_});
    row.addWidget(makeShownButton());
    auto* space = new QWidget;
    space->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
    row.addWidget(space);
    exposure_ = new QDoubleSpinBox;
    exposure_->setRange(-10.0, 30.0);
    exposure_->setDecimals(1);
    exposure_->setSingleStep(1.0 / 3.0);
    exposure_->setValue(10.0);
    exposure_->setPrefix(tr("EV "));
    exposure_->setAccessibleName(tr("Exposure value at ISO 100"));
    exposure_->setToolTip(tr("Exposure value at ISO 100: one more shows half as bright. 1.2 x 2^EV cd/m² is white."));
    row.addWidget(exposure_);
    row.addWidget(makeToneButton());
    connect(exposure_, &QDoubleSpinBox::valueChanged, this, [this](double ev) {
        if (viewport_ != nullptr) viewport_->setExposure(static_cast<float>(ev));
    });
}

QWidget* MainWindow::makeToneButton()
{
    auto* button = new QToolButton;
    auto* menu = new QMenu(button);
    menu->addActions(tones_->actions());
    button->setMenu(menu);
    button->setPopupMode(QToolButton::InstantPopup);
    button->setText(tones_->checkedAction()->iconText());
    button->setToolTip(tr("Tone curve: how light becomes what the screen shows"));
    button->setAccessibleName(tr("Tone curve"));
    for (QAction* tone : tones_->actions()) {
        connect(tone, &QAction::toggled, button, [this, button, tone](bool on) {
            if (!on) return;
            button->setText(tone->iconText());
            if (viewport_ != nullptr) viewport_->setTone(tone->data().toInt());
        });
    }
    return button;
}

void MainWindow::buildCentre()
{
    workPage_ = new QWidget;
    auto* column = new QVBoxLayout(workPage_);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    tools_ = new QToolBar;
    buildToolbar();
    column->addWidget(tools_);
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
    legend_ = new LegendStrip;
    legend_->hide();
    snapshots_ = new SnapshotBar;
    legend_->setFixedHeight(snapshots_->height());
    // side by side: a legend that took height would change the picture's size, and so end the reference it is for
    auto* below = new QHBoxLayout;
    below->addWidget(snapshots_);
    below->addWidget(legend_, 1);
    column->addLayout(below);
    startPage_ = new StartPage;
    connect(startPage_, &StartPage::openWanted, this, &MainWindow::chooseFile);
    connect(startPage_, &StartPage::sceneWanted, this, &MainWindow::openScene);
    pages_ = new QStackedWidget;
    pages_->addWidget(startPage_);
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
    if (viewport_ == nullptr) return;
    swapModes_->setShortcutContext(Qt::WidgetShortcut); // elsewhere Tab moves the focus, here Shift+Tab does
    viewport_->addAction(swapModes_);
}

namespace {

/// Panels that are higher than a small screen; as narrow as their longest words allow.
QScrollArea* scrolled(QWidget* inside)
{
    auto* area = new QScrollArea;
    area->setWidgetResizable(true);
    area->setFrameShape(QFrame::NoFrame);
    area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    area->setWidget(inside);
    area->setMinimumWidth(area->fontMetrics().horizontalAdvance(QStringLiteral("Largest gather radius and then some")));
    return area;
}

} // namespace

void MainWindow::buildDocks()
{
    const auto addDock = [this](const QString& title, const char* name, QWidget* inside, Qt::DockWidgetArea area) {
        auto* dock = new QDockWidget(title, this);
        dock->setObjectName(QString::fromLatin1(name));
        dock->setFeatures(QDockWidget::DockWidgetClosable | QDockWidget::DockWidgetMovable |
                          QDockWidget::DockWidgetFloatable);
        dock->setWidget(inside);
        addDockWidget(area, dock);
        dock->hide(); // there is nothing in them before a scene is open
        return dock;
    };
    sceneDock_ = new SceneDock;
    addDock(tr("Scene"), "sceneDock", sceneDock_, Qt::LeftDockWidgetArea);
    bakePanel_ = new BakePanel(start_, pause_, cancel_);
    paramPanel_ = new ParamPanel(Method::lightOctree);
    auto* inside = new QWidget;
    auto* column = new QVBoxLayout(inside);
    column->setContentsMargins(0, 0, 0, 0);
    column->addWidget(bakePanel_);
    voxelPanel_ = new VoxelPanel(worker_);
    voxelPanel_->setViewport(viewport_);
    voxelPanel_->hide();
    column->addWidget(voxelPanel_);
    column->addWidget(paramPanel_, 1);
    setTabPosition(Qt::RightDockWidgetArea, QTabWidget::North);
    QDockWidget* bake = addDock(tr("Bake"), "bakeDock", scrolled(inside), Qt::RightDockWidgetArea);
    QDockWidget* compare = addDock(tr("Compare"), "compareDock", scrolled(makeComparePanel()), Qt::RightDockWidgetArea);
    QDockWidget* measure = addDock(tr("Measure"), "measureDock", scrolled(makeSweepPanel()), Qt::RightDockWidgetArea);
    tabifyDockWidget(bake, compare);
    tabifyDockWidget(compare, measure);
}

void MainWindow::showDocks()
{
    for (QDockWidget* dock : findChildren<QDockWidget*>()) dock->show();
    findChild<QDockWidget*>(QStringLiteral("bakeDock"))->raise();
    panels_->setEnabled(true);
    if (docks_.isEmpty() || !restoreState(docks_)) sizeDocks();
}

void MainWindow::putDocksBack()
{
    QDockWidget* first = nullptr; // of those on the right, which are one behind the other
    for (QDockWidget* dock : findChildren<QDockWidget*>()) {
        const bool isScene = dock->objectName() == QStringLiteral("sceneDock");
        dock->setFloating(false);
        addDockWidget(isScene ? Qt::LeftDockWidgetArea : Qt::RightDockWidgetArea, dock);
        if (!isScene && first != nullptr) tabifyDockWidget(first, dock);
        if (!isScene) first = dock;
        dock->show();
    }
    findChild<QDockWidget*>(QStringLiteral("bakeDock"))->raise();
    sizeDocks();
}

void MainWindow::sizeDocks()
{
    auto* left = findChild<QDockWidget*>(QStringLiteral("sceneDock"));
    auto* right = findChild<QDockWidget*>(QStringLiteral("bakeDock"));
    const int wanted = paramPanel_->sizeHint().width() + 24;
    resizeDocks({left, right}, {200, std::min(wanted, width() / 3)}, Qt::Horizontal);
}

void MainWindow::buildStatus()
{
    statusStage_ = new QLabel;
    statusLux_ = new QLabel;
    statusNoise_ = new QLabel;
    statusNoise_->setToolTip(tr("Noise of the indirect light, stated by the bake itself, of the mean"));
    statusDirect_ = new QLabel;
    statusDirect_->setToolTip(tr(
        "Direct light in the window comes from shadow maps: of a few points of each lamp (preview), and of many more "
        "when the picture rests (refined). `lightloom-cli render` traces it exactly."));
    statusFrame_ = new QLabel;
    statusSize_ = new QLabel;
    statusFrame_->setToolTip(tr("Time of the last picture. Coarse: drawn at lower resolution while the camera moves."));
    statusStage_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred); // it gives way first
    statusBar()->addWidget(statusStage_, 1);
    for (QLabel* label : {statusLux_, statusNoise_, statusDirect_, statusFrame_, statusSize_})
        statusBar()->addPermanentWidget(label);
    statusBar()->setSizeGripEnabled(false);
}

} // namespace lightloom
