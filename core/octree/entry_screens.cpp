// SPDX-License-Identifier: Apache-2.0
#include "core/octree/entry_screens.h"
#include "core/trace/cell_clip.h"
#include <algorithm>

namespace lightloom {
namespace {

constexpr float kHeight = 0.25f; ///< cells above the surface, where walls are looked for

/// One entry's part in the new geometry.
struct Found {
    bool isSeen = false;
    glm::vec3 centroid{0.0f};
    std::vector<Screen> screens;
};

class EntryScreens {
public:
    EntryScreens(OctreeGeometry& geometry, const ScreenFinder& finder)
        : geometry_(geometry), finder_(finder), cell_(geometry.cellSize()), reach_(kScreenReach * geometry.rootSize),
          found_(geometry.entries.size())
    {
    }

    void lookFrom(std::size_t leaf)
    {
        BoxGroups::Box box;
        const glm::vec3 low = geometry_.lowest + cell_ * glm::vec3(mortonCell(geometry_.cells[leaf]));
        box.add(low), box.add(low + cell_);
        for (std::uint32_t e = geometry_.firstEntry[leaf]; e < geometry_.firstEntry[leaf + 1]; ++e) {
            const OctreeEntry& entry = geometry_.entries[e];
            Found& found = found_[e];
            found.centroid = entry.centroid;
            found.isSeen = find(found, entry.normal);
            if (found.isSeen) continue;
            const auto place = finder_.seenPlace(entry.centroid, entry.normal, kHeight * cell_, box);
            if (!place) continue;
            found.centroid = *place;
            found.isSeen = find(found, entry.normal);
        }
    }

    /// Leaves and entries that are seen, in the order they had.
    void finish()
    {
        OctreeGeometry seen;
        seen.depth = geometry_.depth, seen.lowest = geometry_.lowest, seen.rootSize = geometry_.rootSize;
        seen.firstScreen.push_back(0);
        for (std::size_t leaf = 0; leaf < geometry_.cells.size(); ++leaf) {
            const std::size_t before = seen.entries.size();
            for (std::uint32_t e = geometry_.firstEntry[leaf]; e < geometry_.firstEntry[leaf + 1]; ++e) {
                const Found& found = found_[e];
                if (!found.isSeen) continue;
                seen.entries.push_back(geometry_.entries[e]);
                seen.entries.back().centroid = found.centroid;
                seen.screens.insert(seen.screens.end(), found.screens.begin(), found.screens.end());
                seen.firstScreen.push_back(static_cast<std::uint32_t>(seen.screens.size()));
            }
            if (seen.entries.size() == before) continue;
            seen.cells.push_back(geometry_.cells[leaf]);
            seen.firstEntry.push_back(static_cast<std::uint32_t>(before));
        }
        seen.firstEntry.push_back(static_cast<std::uint32_t>(seen.entries.size()));
        geometry_ = std::move(seen);
    }

private:
    bool find(Found& found, glm::vec3 normal) const
    {
        return finder_.find(found.centroid, normal, kHeight * cell_, reach_, found.screens);
    }

    OctreeGeometry& geometry_;
    const ScreenFinder& finder_;
    float cell_, reach_;
    std::vector<Found> found_;
};

} // namespace

bool findScreens(OctreeGeometry& geometry, const ScreenFinder& finder, Workers& workers, const std::stop_token& stop)
{
    constexpr std::size_t kBlock = 8;
    const std::size_t count = geometry.cells.size();
    EntryScreens screens(geometry, finder);
    const bool all = workers.run((count + kBlock - 1) / kBlock, stop, [&](std::size_t block) {
        for (std::size_t leaf = block * kBlock; leaf < std::min(count, (block + 1) * kBlock); ++leaf) {
            if (stop.stop_requested()) return;
            screens.lookFrom(leaf);
        }
    });
    if (!all || stop.stop_requested()) return false;
    screens.finish();
    return true;
}

} // namespace lightloom
