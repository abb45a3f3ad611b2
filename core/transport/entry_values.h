// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <vector>

namespace lightloom {

/// Values by voxel entry, `channels` of each: red, green and blue of one light group after the other.
struct EntryValues {
    int channels = 3;
    std::vector<float> values; ///< entry e, channel c: values[e * channels + c]
    [[nodiscard]] std::size_t entries() const { return values.size() / static_cast<std::size_t>(channels); }
};

} // namespace lightloom
