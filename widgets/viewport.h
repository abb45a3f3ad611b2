// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/compare/cut_map.h"
#include "core/compare/view_error.h"
#include "widgets/bake_view.h"
#include "widgets/camera_control.h"
#include "widgets/frame_pacer.h"
#include "widgets/gl/renderer.h"
#include "widgets/sight_line.h"
#include <QElapsedTimer>
#include <QOpenGLWidget>
#include <QPointF>
#include <QSet>
#include <QTimer>

namespace lightloom {

/// The picture. Draws when something changed and not otherwise: at half resolution while the camera moves, at full
/// resolution when it rests, then a few more times through shifted pixels until edges are smooth. While a bake runs
/// (`setBusy`) polishing takes a small share of the time only. Never waits for a bake. Show one only where `probeGl()`
/// found OpenGL.
///
/// Left drag orbits, middle or shift-drag pans, the wheel zooms to the cursor, right drag looks around and W A S D (Q E
/// down, up) walks meanwhile, a double click sets the pivot.
class Viewport final : public QOpenGLWidget {
    Q_OBJECT
public:
    explicit Viewport(QWidget* parent = nullptr);
    ~Viewport() override;

    /// Null: empty. `keepCamera`: the same place in the file's frame, for a scene that was read again.
    void setScene(std::shared_ptr<const DrawData> drawn, bool keepCamera = false);
    /// The same scene with lamps elsewhere: direct light and shadows follow in the next picture.
    void setLamps(std::shared_ptr<const DrawData> drawn);
    void setLight(const BakeView& view);
    /// An object that is not part of the scene (Renderer::setGuest). Null: none. Goes with the scene.
    void setGuest(std::shared_ptr<const DrawData> guest, const glm::mat4& place);
    void setGuestPlace(const glm::mat4& place);
    void setBusy(bool busy); ///< a bake wants the processor
    void setMix(const Mix& mix);
    void setMode(ViewMode mode);
    /// The path-traced picture of what the camera sees now, shown in reference mode and by the wipe. Null: none (yet);
    /// the bake is shown meanwhile.
    void setReference(std::shared_ptr<const View> picture);
    /// The photon map's picture of what the camera sees now, for its mode. Null: none (yet); the octree is shown.
    void setMadePicture(std::shared_ptr<const View> picture);
    /// How far the light shown is off it. Null: not known (yet).
    void setErrors(std::shared_ptr<const ViewError> errors);
    /// The scene's atlas, for its mode. Null: none (yet); the octree is shown.
    void setAtlas(std::shared_ptr<const AtlasDraw> atlas);
    void setErrorsShown(bool shown); ///< in place of light, as false colour
    /// How many clusters the made picture took, pixel by pixel. Null: not known (yet).
    void setCuts(std::shared_ptr<const CutMap> cuts);
    void setCutsShown(bool shown); ///< likewise, over that picture
    /// Part of the width, from the left, that reference or errors take; nothing: all of it.
    void setWipe(std::optional<float> part);
    void setIndirectOnly(bool only);
    void setPicking(bool on);                   ///< the next click of the left button picks; Alt+click always does
    void setMarks(std::vector<Mark> marks);     ///< drawn over the picture
    void setLampMarks(std::vector<Mark> marks); ///< likewise, and apart from the others
    void setLineMarks(std::vector<Mark> marks); ///< likewise
    /// Where a point of the scene stands in the widget; nothing behind the eye.
    [[nodiscard]] std::optional<QPointF> placeIn(glm::vec3 p) const;
    [[nodiscard]] SightLine sightAt(QPointF position) const;
    [[nodiscard]] std::optional<Renderer::SurfaceSample> surfaceAt(QPointF position); ///< in the last picture
    void setExposure(float ev);
    void setTone(int tone);
    void setBackground(glm::vec3 shown);
    void useCamera(const Camera& camera);
    void frameScene();

    [[nodiscard]] const CameraControl& camera() const { return camera_; }
    [[nodiscard]] ViewMode mode() const { return mode_; }
    [[nodiscard]] bool isEmpty() const { return !data_; }
    [[nodiscard]] bool showsErrors() const { return errorsShown_; }
    [[nodiscard]] std::optional<float> wipe() const { return wipe_; }
    [[nodiscard]] glm::ivec2 pixels() const;                  ///< of the picture at full resolution
    [[nodiscard]] double frameMs() const { return frameMs_; } ///< of the last picture, until the GPU was done
    /// Nothing more will change by itself: full resolution, all shadow maps, smooth edges.
    [[nodiscard]] bool isSettled() const;
    /// And its direct light has become even, a lamp at a time, as far as there is some.
    [[nodiscard]] bool isRefined() const;
    [[nodiscard]] int shadowLayersDrawn() const { return renderer_ ? renderer_->shadowLayersDrawn() : 0; }
    [[nodiscard]] bool hasAtlas() const { return atlas_ != nullptr; }
    [[nodiscard]] bool hasMadePicture() const { return made_ != nullptr; }
    /// The picture is one that the processor made.
    [[nodiscard]] bool showsMade() const
    {
        return (mode_ == ViewMode::photonMap || mode_ == ViewMode::lightcuts) && made_;
    }
    [[nodiscard]] const FramePacer& pacer() const { return pacer_; }
    /// Share of the widget's resolution of the last picture.
    [[nodiscard]] float scale() const { return scale_; }

Q_SIGNALS:
    void frameDrawn(double ms, bool isFull);
    void settled();
    void refined();
    void viewMoved(); ///< camera or size are others: what was computed for the view before does not fit any more
    void hovered(bool isOnSurface, glm::vec3 position, glm::vec3 normal);
    void picked(glm::vec3 position, glm::vec3 normal); ///< a surface, scene space
    void exposureMetered(float ev);                    ///< once for a scene that names no exposure
    void problem(QString message);

protected:
    void initializeGL() override;
    void paintGL() override;
    void resizeGL(int width, int height) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseReleaseEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void mouseDoubleClickEvent(QMouseEvent* event) override;
    void wheelEvent(QWheelEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void keyReleaseEvent(QKeyEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;
    void enterEvent(QEnterEvent* event) override;
    void leaveEvent(QEvent* event) override;

private:
    void releaseGl();
    void applyPending();
    void moved();                                 ///< the camera did: coarse picture now, full one soon
    void changed();                               ///< anything else did, by the user
    void news();                                  ///< a bake brought something
    void coarseFor(int ms);                       ///< coarse pictures until nothing else has come for as long
    void drawAnew();                              ///< from the first sample
    void frameDone(double frameMs, double allMs); ///< what a picture sets going
    [[nodiscard]] Overlay overlay() const;        ///< that there is something to show for
    [[nodiscard]] FrameView frameNow() const;     ///< `frame_` with camera, mode and overlay
    [[nodiscard]] bool showsBake() const;         ///< its indirect light, in whatever way
    void uploadComparison();
    void overlayChanged(Overlay before); ///< what is laid over the picture, or that it is
    void showWhole(const QElapsedTimer& all);
    void shadeStep();  ///< the next rows of a picture that is drawn in parts, outside of paintGL
    void refineStep(); ///< for a frame's time, outside of pictures
    void present();    ///< the same picture again, with what is laid over it as it is now
    void walkStep();
    void hover();
    void meter();
    [[nodiscard]] glm::vec2 placeOf(QPointF position) const; ///< 0 to 1 from the lower left
    [[nodiscard]] glm::vec2 stepOf(QPointF delta) const;     ///< in heights, y upwards
    [[nodiscard]] float aspect() const;

    CameraControl camera_;
    FrameView frame_;
    std::unique_ptr<Renderer> renderer_;
    Gl* gl_ = nullptr;
    std::shared_ptr<const DrawData> data_;
    std::shared_ptr<const GpuOctree> octree_, colours_;
    std::shared_ptr<const GpuGrid> grid_; ///< the bake, where it is no octree
    std::shared_ptr<const GridVertices> vertices_;
    std::shared_ptr<const VoxelDiscs> discs_;
    std::shared_ptr<const DrawData> guest_;
    glm::mat4 guestPlace_{1.0f};
    bool guestIsNew_ = false;
    std::shared_ptr<const View> reference_, made_;
    std::shared_ptr<const AtlasDraw> atlas_;
    bool atlasIsNew_ = false, atlasReady_ = true; ///< ready: nothing of it is still to be rendered
    std::shared_ptr<const ViewError> errors_;
    std::shared_ptr<const CutMap> cuts_;
    ViewMode mode_ = ViewMode::octree;
    bool errorsShown_ = false, cutsShown_ = false, referenceIsNew_ = false, madeIsNew_ = false, mapIsNew_ = false,
         presentOnly_ = false;
    std::optional<float> wipe_;
    std::vector<Mark> marks_, lampMarks_, lineMarks_;
    bool isPicking_ = false, marksAreNew_ = false, lampsAreNew_ = false;
    Mix mix_;
    bool sceneIsNew_ = false, bakeIsNew_ = false, coloursAreNew_ = false, mixIsNew_ = false, needsMetering_ = false;
    bool isMoving_ = false, shadowsReady_ = false, mirrorsReady_ = false, toldSettled_ = false, isRefined_ = false;
    int sample_ = 0;                           ///< pictures averaged so far
    bool isShading_ = false, isWhole_ = false; ///< the next one is drawn in parts; it is drawn, and not shown yet
    double shadeMs_ = 0.0;                     ///< it took so far
    float scale_ = 1.0f;
    double frameMs_ = 0;
    FramePacer pacer_;
    QPointF last_, pressed_;
    QPointF hoverAt_; // on the screen: the viewport may move under a cursor that rests
    QSet<int> keys_;
    QElapsedTimer walkClock_;
    QTimer rest_, walk_, hover_, more_, shade_, refine_;
};

} // namespace lightloom
