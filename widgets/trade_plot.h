// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/compare/svg_plot.h"
#include <QWidget>
#include <optional>

namespace lightloom {

/// A plot of points over two logarithmic axes, of which one can be clicked. What is marked is ringed and joined.
class TradePlot final : public QWidget {
    Q_OBJECT
public:
    explicit TradePlot(QWidget* parent = nullptr);
    void show(LogPlot plot);
    /// Marks the point with this `source` as chosen; nothing: none.
    void choose(std::optional<std::size_t> source);
    [[nodiscard]] std::optional<QPointF> placeOf(std::size_t source) const; ///< nothing: not shown
    [[nodiscard]] QSize sizeHint() const override { return {320, 260}; }
    [[nodiscard]] QSize minimumSizeHint() const override { return {200, 180}; }

Q_SIGNALS:
    void clicked(std::size_t source);

protected:
    void paintEvent(QPaintEvent* event) override;
    void mousePressEvent(QMouseEvent* event) override;
    void mouseMoveEvent(QMouseEvent* event) override;
    void changeEvent(QEvent* event) override; ///< the theme

private:
    [[nodiscard]] QRectF frame() const;
    [[nodiscard]] QPointF place(const PlotPoint& point) const;
    [[nodiscard]] const PlotPoint* near(QPointF position) const;
    [[nodiscard]] QColor colourOf(std::size_t series) const;
    void paintAxes(QPainter& painter) const;
    void paintFront(QPainter& painter) const;
    void paintSeries(QPainter& painter, std::size_t s) const;
    void paintLegend(QPainter& painter) const;

    LogPlot plot_;
    LogScale x_, y_;
    std::optional<std::size_t> chosen_;
};

} // namespace lightloom
