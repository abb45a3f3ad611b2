// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/base/result.h"
#include "widgets/gl/draw_data.h"
#include "widgets/sight_line.h"
#include <QObject>
#include <QPointF>
#include <QString>
#include <QThreadPool>
#include <functional>
#include <optional>

class QMouseEvent;
class QWheelEvent;

namespace lightloom {

class Viewport;

/// Objects that come with the program.
enum class GuestKind { ball, ring, figure };

/// An object and where it stands, as an undo step holds it.
struct Guest {
    std::shared_ptr<const DrawData> data; ///< null: there is none
    glm::vec3 position{0.0f};             ///< of its middle, scene space
    float scale = 1.0f, turn = 0.0f;      ///< turn: radians about the vertical
    bool operator==(const Guest&) const = default;
};

/// An object in the picture that was not in the bake, dragged through the light: level with the floor, with Shift up
/// and down; the wheel over it turns it. Made and read on a thread of its own; the newest request wins. Escape takes a
/// drag back.
class GuestDesk final : public QObject {
    Q_OBJECT
public:
    GuestDesk(Viewport* viewport, QObject* parent);
    ~GuestDesk() override; ///< waits for what is being read

    void add(GuestKind kind);          ///< an eighth of the scene's diagonal high
    void addFile(const QString& file); ///< as large as it is, or an eighth if that is out of all proportion
    void remove();
    void restore(const Guest& guest);        ///< as it was: no step for undo
    void sceneChanged(const Bounds& bounds); ///< another scene: the object goes

    [[nodiscard]] bool hasGuest() const { return guest_.data != nullptr; }
    [[nodiscard]] const Guest& guest() const { return guest_; }
    [[nodiscard]] bool isDragging() const { return held_.has_value(); }
    [[nodiscard]] glm::vec3 position() const { return guest_.position; } ///< of its middle, scene space
    [[nodiscard]] glm::mat4 place() const;                               ///< from its own frame

Q_SIGNALS:
    void added(QString name);
    void present(bool isThere); ///< there is an object now, or none
    /// The user did `what` ("moving the object"), a step for undo; a drag is one. `mayJoin`: several such at once are.
    void edited(QString what, Guest before, bool mayJoin);
    void failed(QString message);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override; ///< the viewport's mouse, wheel and Escape

private:
    using Make = std::function<Result<std::shared_ptr<const Scene>>()>;
    void start(const QString& name, bool keepsSize, Make make);
    void take(std::shared_ptr<const DrawData> data, const QString& name, bool keepsSize);
    bool press(const QMouseEvent& event);
    bool move(const QMouseEvent& event);
    bool turn(const QWheelEvent& event);
    void put(glm::vec3 position);
    void letGo(); ///< what was dragged stays where it is

    struct Hold {
        glm::vec3 grip{0.0f}; ///< point of the object under the cursor when the drag began
        Guest before;
        SightLine from;
        bool isUpright = false; ///< up and down
    };
    Viewport* viewport_;
    QThreadPool pool_;
    quint64 serial_ = 0;
    Bounds bounds_;
    Guest guest_;
    std::optional<Hold> held_;
};

} // namespace lightloom
