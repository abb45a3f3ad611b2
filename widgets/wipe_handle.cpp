// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/wipe_handle.h"
#include <QKeyEvent>
#include <QLabel>
#include <QPainter>
#include <algorithm>
#include <cmath>

namespace lightloom {

namespace {

constexpr int kWidth = 19;                         ///< wide enough to be caught
constexpr int kGap = 4;                            ///< between the handle and a name
constexpr float kStep = 0.02f, kFineStep = 0.002f; ///< of the picture's width

QLabel* makeName(QWidget* picture)
{
    auto* name = new QLabel(picture);
    name->setAttribute(Qt::WA_TransparentForMouseEvents);
    // its own colours: it lies over the picture, whatever that is
    name->setStyleSheet(QStringLiteral("background: #202020; color: #f0f0f0; padding: 2px 6px; border-radius: 2px;"));
    name->hide();
    return name;
}

} // namespace

WipeHandle::WipeHandle(QWidget* picture) : QWidget(picture), left_(makeName(picture)), right_(makeName(picture))
{
    setCursor(Qt::SplitHCursor);
    setFocusPolicy(Qt::StrongFocus);
    setAccessibleName(tr("Wipe between reference and bake"));
    setToolTip(tr("Drag, or move with the arrow keys (Shift: finer)"));
    picture->installEventFilter(this);
    hide();
}

void WipeHandle::setPart(float part)
{
    part = std::clamp(part, 0.0f, 1.0f);
    if (part == part_) return;
    part_ = part;
    place();
    Q_EMIT moved(part_);
}

void WipeHandle::setNames(const QString& left, const QString& right)
{
    left_->setText(left);
    right_->setText(right);
    place();
}

void WipeHandle::place()
{
    const int width = parentWidget()->width(), edge = static_cast<int>(std::lround(part_ * static_cast<float>(width)));
    setGeometry(edge - kWidth / 2, 0, kWidth, parentWidget()->height());
    for (QLabel* name : {left_, right_}) name->adjustSize();
    const int near = kWidth / 2 + kGap;
    // a name that would leave the picture stays in it as long as its side is wide enough, and is clipped after that
    left_->move(edge - near - left_->width(), kGap);
    right_->move(edge + near, kGap);
    left_->setVisible(isVisible() && edge > near + left_->width() / 3);
    right_->setVisible(isVisible() && width - edge > near + right_->width() / 3);
}

bool WipeHandle::eventFilter(QObject* watched, QEvent* event)
{
    if (event->type() == QEvent::Resize) place();
    return QWidget::eventFilter(watched, event);
}

void WipeHandle::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    const QColor line = hasFocus() ? palette().color(QPalette::Highlight).lighter(150) : QColor(240, 240, 240);
    const int middle = kWidth / 2, centre = height() / 2;
    painter.fillRect(middle - 1, 0, 3, height(), QColor(20, 20, 20)); // readable on light and dark
    painter.fillRect(middle, 0, 1, height(), line);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.setPen(QColor(20, 20, 20));
    painter.setBrush(line);
    painter.drawRoundedRect(QRectF(middle - 6.5, centre - 17.5, 14, 35), 4, 4);
    painter.drawLine(middle - 1, centre - 8, middle - 1, centre + 8);
    painter.drawLine(middle + 2, centre - 8, middle + 2, centre + 8);
}

void WipeHandle::mousePressEvent(QMouseEvent* event)
{
    grip_ = static_cast<int>(event->position().x()) - kWidth / 2;
    setFocus(Qt::MouseFocusReason);
    event->accept();
}

void WipeHandle::mouseMoveEvent(QMouseEvent* event)
{
    if (!event->buttons().testFlag(Qt::LeftButton)) return;
    const double x = mapToParent(event->position().toPoint()).x() - grip_;
    setPart(static_cast<float>(x / std::max(parentWidget()->width(), 1)));
    event->accept();
}

void WipeHandle::keyPressEvent(QKeyEvent* event)
{
    const float step = event->modifiers().testFlag(Qt::ShiftModifier) ? kFineStep : kStep;
    switch (event->key()) {
    case Qt::Key_Left:
        return setPart(part_ - step);
    case Qt::Key_Right:
        return setPart(part_ + step);
    case Qt::Key_Home:
        return setPart(0.0f);
    case Qt::Key_End:
        return setPart(1.0f);
    default:
        QWidget::keyPressEvent(event);
    }
}

void WipeHandle::focusInEvent(QFocusEvent*) { update(); }
void WipeHandle::focusOutEvent(QFocusEvent*) { update(); }
void WipeHandle::showEvent(QShowEvent*) { place(); }

void WipeHandle::hideEvent(QHideEvent*)
{
    left_->hide();
    right_->hide();
}

} // namespace lightloom
