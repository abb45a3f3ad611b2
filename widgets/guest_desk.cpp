// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/guest_desk.h"
#include "core/scene/gltf_reader.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "widgets/background.h"
#include "widgets/viewport.h"
#include <QFile>
#include <QFileInfo>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <utility>

namespace lightloom {

namespace {

constexpr float kSizeShare = 0.125f;                    ///< of the scene's diagonal
constexpr float kLeastShare = 0.01f, kMostShare = 0.5f; ///< beyond, a file's own size is none for this scene
constexpr float kAheadShare = 0.5f;                     ///< of the way to what the picture's middle shows
constexpr float kLevel = 0.2f;                          ///< slope of sight below which level planes run away
constexpr float kTurnStep = 0.2617994f;                 ///< 15 degrees
const glm::vec3 kUp(0.0f, 1.0f, 0.0f);

/// How far along a line of sight the box begins; 0 from inside, or where it is missed.
float wayInto(const Bounds& box, const SightLine& sight)
{
    float enter = 0.0f, leave = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const float along = sight.along[axis], low = box.low[axis] - sight.eye[axis],
                    high = box.high[axis] - sight.eye[axis];
        if (along == 0.0f) continue; // beside it or not: the other axes say enough
        enter = std::max(enter, std::min(low / along, high / along));
        leave = std::min(leave, std::max(low / along, high / along));
    }
    return enter < leave ? enter : 0.0f;
}

/// One node of a scene, as a scene.
Scene onlyNode(Scene scene, std::string_view node)
{
    std::erase_if(scene.instances, [&](const Instance& i) { return i.node != node; });
    scene.lights.clear();
    scene.cameras.clear();
    finishScene(scene, {});
    return scene;
}

Scene builtIn(GuestKind kind)
{
    SceneBuilder builder("guest");
    const int plaster = builder.addMaterial("plaster", {0.76f, 0.74f, 0.70f});
    switch (kind) {
    case GuestKind::ball:
        builder.add("Ball", sphereMesh(glm::vec3(0.0f), 0.5f, 48), plaster);
        break;
    case GuestKind::ring:
        builder.add("Ring",
                    torusMesh(glm::vec3(0.0f), glm::normalize(glm::vec3(0.0f, 0.4f, 1.0f)), 0.36f, 0.14f, 96, 40),
                    plaster);
        break;
    case GuestKind::figure:
        return onlyNode(std::move(*figureScene()), "Figure");
    }
    return builder.finish();
}

QString nameOf(GuestKind kind)
{
    switch (kind) {
    case GuestKind::ball:
        return GuestDesk::tr("Ball");
    case GuestKind::ring:
        return GuestDesk::tr("Ring");
    case GuestKind::figure:
        break;
    }
    return GuestDesk::tr("Figure");
}

} // namespace

GuestDesk::GuestDesk(Viewport* viewport, QObject* parent) : QObject(parent), viewport_(viewport)
{
    pool_.setMaxThreadCount(1);
    viewport_->installEventFilter(this);
}

GuestDesk::~GuestDesk()
{
    pool_.clear();
    pool_.waitForDone();
}

void GuestDesk::add(GuestKind kind)
{
    start(nameOf(kind), false,
          [kind]() -> Result<std::shared_ptr<const Scene>> { return std::make_shared<const Scene>(builtIn(kind)); });
}

void GuestDesk::addFile(const QString& file)
{
    const std::filesystem::path path(QFile::encodeName(file).toStdString());
    start(QFileInfo(file).completeBaseName(), true, [path] { return readScene(path); });
}

void GuestDesk::start(const QString& name, bool keepsSize, Make make)
{
    const quint64 serial = ++serial_;
    pool_.clear(); // what waits is older than this
    pool_.start([this, name, keepsSize, make = std::move(make), serial] {
        lowerPriority(kCompareNice);
        const Result<std::shared_ptr<const Scene>> scene = make();
        QString problem = scene ? QString() : QString::fromStdString(scene.error().message);
        const bool isEmpty = scene && (*scene)->instances.empty();
        if (isEmpty) problem = tr("%1 has no surface to be lit").arg(name);
        const auto data = problem.isEmpty() ? makeDrawData(*scene) : nullptr;
        QMetaObject::invokeMethod(
            this,
            [this, name, keepsSize, data, problem, serial] {
                if (serial != serial_) return;
                if (data) {
                    take(data, name, keepsSize);
                } else {
                    Q_EMIT failed(problem);
                }
            },
            Qt::QueuedConnection);
    });
}

void GuestDesk::take(std::shared_ptr<const DrawData> data, const QString& name, bool keepsSize)
{
    const float side = data->scene->bounds.longestSide(), diagonal = bounds_.diagonal();
    if (!(side > 0.0f)) {
        Q_EMIT failed(tr("%1 has no extent").arg(name));
        return;
    }
    const bool fits = side >= kLeastShare * diagonal && side <= kMostShare * diagonal;
    const QPointF middle(0.5 * viewport_->width(), 0.5 * viewport_->height());
    const auto seen = viewport_->surfaceAt(middle);
    const SightLine sight = viewport_->sightAt(middle);
    const float end = seen ? glm::length(seen->position - sight.eye) : viewport_->camera().distance();
    const float begin = std::min(wayInto(bounds_, sight), end); // the eye may stand outside
    const Guest before = guest_;
    const float scale = keepsSize && fits ? 1.0f : kSizeShare * diagonal / side;
    restore({std::move(data), sight.eye + glm::mix(begin, end, kAheadShare) * sight.along, scale, 0.0f});
    Q_EMIT added(name);
    Q_EMIT edited(tr("adding an object"), before, false);
}

void GuestDesk::remove()
{
    ++serial_; // nor what is being read
    if (!hasGuest()) return;
    const Guest before = held_ ? held_->before : guest_;
    restore({});
    Q_EMIT edited(tr("removing the object"), before, false);
}

void GuestDesk::restore(const Guest& guest)
{
    held_.reset();
    const bool isOther = guest.data != guest_.data;
    guest_ = guest;
    if (!isOther) {
        viewport_->setGuestPlace(place());
        return;
    }
    viewport_->setGuest(guest_.data, place());
    Q_EMIT present(hasGuest());
}

void GuestDesk::sceneChanged(const Bounds& bounds)
{
    bounds_ = bounds;
    ++serial_;
    restore({});
}

glm::mat4 GuestDesk::place() const
{
    if (!hasGuest()) return glm::mat4(1.0f);
    glm::mat4 m = glm::translate(glm::mat4(1.0f), guest_.position);
    m = glm::rotate(m, guest_.turn, kUp);
    m = glm::scale(m, glm::vec3(guest_.scale));
    return glm::translate(m, -guest_.data->scene->bounds.centre());
}

void GuestDesk::put(glm::vec3 position)
{
    // a part of the scene's extent around it is far enough for anything
    const glm::vec3 margin(0.5f * bounds_.diagonal());
    guest_.position = glm::clamp(position, bounds_.low - margin, bounds_.high + margin);
    viewport_->setGuestPlace(place());
}

void GuestDesk::letGo()
{
    const Guest before = std::exchange(held_, std::nullopt)->before;
    if (!(before == guest_)) Q_EMIT edited(tr("moving the object"), before, false);
}

bool GuestDesk::press(const QMouseEvent& event)
{
    const bool isUpright = event.modifiers() == Qt::ShiftModifier;
    if (event.button() != Qt::LeftButton || !(isUpright || event.modifiers() == Qt::NoModifier)) return false;
    const auto seen = viewport_->surfaceAt(event.position());
    if (!seen || !seen->isGuest) return false; // the camera's
    held_ = Hold{seen->position, guest_, viewport_->sightAt(event.position()), isUpright};
    return true;
}

bool GuestDesk::move(const QMouseEvent& event)
{
    if (!held_) return false;
    if (!event.buttons().testFlag(Qt::LeftButton)) { // let go where nobody told us
        letGo();
        return false;
    }
    const SightLine to = viewport_->sightAt(event.position());
    if (held_->isUpright) {
        const auto a = alongAxis(held_->grip, kUp, held_->from), b = alongAxis(held_->grip, kUp, to);
        if (a && b) put(held_->before.position + kUp * (*b - *a));
        return true;
    }
    const bool isLevel = std::abs(held_->from.along.y) > kLevel;
    const glm::vec3 n = isLevel ? kUp : -held_->from.along;
    const auto a = onPlane(held_->grip, n, held_->from), b = onPlane(held_->grip, n, to);
    if (a && b) put(held_->before.position + (*b - *a));
    return true;
}

bool GuestDesk::turn(const QWheelEvent& event)
{
    const auto seen = viewport_->surfaceAt(event.position());
    if (!held_ && !(seen && seen->isGuest)) return false;
    const Guest before = guest_;
    guest_.turn =
        std::remainder(guest_.turn + kTurnStep * static_cast<float>(event.angleDelta().y()) / 120.0f, 6.2831853f);
    viewport_->setGuestPlace(place());
    if (!held_) Q_EMIT edited(tr("turning the object"), before, true); // else the drag's step has it
    return true;
}

bool GuestDesk::eventFilter(QObject* watched, QEvent* event)
{
    if (watched != viewport_ || !hasGuest()) return false;
    switch (event->type()) {
    case QEvent::MouseButtonPress:
    case QEvent::MouseButtonDblClick:
        return press(*static_cast<QMouseEvent*>(event));
    case QEvent::MouseMove:
        return move(*static_cast<QMouseEvent*>(event));
    case QEvent::MouseButtonRelease:
        if (!held_ || static_cast<QMouseEvent*>(event)->button() != Qt::LeftButton) return false;
        letGo();
        return true;
    case QEvent::Wheel:
        return turn(*static_cast<QWheelEvent*>(event));
    case QEvent::ShortcutOverride:
    case QEvent::KeyPress:
        if (!held_) return false;
        event->accept(); // nothing else in the middle of a drag
        if (event->type() == QEvent::KeyPress && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape)
            restore(Guest(held_->before)); // a copy: it lets go
        return true;
    default:
        return false;
    }
}

} // namespace lightloom
