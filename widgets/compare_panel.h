// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/compare_worker.h"
#include <QWidget>
#include <array>

class QAction;
class QComboBox;
class QLabel;
class QProgressBar;
class QSpinBox;

namespace lightloom {

/// The reference's own noise is more than a quarter of relRMSE, and so moves it by more than 3 %.
[[nodiscard]] bool noiseCounts(const ViewError& error);

/// The dock of comparing: how far the reference has come, and how far the bake is off it. Its buttons are the window's
/// actions.
class ComparePanel final : public QWidget {
    Q_OBJECT
public:
    ComparePanel(QAction* reference, QAction* wipe, QWidget* parent = nullptr);
    [[nodiscard]] int samples() const; ///< camera rays per pixel that are wanted
    [[nodiscard]] int shrink() const;  ///< the picture's pixels across, over those of the reference: 1, 2, 4

    void showState(const QString& line); ///< in place of progress: off, waiting, starting anew
    void show(const ReferencePicture& picture);
    void show(const ErrorPicture& picture, const QString& judged); ///< judged: what the errors are of
    void forgetErrors();
    [[nodiscard]] QString stateText() const;
    [[nodiscard]] QString judgedText() const;    ///< what the figures are of
    [[nodiscard]] QString figure(int row) const; ///< as shown: relRMSE, bias, MAE, 95th percentile, largest, per pixel

Q_SIGNALS:
    void qualityEdited(); ///< `samples` or `shrink`

private:
    QLabel* state_;
    QProgressBar* bar_;
    QSpinBox* samples_;
    QComboBox* size_;
    QLabel *judged_, *noise_;
    std::array<QLabel*, 6> figures_{};
};

} // namespace lightloom
