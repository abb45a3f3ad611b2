// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/export_worker.h"
#include <QDialog>

class QCheckBox;
class QComboBox;
class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;

namespace lightloom {

/// File > Export: which files, where, how fine, and how far it is. Not modal: the window goes on meanwhile. The light
/// is what the window shows when the button is pressed.
class ExportDialog final : public QDialog {
    Q_OBJECT
public:
    /// `order` gives the light to export, request left empty; nothing: there is none.
    ExportDialog(QWidget* parent, std::function<std::optional<ExportOrder>()> order);

    void setName(const QString& pathWithoutEnding); ///< where files go, unless the user has chosen
    void lightChanged();                            ///< `order` would give another one

Q_SIGNALS:
    void exported(QStringList files); ///< all of them were written

private:
    [[nodiscard]] ExportRequest request() const;
    void choosePlace();
    void showState();
    void say(const QString& text);
    void begin();
    void end(const QStringList& files, const QString& report, const QString& problem, bool isCancelled);

    std::function<std::optional<ExportOrder>()> order_;
    ExportWorker worker_;
    QCheckBox *lightmap_, *gltf_, *volume_, *direct_, *sceneUv_;
    QComboBox* size_;
    QLineEdit* place_;
    QLabel *state_, *about_; ///< about: the light
    QProgressBar* progress_;
    QPushButton *go_, *cancel_;
    bool isRunning_ = false;
};

} // namespace lightloom
