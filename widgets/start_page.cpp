// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/start_page.h"
#include "widgets/panel_parts.h"
#include <QCoreApplication>
#include <QDir>
#include <QFileInfo>
#include <QFrame>
#include <QGridLayout>
#include <QIcon>
#include <QLabel>
#include <QPushButton>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

namespace lightloom {

namespace {

constexpr QSize kPicture(208, 130);
constexpr int kMostColumns = 3, kMostRecent = 4;

QLabel* titled(const QString& text)
{
    auto* label = new QLabel(QStringLiteral("<b>%1</b>").arg(text));
    label->setAlignment(Qt::AlignCenter);
    return label;
}

} // namespace

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

StartPage::StartPage(QWidget* parent)
    : QScrollArea(parent), dropArea_(new QFrame), recentTitle_(titled(tr("Opened lately"))), recent_(new QVBoxLayout)
{
    setWidgetResizable(true);
    setFrameShape(QFrame::NoFrame);
    auto* sentence = new QLabel(tr("Drop a glTF scene here, or open one, and walk through its light."));
    sentence->setAlignment(Qt::AlignCenter);
    QFont font = sentence->font();
    font.setPointSizeF(font.pointSizeF() * 1.4);
    sentence->setFont(font);
    auto* open = new QPushButton(tr("Open a scene..."));
    open->setToolTip(tr("glTF 2.0, .glb or .gltf (Ctrl+O)"));
    connect(open, &QPushButton::clicked, this, &StartPage::openWanted);
    dropArea_->setObjectName(QStringLiteral("dropArea"));
    auto* drop = new QVBoxLayout(dropArea_);
    drop->setContentsMargins(24, 28, 24, 28);
    drop->addWidget(sentence);
    drop->addSpacing(8);
    drop->addWidget(open, 0, Qt::AlignCenter);
    setDropping(false);

    auto* inside = new QWidget;
    auto* column = new QVBoxLayout(inside);
    column->setSpacing(14);
    column->addStretch(1);
    column->addWidget(dropArea_, 0, Qt::AlignHCenter);
    if (QWidget* samples = makeSamples()) {
        column->addWidget(titled(tr("Sample scenes")));
        column->addWidget(samples, 0, Qt::AlignHCenter);
    }
    column->addWidget(recentTitle_);
    column->addLayout(recent_);
    column->addStretch(2);
    setWidget(inside);
    setRecent({});
}

QWidget* StartPage::makeSamples()
{
    const QStringList files = sampleSceneFiles();
    if (files.isEmpty()) return nullptr;
    auto* samples = new QWidget;
    grid_ = new QGridLayout(samples);
    for (const QString& file : files) {
        const QFileInfo info(file);
        auto* button = new QToolButton;
        button->setObjectName("sample." + info.completeBaseName());
        button->setText(sceneTitle(file));
        button->setToolTip(file);
        button->setAutoRaise(true);
        const QString picture = info.dir().filePath("pictures/" + info.completeBaseName() + ".png");
        if (QFileInfo::exists(picture)) {
            button->setIcon(QIcon(picture));
            button->setIconSize(kPicture);
            button->setToolButtonStyle(Qt::ToolButtonTextUnderIcon);
        }
        connect(button, &QToolButton::clicked, this, [this, file] { Q_EMIT sceneWanted(file); });
        samples_.push_back(button);
    }
    arrange(kMostColumns);
    return samples;
}

void StartPage::arrange(int columns)
{
    if (columns == columns_) return;
    columns_ = columns;
    int number = 0;
    for (QToolButton* sample : samples_) {
        grid_->addWidget(sample, number / columns, number % columns); // moves what is there already
        ++number;
    }
}

void StartPage::resizeEvent(QResizeEvent* event)
{
    QScrollArea::resizeEvent(event);
    if (samples_.empty()) return;
    const int each = samples_.front()->sizeHint().width() + 16;
    arrange(std::clamp((viewport()->width() - 40) / each, 1, kMostColumns));
}

void StartPage::setRecent(const QStringList& files)
{
    while (QLayoutItem* item = recent_->takeAt(0)) {
        delete item->widget();
        delete item;
    }
    for (const QString& file : files.mid(0, kMostRecent)) {
        auto* button = new QToolButton;
        button->setAutoRaise(true);
        button->setText(shortName(QFileInfo(file).fileName()));
        button->setToolTip(file);
        // queued: opening may end in this list being made anew, and with it the button
        connect(
            button, &QToolButton::clicked, this, [this, file] { Q_EMIT sceneWanted(file); }, Qt::QueuedConnection);
        recent_->addWidget(button, 0, Qt::AlignHCenter);
    }
    recentTitle_->setVisible(!files.isEmpty());
}

void StartPage::setDropping(bool isOver)
{
    dropArea_->setStyleSheet(QStringLiteral("#dropArea { border: 2px dashed palette(%1); border-radius: 8px; }")
                                 .arg(isOver ? QStringLiteral("link") : QStringLiteral("mid")));
}

} // namespace lightloom
