// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/compare/legend.h"
#include <QWidget>
#include <optional>

namespace lightloom {

/// Under a picture in false colour: what is shown, and a bar of its colours with ticks and units. As high as whoever
/// places it says; three lines of text fit.
class LegendStrip final : public QWidget {
    Q_OBJECT
public:
    explicit LegendStrip(QWidget* parent = nullptr);
    /// `scale` (its own caption does not count) nothing: there is no such picture yet, and `caption` says why.
    void show(const std::optional<HeatmapStyle>& scale, const QString& caption);
    [[nodiscard]] const QString& caption() const { return caption_; }
    [[nodiscard]] QStringList ticks() const; ///< as written, from the left
    /// Pixels of the bar: as many as the caption leaves, within 120 to 360; 0 without a scale.
    [[nodiscard]] int barLength() const;
    [[nodiscard]] QSize sizeHint() const override; ///< wide enough for captions of ours
    [[nodiscard]] QRect captionPlace() const;      ///< where the caption is written, broken into lines

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    std::optional<HeatmapStyle> scale_;
    QString caption_;
};

} // namespace lightloom
