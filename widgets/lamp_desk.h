// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/lamp_gizmo.h"
#include <QObject>
#include <QPointF>
#include <memory>
#include <optional>

class QAction;
class QMouseEvent;

namespace lightloom {

class Viewport;

/// Lamps in the picture, while the tool is on: marked, picked by a click, dragged by handles along axes, across the
/// line of sight, and turned where they have a direction. Tells every step of a drag and its end; whoever owns the
/// scene hands in what it made of it. Escape takes a drag back; other keys, buttons and the wheel do nothing during
/// one.
class LampDesk final : public QObject {
    Q_OBJECT
public:
    /// `tool`, checkable: lamps are shown and can be taken hold of.
    LampDesk(Viewport* viewport, QAction* tool, QObject* parent);

    void setScene(std::shared_ptr<const Scene> scene); ///< another one; nothing is chosen then
    void setLamps(std::shared_ptr<const Scene> scene); ///< an edit of the same
    void choose(int group);                            ///< a light group's first lamp; -1: none

    [[nodiscard]] int group() const { return group_; } ///< that is chosen, or -1
    [[nodiscard]] int light() const { return light_; } ///< chosen, index into Scene::lights; -1: none, or a surface
    [[nodiscard]] bool isDragging() const { return held_ != LampHandle::none; }
    /// Where the middle of a handle of the chosen lamp stands in the viewport.
    [[nodiscard]] std::optional<QPointF> placeOfHandle(LampHandle handle) const;
    /// Where a lamp is marked in the viewport.
    [[nodiscard]] std::optional<QPointF> placeOfLamp(int light) const;

Q_SIGNALS:
    void chosen(int group, int light);
    void dragged(int light, const lightloom::PunctualLight& now);
    /// The drag came to its end at what was told last; `before`: as it was when it began.
    void dropped(int light, const lightloom::PunctualLight& before);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override; ///< the viewport's mouse and keys

private:
    bool press(const QMouseEvent& event);
    bool move(const QMouseEvent& event);
    bool release(const QMouseEvent& event);
    void drop();
    void cancel();
    void take(int group, int light);
    void draw();
    [[nodiscard]] glm::vec3 anchor() const;
    [[nodiscard]] float sizeAt(glm::vec3 place) const; ///< of handles, so that they look alike at any distance
    [[nodiscard]] std::vector<HandleLine> handles() const;
    [[nodiscard]] double pixelsTo(QPointF position, const HandleLine& line) const;
    [[nodiscard]] LampHandle handleAt(QPointF position) const;
    [[nodiscard]] bool isWithin(QPointF position, const std::vector<HandleLine>& rim) const;
    [[nodiscard]] const PunctualLight& lamp() const { return scene_->lights[static_cast<std::size_t>(light_)]; }

    Viewport* viewport_;
    QAction* tool_;
    std::shared_ptr<const Scene> scene_;
    std::vector<std::vector<HandleLine>> outlines_; ///< of glowing surfaces, by light group
    int group_ = -1, light_ = -1;
    LampHandle held_ = LampHandle::none, near_ = LampHandle::none; ///< near: under the cursor
    std::optional<PunctualLight> before_;                          ///< the drag
    SightLine from_;
    glm::vec3 anchorThen_{0.0f};
    float sizeThen_ = 1.0f;
    QPointF pressed_;
    std::optional<QPointF> cursor_;
};

} // namespace lightloom
