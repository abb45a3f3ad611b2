// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/sample_scenes.h"
#include <optional>
#include <string>

namespace lightloom {

/// A sample scene as benches are told it: NAME, or NAME:TRIANGLES.
inline Result<Scene> benchScene(const std::string& name)
{
    const std::size_t colon = name.find(':');
    std::optional<std::uint64_t> triangles;
    if (colon != std::string::npos) triangles = std::stoull(name.substr(colon + 1));
    return sampleScene(name.substr(0, colon), triangles);
}

} // namespace lightloom
