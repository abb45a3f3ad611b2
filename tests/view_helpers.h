// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/render_view.h"
#include <cstring>

/// What tests of pictures share.
namespace lightloom::test {

inline bool sameBits(const FloatImage& a, const FloatImage& b)
{
    return a.isSameSize(b) && std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(glm::vec3)) == 0;
}

inline bool sameBits(const View& a, const View& b)
{
    return sameBits(a.direct, b.direct) && sameBits(a.indirect, b.indirect) &&
           sameBits(a.standardError, b.standardError) && a.rays == b.rays && a.isWhole == b.isWhole &&
           a.causticRounds == b.causticRounds;
}

} // namespace lightloom::test
