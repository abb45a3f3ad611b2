// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/render_view.h"
#include "core/compare/image_error.h"

namespace lightloom {

/// Where in a picture lightcuts are dear: clusters and lights in the cut of each pixel, and over all that have one.
struct CutMap {
    ScalarImage sizes;      ///< 0: no cut
    std::size_t pixels = 0; ///< with a cut
    double mean = 0.0;
    int p99 = 0, most = 0;           ///< nearest rank
    [[nodiscard]] float top() const; ///< end of a legend that suits the map
};

/// Of a picture that is not by lightcuts: no pixels.
[[nodiscard]] CutMap cutMap(const View& picture);

} // namespace lightloom
