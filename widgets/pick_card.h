// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <QStringList>
#include <QWidget>
#include <vector>

namespace lightloom {

/// A sheet over the viewport that lets every click through: a card of text in its upper left corner, and short labels
/// anywhere. Hidden while there is nothing to say.
class PickCard final : public QWidget {
    Q_OBJECT
public:
    struct Label {
        QPointF at; ///< middle left
        QString text;
    };
    explicit PickCard(QWidget* viewport);

    void setLines(const QStringList& lines); ///< the first one is the title; none: hidden
    void setLabels(std::vector<Label> labels);
    [[nodiscard]] const QStringList& lines() const { return lines_; }
    [[nodiscard]] const std::vector<Label>& labels() const { return labels_; }
    [[nodiscard]] std::vector<QRectF>
    labelPlaces() const; ///< in order of `labels`; pushed down where they would overlap

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;
    void paintEvent(QPaintEvent* event) override;

private:
    QStringList lines_;
    std::vector<Label> labels_;
};

} // namespace lightloom
