// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/compare/legend.h"
#include <QWidget>
#include <optional>

namespace lightloom {

/// Under a picture in false colour: what is shown, and a bar of its colours with ticks and units. As high as whoever
/// places it says; two lines of text are enough.
class LegendStrip final : public QWidget {
    Q_OBJECT
public:
    explicit LegendStrip(QWidget* parent = nullptr);
    /// `scale` (its own caption does not count) nothing: there is no such picture yet, and `caption` says why.
    void show(const std::optional<HeatmapStyle>& scale, const QString& caption);
    [[nodiscard]] const QString& caption() const { return caption_; }
    [[nodiscard]] QStringList ticks() const; ///< as written, from the left

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    std::optional<HeatmapStyle> scale_;
    QString caption_;
};

} // namespace lightloom
