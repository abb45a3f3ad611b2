// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace lightloom {

/// Values by voxel entry, `channels` of each: red, green and blue of one light group after the other.
struct EntryValues {
    int channels = 3;
    std::vector<float> values; ///< entry e, channel c: values[e * channels + c]
    [[nodiscard]] std::size_t entries() const { return values.size() / static_cast<std::size_t>(channels); }
    /// Red, green and blue from values[i] on.
    [[nodiscard]] glm::vec3 groupAt(std::size_t i) const { return {values[i], values[i + 1], values[i + 2]}; }
};

} // namespace lightloom
