// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/wide_vectors.h"
#include "core/photonmap/screens.h"

namespace lightloom {

/// `isHidden` for eight points at once, with the same bits: clears the lanes of those that are hidden in `kept`.
/// For functions compiled for wide vectors.
[[gnu::always_inline]] inline void dropHidden(Screens screens, const Floats8& x, const Floats8& y, const Floats8& z,
                                              Ints8& kept)
{
    for (const Screen& screen : screens) {
        const glm::vec3 away = screen.away, low = screen.sides[0], high = screen.sides[1];
        const Floats8 far = x * away.x + y * away.y + z * away.z;
        const Floats8 left = x * low.x + y * low.y + z * low.z, right = x * high.x + y * high.y + z * high.z;
        kept &= ~((far > screen.behind) & (left >= 0.0f) & (right >= 0.0f));
    }
}

} // namespace lightloom
