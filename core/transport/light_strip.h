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
    /// `leastGain` of the sum, or is the last, or after which each entry's light goes on as a geometric series so
    /// nearly that in place of all further bounces it would be off by `seriesOff` times `leastGain` of the entry's sum,
    /// on average. What would still come is added as that series, each channel by itself. True: all have ended.
    bool endBounce(float leastGain, float seriesOff, bool isLast);
    /// The sums of all bounces, lux, into their channels of `lux`.
    void writeTo(EntryValues& lux) const;

private:
    struct Group {
        double sum = 0.0; // lumen of all bounces
        bool isDone = false;
        std::vector<BrightEntry> bright;
    };
    void takeBright(std::size_t group, std::size_t directions);
    [[nodiscard]] std::vector<double> lumenArrived() const;
    [[nodiscard]] double offBySeries(std::size_t group, std::span<const double> shares) const;

    const RowOrder& order_;
    std::size_t firstChannel_, channels_;
    ChannelLines albedo_, leaving_, arriving_, before_, all_; // lux of the bounce, of the one before, of all
    std::vector<float> cosines_;
    std::vector<double> lumenBefore_; // by channel
    std::vector<Group> groups_;
};

} // namespace lightloom
