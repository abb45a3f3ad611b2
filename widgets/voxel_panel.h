// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/bake_view.h"
#include <QWidget>

class QLabel;
class QSpinBox;

namespace lightloom {

class ViewWorker;
class Viewport;
struct VoxelLineMarks;

/// Which of a bake's directions is drawn as lines through the scene, and what they are. Follows the bake that is shown.
class VoxelPanel final : public QWidget {
    Q_OBJECT
public:
    explicit VoxelPanel(ViewWorker* worker, QWidget* parent = nullptr);
    void setViewport(Viewport* viewport) { viewport_ = viewport; } ///< null: nothing is drawn
    void
    setView(const BakeView& view); ///< another bake, or the same under another mix; none of voxels: nothing is drawn
    void setDirections(int count); ///< that a bake has
    [[nodiscard]] int direction() const; ///< -1: none
    [[nodiscard]] QString aboutText() const;

private:
    void ask();
    void take(const VoxelLineMarks& lines);

    ViewWorker* worker_;
    Viewport* viewport_ = nullptr;
    QSpinBox* number_;
    QLabel* about_;
    BakeView view_;
};

} // namespace lightloom
