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

} // namespace lightloom
