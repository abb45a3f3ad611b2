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

std::vector<QRectF> PickCard::labelPlaces() const
{
    const QFontMetrics metrics(font());
    std::vector<QRectF> places;
    std::vector<std::size_t> order(labels_.size());
    for (std::size_t i = 0; i < labels_.size(); ++i) {
        const QSizeF size(metrics.horizontalAdvance(labels_[i].text) + 8, metrics.height() + 2);
        places.emplace_back(labels_[i].at - QPointF(0, 0.5 * size.height()), size);
        order[i] = i;
    }
    std::ranges::sort(order, {}, [&](std::size_t i) { return places[i].top(); });
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) { // those above have their places; one push may meet the next of them
            QRectF& place = places[order[i]];
            if (!place.intersects(places[order[j]])) continue;
            place.moveTop(places[order[j]].bottom() + 1);
            j = static_cast<std::size_t>(-1);
        }
    }
    return places;
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
    const std::vector<QRectF> places = labelPlaces();
    for (std::size_t i = 0; i < labels_.size(); ++i) {
        box(places[i]);
        painter.setPen(kInk);
        painter.drawText(places[i], Qt::AlignCenter, labels_[i].text);
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
