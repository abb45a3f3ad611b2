// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <QWidget>

class QLabel;

namespace lightloom {

/// The edge of the wipe: a line over the picture that is dragged, or moved by the arrow keys while it has the focus
/// (Shift: finer; Home, End: to the sides), with the names of both sides beside it. A child of the picture, as high as
/// it.
class WipeHandle final : public QWidget {
    Q_OBJECT
public:
    explicit WipeHandle(QWidget* picture);
    [[nodiscard]] float part() const { return part_; } ///< of the picture's width, from the left
    void setPart(float part);                          ///< clamped; tells `moved` when it changes
    void setNames(const QString& left, const QString& right);

Q_SIGNALS:
    void moved(float part);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override; ///< the picture's size
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void keyPressEvent(QKeyEvent* event) override;
    void focusInEvent(QFocusEvent* event) override;
    void focusOutEvent(QFocusEvent* event) override;
    void showEvent(QShowEvent* event) override;
    void hideEvent(QHideEvent* event) override;

private:
    void place();

    QLabel *left_, *right_;
    float part_ = 0.5f;
    int grip_ = 0; ///< where in the handle it was taken
};

} // namespace lightloom
