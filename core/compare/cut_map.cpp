// SPDX-License-Identifier: Apache-2.0
#include "core/compare/cut_map.h"
#include "core/compare/legend.h"
#include <algorithm>
#include <numeric>

namespace lightloom {

float CutMap::top() const { return std::max(1.0f, legendTop(sizes)); }

CutMap cutMap(const View& picture)
{
    CutMap out;
    if (picture.cutSizes.empty()) return out;
    out.sizes = {picture.direct.width, picture.direct.height, {picture.cutSizes.begin(), picture.cutSizes.end()}};
    std::vector<int> sizes = picture.cutSizes;
    std::erase(sizes, 0);
    if (sizes.empty()) return out;
    out.pixels = sizes.size();
    out.mean = std::accumulate(sizes.begin(), sizes.end(), 0.0) / static_cast<double>(sizes.size());
    const auto p99 = sizes.begin() + static_cast<std::ptrdiff_t>((99 * sizes.size() + 99) / 100 - 1);
    std::ranges::nth_element(sizes, p99);
    out.p99 = *p99;
    out.most = std::ranges::max(sizes);
    return out;
}

} // namespace lightloom
