// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/scene/scene.h"
#include <QWidget>
#include <memory>
#include <vector>

class QCheckBox;
class QLabel;
class QListWidget;
class QScrollArea;
class QSlider;
class QToolButton;
class QVBoxLayout;

namespace lightloom {

class LampEditor;

/// A lamp as its switch and dimmer have it.
struct LampSetting {
    bool isOn = true;
    int percent = 100; ///< kept while it is off
    bool operator==(const LampSetting&) const = default;
};

/// Cameras and lamps of the open scene. A lamp is a light group: a check box switches it, a slider dims it, a button
/// chooses it for editing.
class SceneDock final : public QWidget {
    Q_OBJECT
public:
    explicit SceneDock(QWidget* parent = nullptr);
    void setScene(const std::shared_ptr<const Scene>& scene); ///< null: empty. Lamps are at 100 % and on
    [[nodiscard]] Mix mix() const;                            ///< what check boxes and sliders say
    [[nodiscard]] std::vector<LampSetting> lampSettings() const;
    void setLampSettings(const std::vector<LampSetting>& settings); ///< one per lamp; sends no signal
    [[nodiscard]] QString lampName(int lamp) const;
    [[nodiscard]] LampEditor& editor() const { return *editor_; }
    /// The lamp to be edited, as LampEditor::setLamp has it; group -1: none. Sends no signal.
    void showLamp(const std::shared_ptr<const Scene>& scene, int group, int light);

Q_SIGNALS:
    void lampChosen(int lamp); ///< to be edited; -1: none
    void cameraChosen(int index);
    void lampEdited(int lamp, bool isDimmed); ///< else switched

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    struct Lamp {
        QCheckBox* on;
        QSlider* gain; ///< percent
        QLabel* value;
        QToolButton* edit;
    };
    void addLamp(const LightGroup& group, QVBoxLayout& column);

    void shareHeight();

    QListWidget* cameras_;
    QScrollArea* lampBox_ = nullptr;
    QVBoxLayout* column_;
    QLabel* about_;
    LampEditor* editor_;
    QScrollArea* editorArea_; ///< as high as its form, up to half the dock
    std::vector<Lamp> lamps_;
    bool filling_ = false; ///< values are being shown, not edited
};

} // namespace lightloom
