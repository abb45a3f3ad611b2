// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/trade_plot.h"
#include <QMouseEvent>
#include <QPainter>
#include <QPainterPath>
#include <QToolTip>
#include <algorithm>
#include <cmath>

namespace lightloom {

namespace {

constexpr double kReach = 12.0; ///< pixels around a point in which a click counts
constexpr double kDot = 4.5, kRing = 8.0;
constexpr std::size_t kMostNames = 8; ///< in the legend

QString text(const std::string& s) { return QString::fromStdString(s); }

} // namespace

TradePlot::TradePlot(QWidget* parent) : QWidget(parent)
{
    setMouseTracking(true);
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
    setAccessibleName(tr("Error over cost; the table below has the same numbers"));
    show(LogPlot{});
}

void TradePlot::show(LogPlot plot)
{
    plot_ = std::move(plot);
    x_ = logScale(plot_, &PlotPoint::x);
    y_ = logScale(plot_, &PlotPoint::y);
    update();
}

void TradePlot::choose(std::optional<std::size_t> source)
{
    chosen_ = source;
    update();
}

QRectF TradePlot::frame() const
{
    const QFontMetrics m = fontMetrics();
    const double left = m.horizontalAdvance(QStringLiteral("00000")) + 10.0;
    return {left, m.height() + 6.0, width() - left - 10.0, height() - 3.0 * m.height() - 16.0};
}

QPointF TradePlot::place(const PlotPoint& point) const
{
    const QRectF f = frame();
    return {f.left() + f.width() * x_.partOf(point.x), f.bottom() - f.height() * y_.partOf(point.y)};
}

std::optional<QPointF> TradePlot::placeOf(std::size_t source) const
{
    for (const PlotSeries& series : plot_.series) {
        for (const PlotPoint& p : series.points) {
            if (p.source == source && canShow(p)) return place(p);
        }
    }
    return {};
}

const PlotPoint* TradePlot::near(QPointF position) const
{
    const PlotPoint* best = nullptr;
    double least = kReach;
    for (const PlotSeries& series : plot_.series) {
        for (const PlotPoint& p : series.points) {
            if (!canShow(p)) continue;
            const QPointF d = place(p) - position;
            const double distance = std::hypot(d.x(), d.y());
            if (distance > least) continue;
            least = distance;
            best = &p;
        }
    }
    return best;
}

/// The shared colours are made for white paper: black turns to the text's colour, and on dark ground all get lighter.
QColor TradePlot::colourOf(std::size_t series) const
{
    const QColor colour(text(plotColour(series, plot_.series.size())));
    if (palette().color(QPalette::Base).lightness() > 128) return colour;
    return colour == QColor(Qt::black) ? palette().color(QPalette::Text) : colour.lighter(140);
}

void TradePlot::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    painter.fillRect(rect(), palette().color(QPalette::Base));
    if (plot_.series.empty()) {
        painter.setPen(palette().color(QPalette::PlaceholderText));
        painter.drawText(rect(), Qt::AlignCenter | Qt::TextWordWrap,
                         tr("Error over cost appears here, a point a bake"));
        return;
    }
    paintAxes(painter);
    painter.setRenderHint(QPainter::Antialiasing);
    paintFront(painter);
    for (std::size_t s = 0; s < plot_.series.size(); ++s) paintSeries(painter, s);
    paintLegend(painter);
}

void TradePlot::paintAxes(QPainter& painter) const
{
    const QRectF f = frame();
    const QFontMetrics m = fontMetrics();
    const QColor ink = palette().color(QPalette::Text);
    QColor strong = ink, faint = ink; // on dark and on light ground
    strong.setAlphaF(0.35f);
    faint.setAlphaF(0.12f);
    for (const Tick& t : x_.ticks) {
        const double x = f.left() + f.width() * x_.partOf(t.value);
        painter.setPen(t.label.empty() ? faint : strong);
        painter.drawLine(QPointF(x, f.top()), QPointF(x, f.bottom()));
        painter.setPen(ink);
        const double wide = m.horizontalAdvance(text(t.label));
        painter.drawText(QPointF(std::min(x - wide / 2.0, width() - wide - 1.0), f.bottom() + m.ascent() + 3.0),
                         text(t.label));
    }
    for (const Tick& t : y_.ticks) {
        const double y = f.bottom() - f.height() * y_.partOf(t.value);
        painter.setPen(t.label.empty() ? faint : strong);
        painter.drawLine(QPointF(f.left(), y), QPointF(f.right(), y));
        if (t.label.empty()) continue;
        painter.setPen(ink);
        painter.drawText(QRectF(0, y - m.height() / 2.0, f.left() - 5.0, m.height()), Qt::AlignRight | Qt::AlignVCenter,
                         QString::number(t.value * plot_.yScale, 'g', 4));
    }
    painter.drawText(QRectF(0, 0, width(), f.top() - 3.0), Qt::AlignLeft | Qt::AlignVCenter,
                     m.elidedText(text(plot_.yLabel), Qt::ElideRight, width()));
    painter.drawText(QRectF(0, height() - m.height() - 4.0, width(), m.height() + 2.0), Qt::AlignCenter,
                     m.elidedText(text(plot_.xLabel), Qt::ElideRight, width()));
    if (!(plot_.yLine >= y_.low && plot_.yLine <= y_.high)) return;
    const double y = f.bottom() - f.height() * y_.partOf(plot_.yLine);
    painter.setPen(QPen(ink, 1.0, Qt::DashLine));
    painter.drawLine(QPointF(f.left(), y), QPointF(f.right(), y));
    painter.drawText(QPointF(f.left() + 4.0, y - 3.0), text(plot_.yLineLabel));
}

/// What no other beats, joined in order of cost.
void TradePlot::paintFront(QPainter& painter) const
{
    std::vector<const PlotPoint*> marked;
    for (const PlotSeries& series : plot_.series) {
        for (const PlotPoint& p : series.points) {
            if (!p.mark.empty() && canShow(p)) marked.push_back(&p);
        }
    }
    std::ranges::stable_sort(marked, {}, [](const PlotPoint* p) { return p->x; });
    QPolygonF line;
    for (const PlotPoint* p : marked) line += place(*p);
    QColor band = palette().color(QPalette::Text);
    band.setAlphaF(0.25f);
    painter.setPen(QPen(band, 5.0));
    painter.drawPolyline(line);
}

void TradePlot::paintSeries(QPainter& painter, std::size_t s) const
{
    const QColor colour = colourOf(s);
    QPainterPath path;
    bool isBegun = false; // a path that was only moved to a point still calls itself empty
    for (const PlotPoint& p : plot_.series[s].points) {
        if (!canShow(p)) continue;
        if (!isBegun || p.startsLine) {
            path.moveTo(place(p));
        } else {
            path.lineTo(place(p));
        }
        isBegun = true;
    }
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(colour, 1.0));
    painter.drawPath(path);
    for (const PlotPoint& p : plot_.series[s].points) {
        if (!canShow(p)) continue;
        painter.setPen(Qt::NoPen);
        painter.setBrush(colour);
        painter.drawEllipse(place(p), kDot, kDot);
        painter.setBrush(Qt::NoBrush);
        if (!p.mark.empty()) {
            painter.setPen(QPen(palette().color(QPalette::Text), 1.2));
            painter.drawEllipse(place(p), kRing, kRing);
        }
        if (chosen_ != p.source) continue;
        painter.setPen(QPen(palette().color(QPalette::Link), 2.5));
        painter.drawEllipse(place(p), kRing + 3.0, kRing + 3.0);
    }
}

/// In the corner that is dear and wrong, where points are rare.
void TradePlot::paintLegend(QPainter& painter) const
{
    if (plot_.series.size() < 2 || plot_.series.size() > kMostNames) return;
    const QFontMetrics m = fontMetrics();
    const QRectF f = frame();
    double y = f.top() + 4.0;
    const auto line = [&](const QString& words) {
        const QRectF place(f.left(), y, f.width() - 20.0, m.height());
        painter.setPen(palette().color(QPalette::Text));
        painter.drawText(place, Qt::AlignRight | Qt::AlignVCenter, words);
        y += m.height();
        return QPointF(f.right() - 10.0, y - m.height() / 2.0);
    };
    line(text(plot_.legendTitle));
    for (std::size_t s = 0; s < plot_.series.size(); ++s) {
        const QPointF dot = line(text(plot_.series[s].name));
        painter.setPen(Qt::NoPen);
        painter.setBrush(colourOf(s));
        painter.drawEllipse(dot, kDot, kDot);
    }
}

void TradePlot::mousePressEvent(QMouseEvent* event)
{
    const PlotPoint* point = near(event->position());
    if (event->button() == Qt::LeftButton && point != nullptr) Q_EMIT clicked(point->source);
}

void TradePlot::mouseMoveEvent(QMouseEvent* event)
{
    const PlotPoint* point = near(event->position());
    setCursor(point != nullptr ? Qt::PointingHandCursor : Qt::ArrowCursor);
    QToolTip::showText(event->globalPosition().toPoint(),
                       point == nullptr ? QString()
                                        : tr("%1\n%2 CPU-s, relRMSE %3 %\nClick: bake with these")
                                              .arg(text(point->tip))
                                              .arg(point->x, 0, 'g', 3)
                                              .arg(100.0 * point->y, 0, 'f', 2),
                       this);
}

void TradePlot::changeEvent(QEvent* event)
{
    if (event->type() == QEvent::PaletteChange) update();
    QWidget::changeEvent(event);
}

} // namespace lightloom
