// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/params/bake_params.h"
#include "widgets/bake_view.h"
#include "widgets/gl/draw_data.h"
#include "widgets/theme.h"
#include <QElapsedTimer>
#include <QList>
#include <QMainWindow>
#include <QThreadPool>
#include <QTimer>
#include <optional>

class QAction;
class QActionGroup;
class QDoubleSpinBox;
class QLabel;
class QMenu;
class QSettings;
class QStackedWidget;
class QToolBar;
class QUndoStack;

namespace lightloom {

class AtlasDesk;
class BakeBridge;
class BakePanel;
class CompareDesk;
class ComparePanel;
class ExportDialog;
class GuestDesk;
class LampDesk;
class LegendStrip;
class MessageBar;
class ParamPanel;
class PictureDesk;
class PickDesk;
class SceneDock;
class SceneLoader;
class SnapshotBar;
class StartPage;
class SweepPanel;
class ViewWorker;
class Viewport;
class VoxelPanel;
struct LampSetting;
struct ExportOrder;
struct Progress;
struct WorkCounters;
enum class ErrorKind;
enum class ViewMode;

/// The window: scene dock, picture, bake dock, and who tells whom. A bake starts by itself when a scene opens and
/// after every edit. Reading files, baking, mixing and measuring happen on workers; nothing here waits for them.
class MainWindow final : public QMainWindow {
    Q_OBJECT
public:
    /// `settings` (may be null: nothing is remembered) must outlive the window.
    explicit MainWindow(QSettings* settings);
    ~MainWindow() override;

    void openScene(const QString& file);      ///< asks first where lamps were edited and not saved
    void saveSceneAs(const QString& file);    ///< with its lamps as they are now; `.glb`
    void setParams(const BakeParams& params); ///< as if edited in the panel
    /// Looks at bakes of another method, as by its command. False: none of the window's.
    bool showMethod(Method method);

    // for whoever drives the window: the screenshot of the program, and tests
    [[nodiscard]] Viewport* viewport() const { return viewport_; } ///< null without OpenGL
    [[nodiscard]] SceneDock& sceneDock() const { return *sceneDock_; }
    [[nodiscard]] SnapshotBar& snapshots() const { return *snapshots_; }
    [[nodiscard]] BakePanel& bakePanel() const { return *bakePanel_; }
    [[nodiscard]] CompareDesk* compareDesk() const { return compareDesk_; } ///< null without OpenGL
    [[nodiscard]] PictureDesk* pictureDesk() const { return pictureDesk_; } ///< likewise
    [[nodiscard]] PickDesk* pickDesk() const { return pickDesk_; }          ///< likewise
    [[nodiscard]] LampDesk* lampDesk() const { return lampDesk_; }          ///< likewise
    [[nodiscard]] GuestDesk* guestDesk() const { return guestDesk_; }       ///< likewise
    [[nodiscard]] ComparePanel& comparePanel() const { return *comparePanel_; }
    [[nodiscard]] SweepPanel& sweepPanel() const { return *sweepPanel_; }
    [[nodiscard]] LegendStrip& legend() const { return *legend_; }
    [[nodiscard]] ExportDialog& exportDialog() const { return *exportDialog_; }
    [[nodiscard]] MessageBar& messages() const { return *messages_; }
    [[nodiscard]] std::shared_ptr<const Scene> scene() const { return data_ ? data_->scene : nullptr; }
    [[nodiscard]] bool isBaking() const { return isBaking_; }
    [[nodiscard]] bool isPaused() const;

Q_SIGNALS:
    void sceneOpened();
    void openFailed();
    void lightShown(bool isFinal);
    void bakeEnded(bool isComplete);

protected:
    void dragEnterEvent(QDragEnterEvent* event) override;
    void dragLeaveEvent(QDragLeaveEvent* event) override;
    void dropEvent(QDropEvent* event) override;
    void closeEvent(QCloseEvent* event) override;

private:
    // main_window.cpp: what happens
    void connectWorkers();
    void sceneRead(const std::shared_ptr<const DrawData>& opened, const QString& file);
    void setScene(std::shared_ptr<const DrawData> opened, const QString& file);
    void showNotes();
    void startBake(bool urgent);
    void tellBusy(); ///< whether a bake runs, to those that give way to it
    void paramsEdited(const BakeParams& params);
    void useParams();
    void useMethod(Method method); ///< bakes with it, if it is another
    void showGridLook();           ///< `look_` on the commands that change it
    void showVoxelLook();          ///< `params_` likewise
    void useVoxelShow();           ///< of `params_`
    void lampEdited(int lamp, bool isDimmed);
    void useMix();
    void lookChanged(); ///< `look_` is another
    void showView(const BakeView& view);
    void setMode(ViewMode mode);
    void judgeView();                                    ///< hands the light that is shown to those who compare it
    [[nodiscard]] BakeView asShown(BakeView view) const; ///< its field as the mode shows it
    void takeView(const BakeView& view);
    void bakeFinished(quint64 serial, const QString& error, bool isCancelled, const WorkCounters& counters);
    void measure(); ///< the light under the cursor, as it is shown now
    void showMeasurement(const Measurement& measurement);
    void chooseFile();
    void showExport();
    [[nodiscard]] std::optional<ExportOrder> exportOrder() const; ///< of the light that is shown
    void showFrame();
    // main_window_layout.cpp: what it looks like
    void buildCentre();
    void buildDocks();
    void buildStatus();
    void buildToolbar();
    void showDocks();
    void putDocksBack(); ///< as they are at first
    void sizeDocks();
    // main_window_menus.cpp: commands
    void makeActions();
    void connectActions();
    void buildMenus();
    void showShortcuts();
    QAction* makeAction(const QString& text, const QKeySequence& keys, const QString& tip);
    QAction* addModeAction(const QString& text, const QKeySequence& keys, ViewMode mode, const QString& tip);
    QWidget* makeModeButton(); ///< one for all that show a bake
    QWidget* makeToneButton();
    void addToneAction(const QString& text, const QString& brief, const QString& tip, int tone);
    // main_window_grid.cpp: ways to look at irradiance grids
    void makeGridActions();
    void makeVoxelActions();
    void useFilter(GridFilter filter);
    void useForm(GridRemap remap, GridPacking packing);
    void markVertices(VertexMarks marks);
    [[nodiscard]] QString vertexNote() const; ///< what their colours mean
    void tellMarks();                         ///< the same of whatever marks the picture
    void addGridMenu(QMenu& view);
    void addVoxelMenu(QMenu& view);
    void makeGuestActions();
    void connectGuests();
    void guestAdded(const QString& name);
    void chooseGuestFile();
    // main_window_compare.cpp: what the picture is held against
    void makeCompareActions();
    void addShownAction(const QString& text, const QKeySequence& keys, const QString& tip,
                        std::optional<ErrorKind> kind);
    QWidget* makeComparePanel();
    QWidget* makeSweepPanel();
    QWidget* makeShownButton();
    void showCuts(bool on);
    void showErrors(std::optional<ErrorKind> kind); ///< nothing: light
    void mayShowCuts();                             ///< or not, as the picture is made
    void connectCompare();
    // main_window_lamps.cpp: lamps that are moved
    void connectLamps();
    void lampChosen(int group, int light);
    void useLamp(int light, const PunctualLight& lamp);
    void keepLamp(int light, const PunctualLight& before, const QString& text, int merge);
    void forgetLampEdits(); ///< another scene
    void saveScene();
    void sceneSaved(const QString& file, const std::shared_ptr<const Scene>& scene, const QString& problem);
    [[nodiscard]] bool mayDropEdits();
    [[nodiscard]] bool mayDropLaterEdits(); ///< those since a scene was asked for that has been read now
    // main_window_memory.cpp: what it remembers
    void setTheme(Theme theme);
    void restore();
    void remember();
    void rememberFile(const QString& file);
    void fillRecent();

    QSettings* settings_;
    std::shared_ptr<const DrawData> data_;
    QString file_;     ///< of the scene that is open
    QByteArray docks_; ///< places of docks, to be taken when there is a scene
    QUndoStack* undoStack_;
    std::vector<LampSetting> lamps_;         ///< as the newest step on the undo stack has them
    BakeParams params_;                      ///< likewise
    std::vector<PunctualLight> savedLights_; ///< as the file has them
    std::vector<PunctualLight> givenUp_;     ///< as they were when another scene was asked for
    int chosenGroup_ = -1, chosenLight_ = -1;
    QThreadPool savePool_;
    Mix bakedMix_; ///< of the newest job: groups that are off in it have no layer
    Look look_;
    Method method_ = Method::lightOctree; ///< of bakes
    std::uint64_t jobSerial_ = 0;
    std::uint64_t sceneSerial_ = 0;          ///< the scene's first job
    std::optional<std::uint64_t> rowSerial_; ///< job whose snapshots stand in the row
    bool isBaking_ = false;
    BakeParams bakedParams_;
    QTimer editDelay_, lampDelay_, frameTold_;
    QElapsedTimer toldClock_; ///< since progress was shown
    struct Place {
        glm::vec3 position, normal;
    };
    std::optional<Place> cursor_; ///< on what surface it is

    SceneLoader* loader_;
    BakeBridge* bridge_;
    ViewWorker* worker_;
    Viewport* viewport_ = nullptr;
    QStackedWidget* pages_ = nullptr;
    StartPage* startPage_ = nullptr;
    QToolBar* tools_ = nullptr;
    QWidget* workPage_ = nullptr;
    MessageBar* messages_ = nullptr;
    SceneDock* sceneDock_ = nullptr;
    ParamPanel* paramPanel_ = nullptr;
    BakePanel* bakePanel_ = nullptr;
    SnapshotBar* snapshots_ = nullptr;
    CompareDesk* compareDesk_ = nullptr;
    PictureDesk* pictureDesk_ = nullptr;
    AtlasDesk* atlasDesk_ = nullptr;
    PickDesk* pickDesk_ = nullptr;
    LampDesk* lampDesk_ = nullptr;
    GuestDesk* guestDesk_ = nullptr;
    ComparePanel* comparePanel_ = nullptr;
    LegendStrip* legend_ = nullptr;
    SweepPanel* sweepPanel_ = nullptr;
    VoxelPanel* voxelPanel_ = nullptr;
    ExportDialog* exportDialog_ = nullptr;
    QDoubleSpinBox* exposure_ = nullptr;
    QLabel *statusStage_ = nullptr, *statusLux_ = nullptr, *statusFrame_ = nullptr, *statusSize_ = nullptr,
           *statusNoise_ = nullptr, *statusDirect_ = nullptr;
    QMenu *recent_ = nullptr, *cameraMenu_ = nullptr, *panels_ = nullptr;
    QAction *open_ = nullptr, *reload_ = nullptr, *quit_ = nullptr, *frame_ = nullptr, *indirect_ = nullptr,
            *brighter_ = nullptr, *darker_ = nullptr, *lightTheme_ = nullptr, *start_ = nullptr, *pause_ = nullptr,
            *cancel_ = nullptr, *resetParams_ = nullptr, *shortcuts_ = nullptr, *about_ = nullptr, *undo_ = nullptr,
            *redo_ = nullptr, *swapModes_ = nullptr, *lastMode_ = nullptr, *reference_ = nullptr, *wipe_ = nullptr,
            *pick_ = nullptr, *swapFilters_ = nullptr, *nextVertices_ = nullptr, *export_ = nullptr,
            *lampTool_ = nullptr, *saveScene_ = nullptr, *cuts_ = nullptr;
    QActionGroup *modes_ = nullptr, *shown_ = nullptr, *tones_ = nullptr, *filters_ = nullptr, *forms_ = nullptr,
                 *vertices_ = nullptr, *lookups_ = nullptr, *voxelMarks_ = nullptr;
    QList<QAction*> addGuests_; ///< one for each kind of object, and for files
    QAction* removeGuest_ = nullptr;
    QList<QAction*> bakeModes_; ///< those of `modes_` that show a bake
};

} // namespace lightloom
