// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <QScrollArea>
#include <QStringList>
#include <vector>

class QFrame;
class QGridLayout;
class QLabel;
class QToolButton;
class QVBoxLayout;

namespace lightloom {

/// Sample scenes that came with the program, sorted; empty if the folder is not found.
[[nodiscard]] QStringList sampleSceneFiles();
/// What a scene file is called in menus: its name without folder and ending, spaces for underscores.
[[nodiscard]] QString sceneTitle(const QString& file);

/// What the window shows before a scene is open: one sentence in a drop area, the sample scenes as pictures
/// (`pictures/NAME.png` beside them), and what was open lately.
class StartPage final : public QScrollArea {
    Q_OBJECT
public:
    explicit StartPage(QWidget* parent = nullptr);
    void setRecent(const QStringList& files);
    void setDropping(bool isOver); ///< a scene is held over the window

Q_SIGNALS:
    void openWanted();
    void sceneWanted(QString file);

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    QWidget* makeSamples();
    void arrange(int columns);

    QFrame* dropArea_;
    QLabel* recentTitle_;
    QVBoxLayout* recent_;
    QGridLayout* grid_ = nullptr;
    std::vector<QToolButton*> samples_;
    int columns_ = 0;
};

} // namespace lightloom
