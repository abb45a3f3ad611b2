// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/compare/view_error.h"
#include <QWidget>
#include <memory>

namespace lightloom {

/// Under a picture in false colour: what is shown, and a bar of its colours with ticks and units. As high as whoever
/// places it says; two lines of text are enough.
class LegendStrip final : public QWidget {
    Q_OBJECT
public:
    explicit LegendStrip(QWidget* parent = nullptr);
    /// `error` null: there is nothing to show yet, and `caption` says why.
    void show(std::shared_ptr<const ViewError> error, const QString& caption);
    [[nodiscard]] const QString& caption() const { return caption_; }
    [[nodiscard]] QStringList ticks() const; ///< as written, from the left

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    [[nodiscard]] float valueAt(float part) const;

    std::shared_ptr<const ViewError> error_;
    QString caption_;
};

} // namespace lightloom
