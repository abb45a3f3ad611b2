// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/pick_card.h"
#include <QEvent>
#include <QFontMetrics>
#include <QPainter>
#include <algorithm>

namespace lightloom {

namespace {

constexpr int kMargin = 10, kPadding = 8;
const QColor kPaper(20, 20, 20, 205), kInk(235, 235, 235), kFaint(175, 175, 175); // over any picture, in any theme

} // namespace

PickCard::PickCard(QWidget* viewport) : QWidget(viewport)
{
    setAttribute(Qt::WA_TransparentForMouseEvents);
    setAttribute(Qt::WA_NoSystemBackground);
    setFocusPolicy(Qt::NoFocus);
    setAccessibleName(tr("Picked cell"));
    hide();
    viewport->installEventFilter(this);
}

void PickCard::setLines(const QStringList& lines)
{
    lines_ = lines;
    setAccessibleDescription(lines.join('\n'));
    setVisible(!lines.isEmpty());
    setGeometry(parentWidget()->rect());
    update();
}

void PickCard::setLabels(std::vector<Label> labels)
{
    const bool isSame = std::ranges::equal(
        labels, labels_, [](const Label& a, const Label& b) { return a.at == b.at && a.text == b.text; });
    if (isSame) return; // a sheet that is drawn anew composes the whole window
    labels_ = std::move(labels);
    update();
}

bool PickCard::eventFilter(QObject* watched, QEvent* event)
{
    if (event->type() == QEvent::Resize) setGeometry(parentWidget()->rect());
    return QWidget::eventFilter(watched, event);
}

void PickCard::paintEvent(QPaintEvent*)
{
    if (lines_.isEmpty()) return;
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QFontMetrics metrics(font());
    const auto box = [&](const QRectF& rect) {
        painter.setPen(Qt::NoPen);
        painter.setBrush(kPaper);
        painter.drawRoundedRect(rect, 4, 4);
    };
    for (const Label& label : labels_) {
        const QSizeF size(metrics.horizontalAdvance(label.text) + 8, metrics.height() + 2);
        const QRectF rect(label.at - QPointF(0, 0.5 * size.height()), size);
        box(rect);
        painter.setPen(kInk);
        painter.drawText(rect, Qt::AlignCenter, label.text);
    }
    int width = 0;
    for (const QString& line : lines_) width = std::max(width, metrics.horizontalAdvance(line));
    const int height = metrics.lineSpacing() * static_cast<int>(lines_.size());
    box(QRectF(kMargin, kMargin, width + 2 * kPadding, height + 2 * kPadding));
    int y = kMargin + kPadding + metrics.ascent();
    for (qsizetype i = 0; i < lines_.size(); ++i, y += metrics.lineSpacing()) {
        painter.setPen(i == 0 ? kInk : kFaint);
        painter.drawText(kMargin + kPadding, y, lines_[i]);
    }
}

} // namespace lightloom
