// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/viewport.h"
#include <QOpenGLContext>
#include <QOpenGLVersionFunctionsFactory>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lightloom {

namespace {

constexpr int kSamples = 8;             ///< pictures that are averaged at rest
constexpr int kRestMs = 180;            ///< without motion until the full picture
constexpr double kShadowMs = 12.0;      ///< of a frame, for shadow maps
constexpr double kSliceMs = 40.0;       ///< of them at rest, where a picture takes as long
constexpr double kShadeMs = 30.0;       ///< of a full picture, between events
constexpr double kRefineMs = 15.0;      ///< of work between events, and never less than one lamp's
constexpr double kAllShadowsMs = 100.0; ///< of a frame after a lamp was moved: its six, and more only if others wait

} // namespace

Viewport::Viewport(QWidget* parent) : QOpenGLWidget(parent)
{
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setMinimumSize(160, 120);
    setAccessibleName(tr("Picture of the scene"));
    rest_.setSingleShot(true);
    connect(&rest_, &QTimer::timeout, this, [this] {
        isMoving_ = false;
        drawAnew();
    });
    walk_.setInterval(16);
    connect(&walk_, &QTimer::timeout, this, &Viewport::walkStep);
    hover_.setSingleShot(true);
    hover_.setInterval(60);
    connect(&hover_, &QTimer::timeout, this, &Viewport::hover);
    refine_.setSingleShot(true);
    refine_.setInterval(1); // events get their turn
    connect(&refine_, &QTimer::timeout, this, &Viewport::refineStep);
    more_.setSingleShot(true);
    connect(&more_, &QTimer::timeout, this, qOverload<>(&QWidget::update));
    shade_.setSingleShot(true);
    connect(&shade_, &QTimer::timeout, this, &Viewport::shadeStep);
    setUpdateBehavior(PartialUpdate); // what is shown stays while the next picture is drawn in parts
}

Viewport::~Viewport()
{
    // the context goes with the base class, and must then find nobody of ours to tell
    if (context()) disconnect(context(), &QOpenGLContext::aboutToBeDestroyed, this, &Viewport::releaseGl);
    releaseGl();
}

void Viewport::initializeGL()
{
    connect(context(), &QOpenGLContext::aboutToBeDestroyed, this, &Viewport::releaseGl, Qt::UniqueConnection);
    gl_ = QOpenGLVersionFunctionsFactory::get<Gl>(context());
    if (gl_ == nullptr || !gl_->initializeOpenGLFunctions()) {
        Q_EMIT problem(tr("This window got no OpenGL 3.3; a newer graphics driver may help."));
        return;
    }
    Result<std::unique_ptr<Renderer>> made = Renderer::make(*gl_);
    if (!made) {
        Q_EMIT problem(QString::fromStdString(made.error().message));
        return;
    }
    renderer_ = std::move(*made);
    guestIsNew_ = sceneIsNew_ = bakeIsNew_ = coloursAreNew_ = mixIsNew_ = marksAreNew_ = referenceIsNew_ = madeIsNew_ =
        mapIsNew_ = true; // what was set before there was a context
}

void Viewport::releaseGl()
{
    if (!renderer_) return;
    makeCurrent();
    renderer_.reset();
    doneCurrent();
}

void Viewport::setScene(std::shared_ptr<const DrawData> drawn, bool keepCamera)
{
    keepCamera = keepCamera && data_ && drawn;
    const glm::dvec3 moved = keepCamera ? data_->scene->origin - drawn->scene->origin : glm::dvec3(0.0);
    data_ = std::move(drawn);
    octree_.reset();
    grid_.reset();
    vertices_.reset();
    discs_.reset();
    guest_.reset();
    colours_.reset();
    reference_.reset();
    made_.reset();
    errors_.reset();
    cuts_.reset();
    mix_.clear();
    sceneIsNew_ = mixIsNew_ = true;
    bakeIsNew_ = coloursAreNew_ = false; // the renderer drops the old ones with the scene
    shadowsReady_ = mirrorsReady_ = false;
    if (keepCamera) {
        camera_.setBounds(data_->scene->bounds);
        camera_.shift(glm::vec3(moved));
    } else if (data_) {
        needsMetering_ = !data_->scene->exposureEv;
        const Scene& scene = *data_->scene;
        camera_ = CameraControl();
        camera_.setBounds(scene.bounds);
        if (scene.cameras.empty()) {
            camera_.frame(scene.bounds, aspect());
        } else {
            camera_.setFrom(scene.cameras.front(), scene.bounds);
        }
        if (scene.exposureEv) frame_.exposureEv = *scene.exposureEv;
    }
    pacer_.forget();
    news();
    Q_EMIT viewMoved();
}

void Viewport::setLamps(std::shared_ptr<const DrawData> drawn)
{
    data_ = std::move(drawn);
    lampsAreNew_ = true;
    shadowsReady_ = mirrorsReady_ = false;
    coarseFor(kRestMs);
}

void Viewport::setLight(const BakeView& view)
{
    octree_ = view.gpu;
    grid_ = view.gpuGrid;
    vertices_ = view.vertices;
    discs_ = view.discs;
    colours_ = view.gpuOfColours;
    bakeIsNew_ = coloursAreNew_ = true;
    news();
}

void Viewport::setGuest(std::shared_ptr<const DrawData> guest, const glm::mat4& place)
{
    guest_ = std::move(guest);
    guestPlace_ = place;
    guestIsNew_ = true;
    shadowsReady_ = false;
    changed();
}

void Viewport::setGuestPlace(const glm::mat4& place)
{
    guestPlace_ = place;
    shadowsReady_ = false;
    coarseFor(kRestMs); // it moves, as a camera does
}

void Viewport::setBusy(bool busy)
{
    if (busy == pacer_.isBusy()) return;
    pacer_.setBusy(busy);
    if (busy) return;
    if (more_.isActive()) more_.start(pacer_.pauseMs());
    if (shade_.isActive()) shade_.start(1);
    refine_.start();
    if (rest_.isActive()) rest_.start(std::min(rest_.remainingTime(), kRestMs));
}

void Viewport::setMix(const Mix& mix)
{
    mix_ = mix;
    mixIsNew_ = true;
    changed();
}

void Viewport::setMode(ViewMode mode)
{
    mode_ = mode;
    changed();
}

void Viewport::setAtlas(std::shared_ptr<const AtlasDraw> atlas)
{
    atlas_ = std::move(atlas);
    atlasIsNew_ = true;
    if (mode_ == ViewMode::atlas) changed();
}

void Viewport::setIndirectOnly(bool only)
{
    frame_.indirectOnly = only;
    referenceIsNew_ = madeIsNew_ = true; // of them too
    changed();
}

void Viewport::setPicking(bool on)
{
    isPicking_ = on;
    if (on) {
        setCursor(Qt::CrossCursor);
    } else {
        unsetCursor();
    }
}

void Viewport::setMarks(std::vector<Mark> marks)
{
    marks_ = std::move(marks);
    marksAreNew_ = true;
    present();
}

void Viewport::setLampMarks(std::vector<Mark> marks)
{
    if (marks.empty() && lampMarks_.empty()) return;
    lampMarks_ = std::move(marks);
    marksAreNew_ = true;
    present();
}

void Viewport::setLineMarks(std::vector<Mark> marks)
{
    if (marks.empty() && lineMarks_.empty()) return;
    lineMarks_ = std::move(marks);
    marksAreNew_ = true;
    present();
}

std::optional<QPointF> Viewport::placeIn(glm::vec3 p) const
{
    const glm::vec4 clip = camera_.projection(aspect()) * camera_.view() * glm::vec4(p, 1.0f);
    if (!(clip.w > 0.0f)) return std::nullopt;
    const glm::vec2 at(0.5f + 0.5f * clip.x / clip.w, 0.5f - 0.5f * clip.y / clip.w);
    return QPointF(static_cast<double>(at.x) * width(), static_cast<double>(at.y) * height());
}

SightLine Viewport::sightAt(QPointF position) const
{
    return {camera_.eye(), camera_.through(placeOf(position), aspect())};
}

void Viewport::setExposure(float ev)
{
    frame_.exposureEv = ev;
    needsMetering_ = false;
    changed();
}

void Viewport::setTone(int tone)
{
    frame_.tone = tone;
    changed();
}

void Viewport::setBackground(glm::vec3 shown)
{
    frame_.background = shown;
    changed();
}

void Viewport::useCamera(const Camera& camera)
{
    if (!data_) return;
    camera_.setFrom(camera, data_->scene->bounds);
    changed();
    Q_EMIT viewMoved();
}

void Viewport::frameScene()
{
    if (!data_) return;
    camera_.frame(data_->scene->bounds, aspect());
    changed();
    Q_EMIT viewMoved();
}

bool Viewport::isSettled() const
{
    const bool isLit = shadowsReady_ && mirrorsReady_ && atlasReady_;
    const bool isDrawn = !isMoving_ && scale_ == 1.0f && isLit && sample_ >= kSamples;
    return isDrawn && !sceneIsNew_ && !lampsAreNew_ && !bakeIsNew_ && !mixIsNew_ && !presentOnly_;
}

bool Viewport::isRefined() const
{
    return isSettled() && (isRefined_ || !renderer_ || !renderer_->mayRefine(frameNow()));
}

void Viewport::shadeStep()
{
    if (!renderer_ || !isShading_ || isWhole_ || !isVisible()) return; // paintGL goes on when it is visible again
    makeCurrent();
    QElapsedTimer clock;
    clock.start();
    isWhole_ = renderer_->shade(kShadeMs);
    doneCurrent();
    const double ms = static_cast<double>(clock.nsecsElapsed()) * 1e-6;
    shadeMs_ += ms;
    if (!isWhole_) return shade_.start(pacer_.pauseAfter(ms));
    update();
}

void Viewport::refineStep()
{
    if (!renderer_ || !isSettled() || isRefined_ || pacer_.isBusy() || !isVisible()) return;
    makeCurrent();
    const FrameView frame = frameNow();
    Renderer::Refined came = Renderer::Refined::part;
    QElapsedTimer clock;
    clock.start();
    while (came == Renderer::Refined::part && static_cast<double>(clock.nsecsElapsed()) * 1e-6 < kRefineMs) {
        came = renderer_->refine(frame);
        renderer_->finish();
    }
    doneCurrent();
    isRefined_ = came == Renderer::Refined::all;
    if (came == Renderer::Refined::part) return refine_.start();
    present(); // which goes on, if there is more
    if (isRefined_ && renderer_->mayRefine(frame)) Q_EMIT refined();
}

void Viewport::moved()
{
    coarseFor(kRestMs);
    Q_EMIT viewMoved();
}

void Viewport::changed()
{
    if (pacer_.isDear()) { // and a dragged slider would begin it anew without end
        coarseFor(kRestMs);
    } else {
        drawAnew();
    }
}

void Viewport::news()
{
    if (pacer_.showsNewsCoarse()) {
        coarseFor(std::max(kRestMs, pacer_.sharpenMs()));
    } else {
        drawAnew();
    }
}

void Viewport::coarseFor(int ms)
{
    isMoving_ = true;
    rest_.start(ms);
    drawAnew();
}

void Viewport::drawAnew()
{
    sample_ = 0;
    toldSettled_ = isRefined_ = isShading_ = isWhole_ = false;
    update();
}

float Viewport::aspect() const
{
    return static_cast<float>(std::max(width(), 1)) / static_cast<float>(std::max(height(), 1));
}

void Viewport::resizeGL(int, int) { moved(); } // a window being dragged larger moves too

void Viewport::applyPending()
{
    Result<Done> outcome = Done{};
    if (sceneIsNew_) outcome = renderer_->setScene(data_);
    if (guestIsNew_) renderer_->setGuest(guest_);
    renderer_->setGuestPlace(guestPlace_);
    guestIsNew_ = false;
    if (bakeIsNew_) {
        renderer_->vertices().setVertices(vertices_);
        renderer_->discs().setDiscs(discs_);
    }
    if (outcome && bakeIsNew_) outcome = grid_ ? renderer_->setGrid(grid_) : renderer_->setOctree(octree_);
    if (outcome && coloursAreNew_ && mode_ == ViewMode::colours) { // not before somebody looks
        outcome = renderer_->setColours(colours_);
        coloursAreNew_ = false;
    }
    if (outcome && atlasIsNew_ && mode_ == ViewMode::atlas) { // likewise
        outcome = renderer_->setAtlas(atlas_);
        atlasIsNew_ = false;
    }
    if (outcome && lampsAreNew_ && !sceneIsNew_) {
        outcome = renderer_->setLamps(*data_);
        (void)renderer_->drawShadows(kAllShadowsMs); // a lamp that is dragged drags its shadows along
    }
    if (mixIsNew_ || lampsAreNew_ || sceneIsNew_) renderer_->setMix(mix_);
    if (marksAreNew_) {
        std::vector<Mark> marks = lineMarks_; // the rest lies over them
        marks.insert(marks.end(), marks_.begin(), marks_.end());
        marks.insert(marks.end(), lampMarks_.begin(), lampMarks_.end());
        renderer_->marks().setMarks(std::move(marks));
    }
    marksAreNew_ = lampsAreNew_ = false;
    guestIsNew_ = sceneIsNew_ = bakeIsNew_ = mixIsNew_ = false;
    uploadComparison();
    if (!outcome) Q_EMIT problem(QString::fromStdString(outcome.error().message));
}

void Viewport::paintGL()
{
    if (!renderer_) return;
    QElapsedTimer all;
    all.start();
    applyPending();
    const glm::ivec2 window = pixels();
    // exposed again after being covered, say: nothing new is to be added
    const bool isAsked = std::exchange(presentOnly_, false) && sample_ > 0;
    if (isWhole_) return showWhole(all);
    if (isShading_ || isAsked || isSettled()) {
        if (!isShading_ || isAsked) renderer_->present(frameNow(), sample_, defaultFramebufferObject(), window);
        if (isShading_ && !shade_.isActive()) shade_.start(1);
        if (!isShading_ && !isSettled() && !isMoving_ && !more_.isActive()) more_.start(pacer_.pauseMs());
        if (isSettled() && !isRefined_) refine_.start();
        return;
    }
    const bool before = shadowsReady_ && mirrorsReady_ && atlasReady_;
    // at rest as long as a picture takes: each slice of them is followed by one
    const double slice = isMoving_ ? 0.5 * kShadowMs : std::clamp(frameMs_, kShadowMs, kSliceMs);
    shadowsReady_ = renderer_->drawShadows(slice);
    mirrorsReady_ = shadowsReady_ && (!showsBake() || renderer_->drawEnvironments(slice));
    atlasReady_ = mode_ != ViewMode::atlas || renderer_->renderAtlas(slice);
    if (!before) sample_ = 0; // lit differently than the pictures averaged so far
    // the next slice will replace it
    const bool isPassing = !(shadowsReady_ && mirrorsReady_ && atlasReady_) && pacer_.isDear();
    const bool isCoarse = isMoving_ || isPassing;
    scale_ = isCoarse ? pacer_.coarseScale() : 1.0f;
    FrameView frame = frameNow();
    frame.willRefine = !isMoving_ && scale_ == 1.0f;
    QElapsedTimer clock;
    clock.start();
    const Result<Done> begun =
        renderer_->begin(frame, std::min(sample_, kSamples - 1), glm::ivec2(glm::vec2(window) * scale_));
    if (!begun) {
        Q_EMIT problem(QString::fromStdString(begun.error().message));
        return;
    }
    isShading_ = true;
    isWhole_ = renderer_->shade(isCoarse ? std::numeric_limits<double>::infinity() : kShadeMs);
    renderer_->finish();
    shadeMs_ = static_cast<double>(clock.nsecsElapsed()) * 1e-6;
    if (isWhole_) return showWhole(all);
    shade_.start(pacer_.pauseAfter(shadeMs_));
}

/// The picture that has become whole; `all`: since this turn began.
void Viewport::showWhole(const QElapsedTimer& all)
{
    QElapsedTimer clock;
    clock.start();
    renderer_->present(frameNow(), sample_ + 1, defaultFramebufferObject(), pixels());
    renderer_->finish();
    isShading_ = isWhole_ = false;
    frameDone(shadeMs_ + static_cast<double>(clock.nsecsElapsed()) * 1e-6,
              static_cast<double>(all.nsecsElapsed()) * 1e-6);
}

bool Viewport::showsBake() const
{
    return mode_ == ViewMode::octree || mode_ == ViewMode::grid || mode_ == ViewMode::atlas ||
           mode_ == ViewMode::colours || mode_ == ViewMode::photonMap || mode_ == ViewMode::lightcuts;
}

void Viewport::frameDone(double frameMs, double allMs)
{
    frameMs_ = frameMs;
    pacer_.drew(scale_, isMoving_ || scale_ < 1.0f, frameMs, allMs);
    if (needsMetering_ && (octree_ || grid_) && showsBake() && !showsMade() && overlay() == Overlay::none) meter();
    ++sample_;
    const bool isFull = !isMoving_ && scale_ == 1.0f;
    if (isFull && sample_ == 1 && underMouse()) hover_.start(); // something else may be under a cursor that rests
    Q_EMIT frameDrawn(frameMs_, isFull);
    if (!data_) return;
    if (!isMoving_ && (sample_ < kSamples || !shadowsReady_ || !mirrorsReady_ || !atlasReady_)) {
        more_.start(pacer_.pauseMs());
    } else if (isSettled() && !toldSettled_) {
        toldSettled_ = true;
        refine_.start();
        Q_EMIT settled();
    }
}

void Viewport::meter()
{
    const std::optional<float> mean = renderer_->meanLogLuminance();
    if (!mean) return;
    needsMetering_ = false;
    // reflected light meter, ISO 2720 with K = 12.5 at ISO 100: mean luminance = 2^EV K / 100
    frame_.exposureEv = std::round(2.0f * (*mean + 3.0f)) * 0.5f;
    Q_EMIT exposureMetered(frame_.exposureEv);
    changed();
}

std::optional<Renderer::SurfaceSample> Viewport::surfaceAt(QPointF position)
{
    if (!renderer_ || !data_) return std::nullopt;
    makeCurrent();
    const auto found = renderer_->surfaceAt(placeOf(position));
    doneCurrent();
    return found;
}

void Viewport::hover()
{
    const auto found = surfaceAt(mapFromGlobal(hoverAt_));
    const Renderer::SurfaceSample none{glm::vec3(0.0f), glm::vec3(0.0f)};
    Q_EMIT hovered(found.has_value(), found.value_or(none).position, found.value_or(none).normal);
}

} // namespace lightloom
