// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <QString>
#include <initializer_list>

class QAction;
class QHBoxLayout;
class QLabel;
class QProgressBar;

/// What panels that follow a job have in common.
namespace lightloom {

/// A row of equally wide buttons, one for each action.
[[nodiscard]] QHBoxLayout* actionButtons(std::initializer_list<QAction*> actions);
/// A thin bar without words.
[[nodiscard]] QProgressBar* thinProgress(const QString& accessibleName);
void setFraction(QProgressBar& bar, double fraction); ///< of a `thinProgress`
/// Several lines of text that can be copied.
[[nodiscard]] QLabel* textLines();

/// `text` with places where words that are too long for a line may break: else a label is as wide as the longest.
[[nodiscard]] QString breakable(const QString& text);

/// A file's name for buttons and menus: the middle of a very long one is left out.
[[nodiscard]] QString shortName(const QString& name);

} // namespace lightloom
