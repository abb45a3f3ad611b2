// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/params/bake_params.h"

namespace lightloom::test {

/// A grid of `size` cells along the longest side, from so many photons a lamp.
inline BakeParams gridParams(int size, int photons)
{
    BakeParams p;
    p.gridSize = size;
    p.photonCount = photons;
    return p;
}

} // namespace lightloom::test
