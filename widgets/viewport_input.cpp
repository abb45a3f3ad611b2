// SPDX-License-Identifier: GPL-3.0-or-later
// Mouse and keys of the viewport: they move the camera, and pick.
#include "widgets/viewport.h"
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>

namespace lightloom {

namespace {
constexpr double kClickPixels = 4.0;
}

glm::vec2 Viewport::placeOf(QPointF position) const
{
    return {static_cast<float>(position.x() / std::max(width(), 1)),
            1.0f - static_cast<float>(position.y() / std::max(height(), 1))};
}

glm::vec2 Viewport::stepOf(QPointF delta) const
{
    const float height_ = static_cast<float>(std::max(height(), 1));
    return {static_cast<float>(delta.x()) / height_, -static_cast<float>(delta.y()) / height_};
}

void Viewport::mousePressEvent(QMouseEvent* event)
{
    last_ = event->position();
    pressed_ = last_;
    if (event->button() == Qt::RightButton) {
        setCursor(Qt::BlankCursor);
        walkClock_.start();
        walk_.start();
    }
    event->accept();
}

void Viewport::mouseReleaseEvent(QMouseEvent* event)
{
    const bool mayPick = isPicking_ || event->modifiers().testFlag(Qt::AltModifier);
    const bool isClick = (event->position() - pressed_).manhattanLength() < kClickPixels; // else the camera was moved
    if (event->button() == Qt::LeftButton && mayPick && isClick) {
        if (const auto surface = surfaceAt(event->position())) Q_EMIT picked(surface->position, surface->normal);
    }
    if (event->button() == Qt::RightButton) {
        setPicking(isPicking_); // its cursor
        walk_.stop();
    }
    event->accept();
}

void Viewport::mouseMoveEvent(QMouseEvent* event)
{
    const QPointF delta = event->position() - last_;
    last_ = event->position();
    hoverAt_ = event->globalPosition();
    const Qt::MouseButtons buttons = event->buttons();
    if (buttons == Qt::NoButton) {
        if (!hover_.isActive()) hover_.start();
        return;
    }
    if (!data_) return;
    if (buttons.testFlag(Qt::RightButton)) {
        camera_.look(stepOf(delta));
    } else if (buttons.testFlag(Qt::MiddleButton) || event->modifiers().testFlag(Qt::ShiftModifier)) {
        camera_.pan(stepOf(delta));
    } else {
        camera_.orbit(stepOf(delta));
    }
    moved();
}

void Viewport::mouseDoubleClickEvent(QMouseEvent* event)
{
    if (event->button() != Qt::LeftButton) return;
    if (const auto surface = surfaceAt(event->position())) {
        camera_.setPivot(surface->position);
        moved();
    }
}

void Viewport::wheelEvent(QWheelEvent* event)
{
    if (!data_) return;
    const float steps = static_cast<float>(event->angleDelta().y()) / 120.0f;
    const auto surface = surfaceAt(event->position());
    const glm::vec3 ahead = camera_.eye() + camera_.through(placeOf(event->position()), aspect()) * camera_.distance();
    camera_.zoom(steps, surface ? surface->position : ahead);
    moved();
    event->accept();
}

void Viewport::keyPressEvent(QKeyEvent* event)
{
    if (walk_.isActive() && !event->isAutoRepeat()) {
        keys_.insert(event->key());
    } else {
        QOpenGLWidget::keyPressEvent(event);
    }
}

void Viewport::keyReleaseEvent(QKeyEvent* event)
{
    if (!event->isAutoRepeat()) keys_.remove(event->key());
}

void Viewport::focusOutEvent(QFocusEvent* event)
{
    keys_.clear(); // their release goes elsewhere
    walk_.stop();
    setPicking(isPicking_); // its cursor
    QOpenGLWidget::focusOutEvent(event);
}

void Viewport::enterEvent(QEnterEvent* event)
{
    hoverAt_ = event->globalPosition(); // what lay over the viewport may have gone, and no move comes
    hover_.start();
    QOpenGLWidget::enterEvent(event);
}

void Viewport::leaveEvent(QEvent* event)
{
    hover_.stop();
    Q_EMIT hovered(false, glm::vec3(0.0f), glm::vec3(0.0f));
    QOpenGLWidget::leaveEvent(event);
}

void Viewport::walkStep()
{
    const float seconds = std::min(static_cast<float>(walkClock_.restart()) * 1e-3f, 0.2f);
    if (!data_) return;
    const auto axis = [this](int more, int less) {
        return (keys_.contains(more) ? 1.0f : 0.0f) - (keys_.contains(less) ? 1.0f : 0.0f);
    };
    const glm::vec3 step(axis(Qt::Key_D, Qt::Key_A), axis(Qt::Key_E, Qt::Key_Q), axis(Qt::Key_W, Qt::Key_S));
    if (step == glm::vec3(0.0f)) return;
    // across the scene in five seconds, whatever its size; shift runs
    const float pace = data_->scene->bounds.diagonal() / 5.0f * (keys_.contains(Qt::Key_Shift) ? 3.0f : 1.0f);
    camera_.walk(step * (pace * seconds));
    moved();
}

} // namespace lightloom
