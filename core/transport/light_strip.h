// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/bright_entries.h"
#include "core/transport/entry_values.h"
#include "core/transport/partner_gather.h"

namespace lightloom {

/// Light groups that bounce together, up to five: their channels fill a cache line. A group's values do not depend on
/// those beside it. All is by row of a RowOrder but what comes in and goes out.
class LightStrip {
public:
    static constexpr std::size_t kMostGroups = 5, kMostChannels = 3 * kMostGroups;
    /// Channels of `radiosity` from `firstChannel` on, as many as there are and fit in; `albedo` by entry. `order` must
    /// outlive this.
    LightStrip(const RowOrder& order, std::span<const glm::vec3> albedo, const EntryValues& radiosity,
               std::size_t firstChannel);
    /// The most that one takes.
    [[nodiscard]] static std::size_t bytesFor(std::size_t entries);

    /// Before what `directions` bring is gathered. `looksForBright`: what few entries send by far the most of goes
    /// another way.
    void beginBounce(std::size_t directions, bool looksForBright);
    /// Adds what arrives at rows [first, end) along the directions of blocks. Several threads may call it for rows of
    /// their own.
    void gather(std::span<const PartnerBlock* const> blocks, std::span<const BlockDirections> directions,
                std::size_t first, std::size_t end)
    {
        gatherRows(blocks, directions, order_.orientations, first, end, leaving_, arriving_, cosines_);
    }
    /// Once all is gathered: what arrives at rows [first, end), and from bright entries straight by shadow rays.
    /// Several threads may call it for rows of their own.
    void arrive(const RayScene& rays, const SurfaceVoxels& voxels, std::size_t first, std::size_t end);
    /// For bounces that carry on at once what has arrived at rows [first, end). At the first one what left them
    /// before is still to be met by others; later ones have carried that on.
    void passOn(std::size_t first, std::size_t end, bool isFirst);
    /// Adds to the result what has arrived, and reflects it. A group ends with a bounce that adds no more than
    /// `leastGain` of the sum, or is the last; what would still come is added as a geometric series. True: all have.
    bool endBounce(float leastGain, bool isLast);
    /// The sums of all bounces, lux, into their channels of `lux`.
    void writeTo(EntryValues& lux) const;

private:
    struct Group {
        double sum = 0.0, before = 0.0; // lumen of all bounces, of the last one
        bool isDone = false;
        std::vector<BrightEntry> bright;
    };
    void takeBright(std::size_t group, std::size_t directions);
    [[nodiscard]] std::vector<double> lumenArrived() const;

    const RowOrder& order_;
    std::size_t firstChannel_, channels_;
    ChannelLines albedo_, leaving_, arriving_, all_;
    std::vector<float> cosines_;
    std::vector<Group> groups_;
};

} // namespace lightloom
