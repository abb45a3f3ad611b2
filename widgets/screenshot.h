// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <QString>

namespace lightloom {

class MainWindow;

/// Opens `scene` (empty: none) in the shown window, waits for its first picture (or, with `final`, for the last depth)
/// to settle, writes the window to `file` as PNG, and gives the program's exit code. Runs the event loop.
[[nodiscard]] int takeScreenshot(MainWindow& window, const QString& scene, const QString& file, bool final);

} // namespace lightloom
