// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/draw_data.h"

namespace lightloom {

inline constexpr int kMostCubeLayers = 128; ///< of shadow maps; GL 3.3 promises 256

/// Fills `lights` and what is said of them from the scene's lamps. Pure CPU, any thread.
void addPreviewLights(DrawData& data);
/// The same where punctual lamps alone are others than before, as many: surfaces are not looked at again.
void movePreviewLights(DrawData& data);

} // namespace lightloom
