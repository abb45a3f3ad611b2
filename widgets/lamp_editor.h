// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/scene/scene.h"
#include <QWidget>
#include <map>
#include <memory>

class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QPushButton;

namespace lightloom {

/// The chosen lamp in numbers: place in the file's frame, where it points, intensity and colour, cones. Fields that it
/// has no use for are hidden. Glowing surfaces are named and not edited.
class LampEditor final : public QWidget {
    Q_OBJECT
public:
    explicit LampEditor(QWidget* parent = nullptr);
    /// `light` -1: a glowing surface of light group `group`, or with that -1 too nothing.
    void setLamp(const std::shared_ptr<const Scene>& scene, int group, int light);

Q_SIGNALS:
    void edited(int light, const lightloom::PunctualLight& now, const QString& what);

private:
    QDoubleSpinBox* addField(const QString& name, const QString& label, double least, double most, int decimals,
                             const QString& unit, const QString& tip);
    void tell(const QString& what);
    void chooseColour();
    void showColour();
    [[nodiscard]] glm::vec3 tint() const; ///< of the chosen lamp; white if nobody knows

    std::shared_ptr<const Scene> scene_;
    int light_ = -1;
    bool filling_ = false;
    QLabel* title_;
    QWidget* form_;
    QFormLayout* rows_;
    QDoubleSpinBox *x_, *y_, *z_, *turn_, *tilt_, *intensity_, *inner_, *outer_;
    QPushButton* colour_;
    std::map<int, glm::vec3> tints_; ///< of luminance 1, by light: one that is dimmed to nothing keeps its own
};

} // namespace lightloom
