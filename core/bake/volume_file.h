// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/bake_file.h"
#include "core/bake/vdb_file.h"
#include <functional>

namespace lightloom {

/// Bytes of a plain OpenVDB file for other programs that says method, parameters, scene and unit in its metadata and
/// holds what `addGrids` adds. The same grids give the same bytes. Errors: out of memory; what `addGrids` throws.
[[nodiscard]] Result<std::vector<std::uint8_t>> volumeBytes(const BakeInfo& info,
                                                            const std::function<void(VdbFile&)>& addGrids);

} // namespace lightloom
