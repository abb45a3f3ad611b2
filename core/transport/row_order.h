// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/surface_voxels.h"
#include <span>

namespace lightloom {

/// The order of entries where light is summed over partners. Those of one normal follow each other, walls as a whole,
/// so that cosines are computed once for many; those of a normal that few share come last. Within both as they are
/// numbered. Sums take half as long as with entries as they are numbered (docs/measurements.md).
struct RowOrder {
    std::vector<std::uint32_t> entryOf;    ///< by row
    std::vector<std::uint32_t> rowOf;      ///< by entry; one more at the end, for no entry: the number of all rows
    std::vector<Orientation> orientations; ///< by row

    RowOrder() = default;
    /// O(entries).
    explicit RowOrder(std::span<const Orientation> entries);
    [[nodiscard]] std::size_t size() const { return entryOf.size(); }
    [[nodiscard]] std::size_t memoryBytes() const;
};

} // namespace lightloom
