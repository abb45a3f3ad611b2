// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <glm/glm.hpp>

/// The shading maths of the shaders, compiled as C++ (docs/architecture.md): one text, two compilers. Held equal to
/// the GPU's by tests/tst_gui_shader_twins. Each function's comment stands in its .glsl file.
namespace lightloom::shader {
using namespace glm;
#define SHARED [[nodiscard]] inline
// shared_limits before common_colour, which uses it; the rest know nothing of each other
// clang-format off
#include "shaders/shared_limits.glsl"
#include "shaders/common_colour.glsl"
#include "shaders/common_false_colour.glsl"
#include "shaders/common_ivg.glsl"
#include "shaders/common_octree.glsl"
#include "shaders/common_shading.glsl"
#include "shaders/common_vdl.glsl"
// clang-format on
#undef SHARED
} // namespace lightloom::shader
