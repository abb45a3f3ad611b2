// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/start_page.h"
#include <QCoreApplication>
#include <QDir>
#include <QFileInfo>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

namespace lightloom {

QStringList sampleSceneFiles()
{
    const QString here = QCoreApplication::applicationDirPath();
    // installed beside the program, or run from a build folder inside the sources
    for (const char* place : {"/../share/lightloom/sample_scenes", "/sample_scenes", "/../sample_scenes",
                              "/../../sample_scenes", "/../../../sample_scenes"}) {
        const QDir folder(here + place);
        QStringList files;
        for (const QFileInfo& info : folder.entryInfoList({"*.glb", "*.gltf"}, QDir::Files, QDir::Name)) {
            files += info.canonicalFilePath();
        }
        if (!files.isEmpty()) return files;
    }
    return {};
}

QString sceneTitle(const QString& file) { return QFileInfo(file).completeBaseName().replace('_', ' '); }

StartPage::StartPage(QWidget* parent) : QWidget(parent)
{
    auto* column = new QVBoxLayout(this);
    column->addStretch(2);
    auto* sentence = new QLabel(tr("Drop a glTF scene here, or open one, and walk through its light."));
    sentence->setAlignment(Qt::AlignCenter);
    sentence->setWordWrap(true);
    QFont font = sentence->font();
    font.setPointSizeF(font.pointSizeF() * 1.4);
    sentence->setFont(font);
    column->addWidget(sentence);
    const auto addButton = [&](const QString& text, const QString& tip) {
        auto* button = new QPushButton(text);
        button->setToolTip(tip);
        button->setMinimumWidth(220);
        column->addWidget(button, 0, Qt::AlignCenter);
        return button;
    };
    connect(addButton(tr("Open a scene..."), tr("glTF 2.0, .glb or .gltf (Ctrl+O)")), &QPushButton::clicked, this,
            &StartPage::openWanted);
    const QStringList samples = sampleSceneFiles();
    if (!samples.isEmpty()) {
        column->addSpacing(16);
        auto* title = new QLabel(tr("Sample scenes"));
        title->setAlignment(Qt::AlignCenter);
        column->addWidget(title);
    }
    for (const QString& file : samples) {
        connect(addButton(sceneTitle(file), file), &QPushButton::clicked, this,
                [this, file] { Q_EMIT sampleWanted(file); });
    }
    column->addStretch(3);
}

} // namespace lightloom
