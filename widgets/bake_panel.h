// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/field/bake_control.h"
#include "core/field/bake_products.h"
#include "widgets/bake_view.h"
#include <QWidget>

class QLabel;
class QProgressBar;
class QToolButton;
class QAction;

namespace lightloom {

/// How the bake goes: stage, progress, time left, time and cost per depth, where the light went, the noise that the
/// bake itself states, and what was counted. Its buttons are the window's actions.
class BakePanel final : public QWidget {
    Q_OBJECT
public:
    BakePanel(QAction* start, QAction* pause, QAction* cancel, QWidget* parent = nullptr);
    void setMethod(Method method);
    void begin();
    void show(const Progress& progress);
    void add(const BakeView& view);       ///< the bake came so far
    void showNoise(const BakeView& view); ///< of the refinement that is looked at
    void forgetDepths();                  ///< what is added next is of another bake
    void end(const QString& outcome, const WorkCounters& counters);
    [[nodiscard]] QString countersText() const; ///< what was done and what was kept
    void clear();
    [[nodiscard]] QString stageText() const;
    [[nodiscard]] double fraction() const;
    [[nodiscard]] QString lightText() const; ///< empty until a bake ended
    [[nodiscard]] QString noiseText() const;

private:
    QLabel *stage_, *depths_, *noise_, *light_, *counters_;
    QProgressBar* bar_;
    QString times_;
    Method method_ = Method::lightOctree;
};

} // namespace lightloom
