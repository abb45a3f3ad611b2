// SPDX-License-Identifier: Apache-2.0
#include "core/octree/entry_screens.h"
#include "core/base/units.h"
#include "core/octree/entry_side.h"
#include "core/octree/octree_build.h"
#include "core/trace/cell_clip.h"
#include <algorithm>
#include <cmath>

namespace lightloom {
namespace {

constexpr float kHeight = 0.25f;        ///< cells above the surface, where walls are looked for
constexpr float kSideReach = 1.75f;     ///< cells that lookups read across, nearly
constexpr float kUpright = 0.35f;       ///< cosine from a surface's normal to that of a wall that stands on it
constexpr float kWideWall = kPi / 3.0f; ///< of what an entry sees; the leg of a table parts no surface

float angleOf(const Screen& screen)
{
    const float cosine = -glm::dot(glm::normalize(screen.sides[0]), glm::normalize(screen.sides[1]));
    return std::acos(glm::clamp(cosine, -1.0f, 1.0f));
}

/// What an entry, or a part of it, becomes.
struct Found {
    glm::vec3 centroid{0.0f};
    std::uint16_t side = 0;
    std::vector<Screen> screens;
    float share = 1.0f; ///< of the entry's area
};

/// The entries of one leaf.
class LeafScreens {
public:
    LeafScreens(glm::vec3 low, float cell, float reach, const ScreenFinder& finder)
        : finder_(finder), cell_(cell), reach_(reach)
    {
        box_.add(low), box_.add(low + cell);
    }

    /// Nothing: buried. Several where a wall parts the surface within the leaf.
    [[nodiscard]] std::vector<Found> look(const OctreeEntry& entry) const
    {
        std::vector<Found> whole = from(entry.centroid, entry.normal);
        if (!whole.empty() && !isParted(whole[0], entry.normal)) return whole;
        std::vector<Found> parts;
        const auto seen = finder_.seenParts(entry.centroid, entry.normal, kHeight * cell_, box_);
        std::size_t all = 0;
        for (const ScreenFinder::SeenPart& part : seen) all += part.size;
        for (const ScreenFinder::SeenPart& part : seen) {
            for (Found& found : from(part.middle, entry.normal)) {
                found.share = static_cast<float>(part.size) / static_cast<float>(all);
                parts.push_back(std::move(found));
            }
        }
        if (whole.empty() && !parts.empty()) whole.push_back(parts[0]), whole[0].share = 1.0f;
        std::erase_if(parts, [](const Found& part) { return part.side == 0; }); // lookups could not tell them apart
        return parts.size() > 1 ? parts : whole;
    }

private:
    [[nodiscard]] std::vector<Found> from(glm::vec3 p, glm::vec3 n) const
    {
        Found found{p, 0, {}};
        if (!finder_.find(p, n, kHeight * cell_, reach_, found.screens)) return {};
        found.side = sideOf(found, n);
        return {std::move(found)};
    }

    /// Of the nearest wall that parts the surface near by, if walls are much of what is seen there.
    [[nodiscard]] std::uint16_t sideOf(const Found& found, glm::vec3 n) const
    {
        const Screen* nearest = nullptr;
        float width = 0.0f;
        for (const Screen& screen : found.screens) {
            if (screen.isInAllDirections() || screen.behind > kSideReach * cell_ ||
                !finder_.isAnyHidden(screen, found.centroid, n, kSideReach * cell_))
                continue;
            if (std::abs(glm::dot(screen.away, n)) > kUpright) return 0; // the surface itself, in folds
            width += angleOf(screen);
            if (!nearest || screen.behind < nearest->behind) nearest = &screen;
        }
        if (!nearest || width < kWideWall) return 0;
        const glm::vec3 across = glm::dot(nearest->away, n) * n - nearest->away;
        const float steep = glm::length(across);
        const glm::vec3 towards = across / steep, middle = 0.5f * (box_.low + box_.high);
        const float face = nearest->behind / steep;
        const float thick =
            finder_.thicknessOf(found.centroid, n, kHeight * cell_, -towards, kSideReach * cell_, 2.0f * cell_);
        const float end = glm::dot(towards, found.centroid - middle) - face - 0.5f * thick;
        return packSide(n, towards, end / cell_);
    }

    [[nodiscard]] bool isParted(const Found& found, glm::vec3 n) const
    {
        const glm::vec3 low = box_.low - found.centroid, high = box_.high - found.centroid;
        const float radius = glm::length(glm::max(glm::abs(low), glm::abs(high)));
        return found.side != 0 && std::ranges::any_of(found.screens, [&](const Screen& screen) {
                   return screen.mayHide(low, high) && finder_.isAnyHidden(screen, found.centroid, n, radius);
               });
    }

    const ScreenFinder& finder_;
    float cell_, reach_;
    BoxGroups::Box box_;
};

/// Leaves and entries that are seen, in the order they had.
OctreeGeometry seenOf(const OctreeGeometry& all, const std::vector<std::vector<Found>>& found)
{
    OctreeGeometry seen;
    seen.depth = all.depth, seen.lowest = all.lowest, seen.rootSize = all.rootSize;
    seen.firstScreen.push_back(0);
    for (std::size_t leaf = 0; leaf < all.cells.size(); ++leaf) {
        const std::size_t before = seen.entries.size();
        for (std::uint32_t e = all.firstEntry[leaf]; e < all.firstEntry[leaf + 1]; ++e) {
            for (const Found& part : found[e]) {
                if (seen.entries.size() - before == kMostEntries) break;
                const OctreeEntry& entry = all.entries[e];
                seen.entries.push_back({part.centroid, entry.normal, part.share * entry.area, part.side});
                seen.screens.insert(seen.screens.end(), part.screens.begin(), part.screens.end());
                seen.firstScreen.push_back(static_cast<std::uint32_t>(seen.screens.size()));
            }
        }
        if (seen.entries.size() == before) continue;
        seen.cells.push_back(all.cells[leaf]);
        seen.firstEntry.push_back(static_cast<std::uint32_t>(before));
    }
    seen.firstEntry.push_back(static_cast<std::uint32_t>(seen.entries.size()));
    return seen;
}

} // namespace

bool findScreens(OctreeGeometry& geometry, const ScreenFinder& finder, Workers& workers, const std::stop_token& stop)
{
    constexpr std::size_t kBlock = 8;
    const std::size_t count = geometry.cells.size();
    const float cell = geometry.cellSize(), reach = kScreenReach * geometry.rootSize;
    std::vector<std::vector<Found>> found(geometry.entries.size());
    const bool all = workers.run((count + kBlock - 1) / kBlock, stop, [&](std::size_t block) {
        for (std::size_t leaf = block * kBlock; leaf < std::min(count, (block + 1) * kBlock); ++leaf) {
            if (stop.stop_requested()) return;
            const glm::vec3 low = geometry.lowest + cell * glm::vec3(mortonCell(geometry.cells[leaf]));
            const LeafScreens screens(low, cell, reach, finder);
            for (std::uint32_t e = geometry.firstEntry[leaf]; e < geometry.firstEntry[leaf + 1]; ++e)
                found[e] = screens.look(geometry.entries[e]);
        }
    });
    if (!all || stop.stop_requested()) return false;
    geometry = seenOf(geometry, found);
    return true;
}

} // namespace lightloom
