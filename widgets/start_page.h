// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <QStringList>
#include <QWidget>

namespace lightloom {

/// Sample scenes that came with the program, sorted; empty if the folder is not found.
[[nodiscard]] QStringList sampleSceneFiles();
/// What a scene file is called in menus: its name without folder and ending, spaces for underscores.
[[nodiscard]] QString sceneTitle(const QString& file);

/// What the window shows before a scene is open: one sentence, and the sample scenes.
class StartPage final : public QWidget {
    Q_OBJECT
public:
    explicit StartPage(QWidget* parent = nullptr);

Q_SIGNALS:
    void openWanted();
    void sampleWanted(QString file);
};

} // namespace lightloom
