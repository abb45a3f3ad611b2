// SPDX-License-Identifier: GPL-3.0-or-later
// What the window remembers from one day to the next: place and size, docks, theme, tone curve, files.
#include "core/params/param_text.h"
#include "widgets/main_window.h"
#include "widgets/panel_parts.h"
#include "widgets/start_page.h"
#include "widgets/viewport.h"
#include <QAction>
#include <QActionGroup>
#include <QFileInfo>
#include <QGuiApplication>
#include <QMenu>
#include <QScreen>
#include <QSettings>

namespace lightloom {

namespace {

constexpr int kMostRecent = 8;
constexpr QSize kFirstSize(1280, 800);

} // namespace

void MainWindow::setTheme(Theme theme)
{
    applyTheme(theme);
    if (viewport_ != nullptr) viewport_->setBackground(viewportBackground(theme));
}

void MainWindow::restore()
{
    const bool isLight = settings_ != nullptr && settings_->value("lightTheme", false).toBool();
    {
        const QSignalBlocker quiet(lightTheme_);
        lightTheme_->setChecked(isLight);
    }
    setTheme(isLight ? Theme::light : Theme::dark);
    const QScreen* screen = QGuiApplication::primaryScreen();
    resize(screen != nullptr ? kFirstSize.boundedTo(screen->availableSize() - QSize(0, 30)) : kFirstSize);
    if (settings_ == nullptr) return;
    restoreGeometry(settings_->value("geometry").toByteArray()); // keeps to the screens there are today
    docks_ = settings_->value("docks").toByteArray();
    tones_->actions()[settings_->value("tone", 1).toInt() == 0 ? 0 : 1]->setChecked(true);
    const Result<Method> method = methodNamed(settings_->value("method").toString().toStdString());
    if (method) (void)showMethod(*method);
}

void MainWindow::remember()
{
    if (settings_ == nullptr) return;
    if (data_) docks_ = saveState(); // without a scene they are hidden
    settings_->setValue("geometry", saveGeometry());
    if (!docks_.isEmpty()) settings_->setValue("docks", docks_);
    settings_->setValue("method", QString::fromStdString(std::string(methodName(method_))));
    settings_->setValue("lightTheme", lightTheme_->isChecked());
    settings_->setValue("tone", tones_->actions().indexOf(tones_->checkedAction()));
}

void MainWindow::rememberFile(const QString& file)
{
    if (settings_ == nullptr) return;
    const QString full = QFileInfo(file).absoluteFilePath();
    QStringList files = settings_->value("recent").toStringList();
    files.removeAll(full);
    files.prepend(full);
    settings_->setValue("recent", QStringList(files.mid(0, kMostRecent)));
    settings_->setValue("folder", QFileInfo(full).absolutePath());
    fillRecent();
}

void MainWindow::fillRecent()
{
    recent_->clear();
    const QStringList files = settings_ != nullptr ? settings_->value("recent").toStringList() : QStringList();
    for (const QString& file : files) {
        recent_->addAction(shortName(QFileInfo(file).fileName()), this, [this, file] { openScene(file); })
            ->setStatusTip(file);
    }
    recent_->setEnabled(!files.isEmpty());
    startPage_->setRecent(files);
}

} // namespace lightloom
