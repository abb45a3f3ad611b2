// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/theme.h"
#include <QApplication>
#include <QPalette>
#include <QStyleFactory>
#include <QToolTip>

namespace lightloom {

namespace {

QColor grey(int value) { return {value, value, value}; }

struct Greys {
    int window, base, alternate, button, text, faint, edge;
    QColor accent, onAccent, link;
};

QPalette paletteOf(const Greys& g)
{
    QPalette p;
    p.setColor(QPalette::Window, grey(g.window));
    p.setColor(QPalette::WindowText, grey(g.text));
    p.setColor(QPalette::Base, grey(g.base));
    p.setColor(QPalette::AlternateBase, grey(g.alternate));
    p.setColor(QPalette::Text, grey(g.text));
    p.setColor(QPalette::PlaceholderText, grey(g.faint));
    p.setColor(QPalette::Button, grey(g.button));
    p.setColor(QPalette::ButtonText, grey(g.text));
    p.setColor(QPalette::BrightText, Qt::white);
    p.setColor(QPalette::ToolTipBase, grey(g.alternate));
    p.setColor(QPalette::ToolTipText, grey(g.text));
    p.setColor(QPalette::Highlight, g.accent);
    p.setColor(QPalette::HighlightedText, g.onAccent);
    p.setColor(QPalette::Link, g.link);
    p.setColor(QPalette::Light, grey(g.button).lighter(125));
    p.setColor(QPalette::Midlight, grey(g.button).lighter(112));
    p.setColor(QPalette::Mid, grey(g.edge));
    p.setColor(QPalette::Dark, grey(g.edge).darker(130));
    p.setColor(QPalette::Shadow, grey(g.edge).darker(180));
    for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText}) {
        p.setColor(QPalette::Disabled, role, grey(g.faint));
    }
    p.setColor(QPalette::Disabled, QPalette::Highlight, grey(g.edge));
    return p;
}

} // namespace

void applyTheme(Theme theme)
{
    QApplication::setStyle(QStyleFactory::create(QStringLiteral("Fusion")));
    const Greys dark{50, 38, 58, 66, 226, 165, 30, QColor(38, 110, 160), Qt::white, QColor(120, 190, 235)};
    const Greys light{236, 250, 226, 228, 24, 100, 170, QColor(24, 96, 150), Qt::white, QColor(20, 90, 150)};
    QApplication::setPalette(paletteOf(theme == Theme::dark ? dark : light));
    QToolTip::setPalette(QApplication::palette());
    // Fusion shows a pressed-in button by a hint of grey; what is active must be plain to see
    const QColor accent = theme == Theme::dark ? dark.accent : light.accent;
    qApp->setStyleSheet(QStringLiteral("QToolButton:checked { background: %1; color: white; border: 1px solid %1; "
                                       "border-radius: 2px; padding: 3px; }"
                                       "QToolButton[popupMode=\"1\"]:checked { padding-right: 16px; }"
                                       "QStatusBar::item { border: none; } QStatusBar QLabel { padding: 0 6px; }")
                            .arg(accent.name()));
}

glm::vec3 viewportBackground(Theme theme) { return glm::vec3(theme == Theme::dark ? 0.11f : 0.62f); }

} // namespace lightloom
