// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/ivg/grid_layer.h"
#include "core/trace/photon_segments.h"

namespace lightloom {

/// Sums photons that pass through a grid (RR-6983, section 3.3; docs/methods/irradiance-grid.md):
///   crossings  Phi w / (A |w . delta|) at every face crossed; along delta that is Phi / A exactly, across it |w .
///   delta|
///              counts as at least kLeastCosine
///   tracks     Phi w s / V for the way s in every cell passed, for the three directions that w has a part along
///   paper      Phi w / A at every face crossed
/// with A and V what is open of faces and cells. Threads share out the planes of the grid, not the photons: every sum
/// is made in the photons' order, by one thread, so results are the same bits on any number of threads and no sum is
/// kept twice. Sums of a call are in float, and are added to totals in double.
class GridDeposit {
public:
    static constexpr float kLeastCosine = 0.02f;

    GridDeposit(std::shared_ptr<const GridGeometry> geometry, GridEstimator estimator);
    GridDeposit(const GridDeposit&) = delete;
    GridDeposit& operator=(const GridDeposit&) = delete;
    ~GridDeposit();

    /// Empty totals of another light group. Both work in the same memory: not at the same time.
    [[nodiscard]] std::unique_ptr<GridDeposit> another() const;

    /// Adds all segments. The same segments in the same calls give the same bits. False: stopped, do not use further.
    bool add(std::span<const SegmentBlock* const> blocks, Workers& workers, const std::stop_token& stop);
    [[nodiscard]] const std::shared_ptr<const GridGeometry>& geometry() const;
    [[nodiscard]] GridEstimator estimator() const;
    [[nodiscard]] std::uint64_t deposits() const; ///< faces crossed or cells passed so far, outside of walls

    /// What was added so far, times `scale`, as light of a group.
    [[nodiscard]] GridLayer layer(int group, double scale = 1.0) const;

    /// Bytes that sums take while light groups are baked together, beside lists of a call's segments.
    [[nodiscard]] static double bytesFor(const GridLattice& lattice, GridEstimator estimator, int groups);
    /// Bytes of a call's lists, per segment.
    [[nodiscard]] static double bytesPerSegment();

private:
    struct Work;
    explicit GridDeposit(std::shared_ptr<Work> work);
    std::shared_ptr<Work> work_;
    std::vector<std::array<double, 12>> totals_; ///< by slot
    std::uint64_t deposits_ = 0;
};

} // namespace lightloom
