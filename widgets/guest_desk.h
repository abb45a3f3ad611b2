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
    void sceneChanged(const Bounds& bounds); ///< another scene: the object goes

    [[nodiscard]] bool hasGuest() const { return data_ != nullptr; }
    [[nodiscard]] bool isDragging() const { return held_.has_value(); }
    [[nodiscard]] glm::vec3 position() const { return position_; } ///< of its middle, scene space
    [[nodiscard]] glm::mat4 place() const;                         ///< from its own frame

Q_SIGNALS:
    void added(QString name);
    void removed();
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

    struct Hold {
        glm::vec3 grip{0.0f}; ///< point of the object under the cursor when the drag began
        glm::vec3 before{0.0f};
        SightLine from;
        bool isUpright = false; ///< up and down
    };
    Viewport* viewport_;
    QThreadPool pool_;
    quint64 serial_ = 0;
    Bounds bounds_;
    std::shared_ptr<const DrawData> data_;
    glm::vec3 position_{0.0f};
    float scale_ = 1.0f, turn_ = 0.0f; ///< turn: radians about the vertical
    std::optional<Hold> held_;
};

} // namespace lightloom
