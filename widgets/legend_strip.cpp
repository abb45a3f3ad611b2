// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/legend_strip.h"
#include "core/base/image.h"
#include <QPainter>
#include <algorithm>
#include <utility>
#include <vector>

namespace lightloom {

namespace {

constexpr int kMargin = 10, kBarHeight = 12, kTick = 4, kTicks = 5, kGap = 14, kBetween = 2;
constexpr int kLeastBar = 120, kMostBar = 360;
constexpr int kSlack = 4; ///< advances are rounded

QColor shownColour(glm::vec3 linear)
{
    return QColor::fromRgbF(encodeSrgb(linear.x), encodeSrgb(linear.y), encodeSrgb(linear.z));
}

} // namespace

LegendStrip::LegendStrip(QWidget* parent) : QWidget(parent)
{
    setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Fixed);
    // a wider one would widen a small window's picture, and so end the reference that it is for
    setMinimumWidth(fontMetrics().horizontalAdvance(QStringLiteral("-100%  0%  100%  Error of the indirect light")));
    setAccessibleName(tr("Legend"));
}

void LegendStrip::show(const std::optional<HeatmapStyle>& scale, const QString& caption)
{
    scale_ = scale;
    caption_ = caption;
    setToolTip(caption); // should a long one be cut
    setAccessibleDescription(caption + QStringLiteral(": ") + ticks().join(QStringLiteral(", ")));
    update();
}

QSize LegendStrip::sizeHint() const
{
    const QString longest = QStringLiteral("Lightcuts: in blocks of 2 pixels, next 43 % +100%");
    return {kLeastBar + 3 * kMargin + kGap + fontMetrics().horizontalAdvance(longest), height()};
}

int LegendStrip::barLength() const
{
    const QStringList texts = ticks();
    if (texts.isEmpty()) return 0;
    const auto wide = [this](const QString& text) { return fontMetrics().horizontalAdvance(text); };
    int words = 0;
    for (const QString& line : caption_.split('\n')) words = std::max(words, wide(line) + kSlack);
    const int ends = (wide(texts.first()) + wide(texts.last())) / 2;
    return std::clamp(width() - 2 * kMargin - ends - kGap - words, kLeastBar, kMostBar);
}

QRect LegendStrip::captionPlace() const
{
    const QStringList texts = ticks();
    if (texts.isEmpty()) return rect().adjusted(kMargin, 0, -kMargin, 0);
    const auto half = [this](const QString& text) { return fontMetrics().horizontalAdvance(text) / 2; };
    const int from = kMargin + half(texts.first()) + barLength() + half(texts.last()) + kGap;
    return {from, 0, width() - from - kMargin, height()};
}

QStringList LegendStrip::ticks() const
{
    QStringList texts;
    if (!scale_) return texts;
    for (int i = 0; i < kTicks; ++i) {
        const float value = scale_->valueAt(static_cast<float>(i) / (kTicks - 1));
        texts += QString::fromStdString(legendText(value, scale_->unit, scale_->kind == ErrorKind::difference));
    }
    return texts;
}

void LegendStrip::paintEvent(QPaintEvent*)
{
    QPainter painter(this);
    const QFontMetrics metrics = fontMetrics();
    const QStringList texts = ticks();
    if (texts.isEmpty()) {
        painter.drawText(captionPlace(), Qt::AlignVCenter | Qt::AlignLeft | Qt::TextWordWrap, caption_);
        return;
    }
    // ends are centred on by their numbers
    const int left = kMargin + metrics.horizontalAdvance(texts.first()) / 2;
    const int length = barLength(), top = 5;
    for (int x = 0; x <= length; ++x) {
        const glm::vec3 colour = scale_->colourOf(scale_->valueAt(static_cast<float>(x) / static_cast<float>(length)));
        painter.fillRect(left + x, top, 1, kBarHeight, shownColour(colour));
    }
    const int numbers = top + kBarHeight + kTick;
    // the ends first, then the middle, then the rest: a narrow window drops numbers that would run into others
    std::vector<std::pair<int, int>> taken;
    for (const int i : {0, kTicks - 1, kTicks / 2, 1, 3}) {
        const int x = left + length * i / (kTicks - 1), half = metrics.horizontalAdvance(texts[i]) / 2;
        painter.fillRect(x, top + kBarHeight, 1, kTick, palette().color(QPalette::WindowText));
        const std::pair<int, int> place(x - half - kBetween, x + half + kBetween);
        const auto meets = [&](const auto& other) { return place.first < other.second && other.first < place.second; };
        if (std::ranges::any_of(taken, meets)) continue;
        painter.drawText(x - half, numbers + metrics.ascent(), texts[i]);
        taken.push_back(place);
    }
    painter.drawText(captionPlace(), Qt::AlignVCenter | Qt::TextWordWrap, caption_);
}

} // namespace lightloom
