// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/panel_parts.h"
#include <QAction>
#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QToolButton>

namespace lightloom {

namespace {
constexpr int kSteps = 1000;
}

QHBoxLayout* actionButtons(std::initializer_list<QAction*> actions)
{
    auto* row = new QHBoxLayout;
    for (QAction* action : actions) {
        auto* button = new QToolButton;
        button->setDefaultAction(action);
        button->setToolButtonStyle(Qt::ToolButtonTextOnly);
        button->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
        row->addWidget(button);
    }
    return row;
}

QProgressBar* thinProgress(const QString& accessibleName)
{
    auto* bar = new QProgressBar;
    bar->setRange(0, kSteps);
    bar->setTextVisible(false);
    bar->setMaximumHeight(10);
    bar->setAccessibleName(accessibleName);
    return bar;
}

void setFraction(QProgressBar& bar, double fraction) { bar.setValue(static_cast<int>(fraction * kSteps)); }

QLabel* textLines()
{
    auto* label = new QLabel;
    label->setWordWrap(true);
    label->setTextInteractionFlags(Qt::TextSelectableByMouse);
    return label;
}

QString breakable(const QString& text)
{
    constexpr int kMost = 24;
    QString out;
    int run = 0;
    for (const QChar c : text) {
        run = c.isSpace() ? 0 : run + 1;
        out += c;
        if (run < kMost) continue;
        out += QChar(0x200b); // a space of no width
        run = 0;
    }
    return out;
}

QString shortName(const QString& name)
{
    constexpr int kStart = 28, kEnd = 24;
    if (name.size() <= kStart + kEnd) return name;
    return name.left(kStart) + QChar(0x2026) + name.right(kEnd);
}

} // namespace lightloom
