// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <QPointF>
#include <QString>
#include <QXmlStreamReader>
#include <cmath>
#include <map>
#include <string>
#include <vector>

/// Reads back what svg_plot writes: points, and the axes that give their places a meaning.
namespace lightloom::test {

struct SvgPlot {
    struct Point {
        double x = 0, y = 0; ///< as written beside the point
        QPointF place;       ///< as drawn
        QString tip;
        bool isMarked = false;
    };
    QString title, error;
    std::vector<Point> points;
    std::map<double, double> xTicks, yTicks; ///< value to pixel

    [[nodiscard]] double xAt(double pixel) const { return valueAt(xTicks, pixel); }
    [[nodiscard]] double yAt(double pixel) const { return valueAt(yTicks, pixel); }

private:
    static double valueAt(const std::map<double, double>& ticks, double pixel)
    {
        const auto [low, from] = *ticks.begin();
        const auto [high, to] = *ticks.rbegin();
        return low * std::pow(high / low, (pixel - from) / (to - from));
    }
};

inline SvgPlot readSvg(const std::string& svg)
{
    SvgPlot plot;
    QXmlStreamReader xml(QByteArray::fromStdString(svg));
    while (!xml.atEnd()) {
        if (xml.readNext() != QXmlStreamReader::StartElement) continue;
        const auto attributes = xml.attributes();
        const auto number = [&](const char* name) { return attributes.value(QLatin1String(name)).toDouble(); };
        const QString kind = attributes.value(QLatin1String("class")).toString();
        if (kind == "x-tick") plot.xTicks[number("data-value")] = number("x1");
        if (kind == "y-tick") plot.yTicks[number("data-value")] = number("y1");
        if (kind.startsWith("point")) {
            const QString move = attributes.value(QLatin1String("transform")).toString();
            const QStringList xy = move.mid(10, move.size() - 11).split(',');
            plot.points.push_back({number("data-x"),
                                   number("data-y"),
                                   {xy.at(0).toDouble(), xy.at(1).toDouble()},
                                   {},
                                   kind.contains("marked")});
        }
        if (xml.name() == QLatin1String("title") && !plot.points.empty())
            plot.points.back().tip = xml.readElementText();
        else if (xml.name() == QLatin1String("text") && plot.title.isEmpty())
            plot.title = xml.readElementText();
    }
    if (xml.hasError()) plot.error = xml.errorString();
    return plot;
}

} // namespace lightloom::test
