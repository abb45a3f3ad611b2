// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/scene/scene.h"
#include "widgets/gl/mark_pass.h"
#include "widgets/sight_line.h"
#include <vector>

namespace lightloom {

/// What of a lamp is taken hold of.
enum class LampHandle {
    none,
    x, ///< moves along an axis of the scene
    y,
    z,
    free, ///< moves in the plane across the line of sight
    aim   ///< turns spots and suns
};

/// A handle as lines in the scene: what is drawn, and what the mouse may come near.
struct HandleLine {
    LampHandle handle = LampHandle::none;
    glm::vec3 a{0.0f}, b{0.0f};
};

/// Where a lamp is taken hold of: its place, or for suns, which have none, `anchor`.
[[nodiscard]] glm::vec3 lampPlace(const PunctualLight& lamp, glm::vec3 anchor);
/// The handles of a lamp, `size` metres long: arrows along the axes and a square for what has a place, a line with a
/// knob at its end for what has a direction.
[[nodiscard]] std::vector<HandleLine> handlesOf(const PunctualLight& lamp, glm::vec3 anchor, float size);
/// `start` after its handle was dragged from one line of sight to another. Moves come by the change between both lines,
/// so that a lamp does not jump to the cursor. Lines that miss an axis or a plane leave the lamp as it was.
[[nodiscard]] PunctualLight dragged(const PunctualLight& start, LampHandle handle, glm::vec3 anchor, float size,
                                    const SightLine& from, const SightLine& to);

/// How lamps look in the picture: a small star for points, a cone for spots, a sheaf of arrows for suns.
[[nodiscard]] std::vector<Mark> markerOf(const PunctualLight& lamp, glm::vec3 anchor, float size, glm::vec4 colour);
/// Handles as marks; `held` stands out.
[[nodiscard]] std::vector<Mark> marksOf(const std::vector<HandleLine>& handles, LampHandle held);
/// By light group, edges of its glowing surfaces that belong to one triangle only; their bounding boxes where they are
/// closed or have very many triangles. At most 8,000 lines: in scenes with very many glowing surfaces the last have
/// none.
[[nodiscard]] std::vector<std::vector<HandleLine>> outlinesOf(const Scene& scene);

} // namespace lightloom
