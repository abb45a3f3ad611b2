// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/base/result.h"

namespace lightloom {

/// Asks Qt for OpenGL 3.3 core everywhere. Call before the application object is made.
void setDefaultGlFormat();

/// Whether a viewport can be shown here: the platform has OpenGL, and a context that was really made is 3.3 or newer
/// (Qt hands out older ones and says nothing). On "offscreen", "minimal" and "vnc" a shown QOpenGLWidget crashes
/// inside Qt 6.4, so these are refused by name. The message is for the user. UI thread.
[[nodiscard]] Result<Done> probeGl();

} // namespace lightloom
