// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/scene/scene.h"
#include <QWidget>
#include <memory>
#include <vector>

class QCheckBox;
class QLabel;
class QListWidget;
class QSlider;
class QVBoxLayout;

namespace lightloom {

/// Cameras and lamps of the open scene. A lamp is a light group: a check box switches it, a slider dims it.
class SceneDock final : public QWidget {
    Q_OBJECT
public:
    explicit SceneDock(QWidget* parent = nullptr);
    void setScene(const std::shared_ptr<const Scene>& scene); ///< null: empty. Lamps are at 100 % and on
    [[nodiscard]] Mix mix() const;                            ///< what check boxes and sliders say

Q_SIGNALS:
    void cameraChosen(int index);
    void mixEdited();

private:
    struct Lamp {
        QCheckBox* on;
        QSlider* gain; ///< percent
        QLabel* value;
    };
    void addLamp(const LightGroup& group, QVBoxLayout& column);

    QListWidget* cameras_;
    QWidget* lampBox_ = nullptr;
    QVBoxLayout* column_;
    QLabel* about_;
    std::vector<Lamp> lamps_;
};

} // namespace lightloom
