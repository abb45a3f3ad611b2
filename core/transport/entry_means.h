// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/base/wide_vectors.h"
#include "core/transport/entry_values.h"
#include "core/transport/surface_voxels.h"

namespace lightloom {

/// Weighted means over entries: entry e takes `part` of the value of entry `from`, for all in
/// [first[e], first[e + 1]); parts of an entry add up to 1. Of the surface alone, whatever light falls on it.
struct EntryMeans {
    std::vector<std::uint32_t> first, from;
    std::vector<float> part;
    /// The means of `values` (none negative), of each light group by itself. What differs by `within` or more, as a
    /// share of the brighter one's luminance, is other light and left out, what differs by less counts the less, by a
    /// parabola; so that shadows keep their edges (infinite: all counts). The same bits on any number of threads.
    /// Empty: stopped.
    [[nodiscard]] EntryValues of(const EntryValues& values, float within, Workers& workers,
                                 const std::stop_token& stop) const;

private:
    /// Of values and their luminance by entry.
    [[nodiscard]] Floats4 meanAt(std::size_t e, std::span<const Floats4> lit) const;
    [[nodiscard]] Floats4 meanWithin(std::size_t e, std::span<const Floats4> lit, float within) const;
};

/// Over the entries of the voxel and its 26 neighbours that belong to the same surface: their normals are within 45
/// degrees, and each lies within half a cell of the other's plane, so that neither the two sides of a wall nor two
/// steps mix. Weights: area times a tent, two cells wide each way along each axis. O(entries). Null: stopped.
[[nodiscard]] std::shared_ptr<const EntryMeans> neighbourMeans(const SurfaceVoxels& voxels, Workers& workers,
                                                               const std::stop_token& stop);

/// Slivers, entries smaller than `share` of a voxel's face, each together with the largest of such neighbours that is
/// none itself, where there is one: all of such a group take its mean by area, which keeps the flux. What is left over
/// of a wall beyond a cell's border is lit and met as little as it is large; its own light is mostly noise. O(entries).
/// Null: stopped.
[[nodiscard]] std::shared_ptr<const EntryMeans> sliverMeans(const SurfaceVoxels& voxels, float share, Workers& workers,
                                                            const std::stop_token& stop);

} // namespace lightloom
