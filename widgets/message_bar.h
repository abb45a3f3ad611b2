// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <QFrame>
#include <functional>

class QLabel;
class QToolButton;

namespace lightloom {

/// One line above the picture: what happened, and a button for the way out. Never a modal box, never takes the focus.
class MessageBar final : public QFrame {
    Q_OBJECT
public:
    explicit MessageBar(QWidget* parent = nullptr);
    /// `way` is the button's text; empty: no button. Replaces the message before.
    void show(const QString& text, const QString& way = {}, std::function<void()> go = {});
    void clear();
    [[nodiscard]] QString text() const;

private:
    QString message_;
    QLabel* text_;
    QToolButton *way_, *close_;
    std::function<void()> go_;
};

} // namespace lightloom
