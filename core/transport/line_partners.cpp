// SPDX-License-Identifier: Apache-2.0
#include "core/transport/line_partners.h"
#include "core/base/rng.h"
#include <algorithm>
#include <bit>

namespace lightloom {
namespace {

constexpr std::int32_t kSameWall = 2; ///< slices
constexpr float kAboutPlane = 1.5f;   ///< cells
constexpr float kWhollyMet = 0.5f;    ///< share of what an entry shows that is enough to end all its ways in a corner
/// Share of a line's cross-section that is enough to be met for certain. A wall covers all of it in at most three
/// steps: one of them is large enough.
constexpr float kEnough = 0.25f;
constexpr float kApart = 1e-3f; ///< cells: the two sides of a sheet are neither before nor behind each other

/// How far `at` lies before the entry's plane, in cells.
float before(const Orientation& entry, glm::vec3 at, float cell)
{
    return glm::dot(at - entry.centroid, entry.normal) / cell;
}

} // namespace

template<class Do>
void LinePartners::forEach(std::uint32_t voxel, Members members, Do what) const
{
    for (; members != 0; members &= members - 1)
        what(voxels_.firstEntry[voxel] + static_cast<std::uint32_t>(std::countr_zero(members)));
}

LinePartners::LinePartners(const SurfaceVoxels& voxels, const VoxelOrders& orders)
    : voxels_(voxels), orders_(orders), waiting_(voxels.entries.size()), cosines_(voxels.entries.size())
{
}

LinePartners::Faces LinePartners::facesOf(std::uint32_t voxel) const
{
    Faces faces;
    const std::uint32_t first = voxels_.firstEntry[voxel], count = voxels_.firstEntry[voxel + 1] - first;
    for (std::uint32_t i = 0; i < count; ++i) {
        faces.forth |= Members(cosines_[first + i] > kAlongSurface) << i;
        faces.back |= Members(cosines_[first + i] < -kAlongSurface) << i;
    }
    return faces;
}

/// Those of a voxel's entries that see `entry` and that it sees: each lies before the other's plane.
LinePartners::Members LinePartners::seeing(std::uint32_t entry, std::uint32_t voxel, Members among) const
{
    const Orientation& from = voxels_.entries[entry];
    Members seen = 0;
    forEach(voxel, among, [&](std::uint32_t e) {
        const Orientation& to = voxels_.entries[e];
        const bool sees = before(from, to.centroid, voxels_.cellSize()) > kApart &&
                          before(to, from.centroid, voxels_.cellSize()) > kApart;
        seen |= Members(sees) << (e - voxels_.firstEntry[voxel]);
    });
    return seen;
}

/// One of a voxel's entries, drawn by area times cosine.
std::uint32_t LinePartners::pick(std::uint32_t voxel, Members among) const
{
    const std::uint32_t first = voxels_.firstEntry[voxel];
    if (std::has_single_bit(among)) return first + static_cast<std::uint32_t>(std::countr_zero(among));
    const auto seen = [&](std::uint32_t e) { return voxels_.entries[e].area * glm::abs(cosines_[e]); };
    float all = 0.0f;
    forEach(voxel, among, [&](std::uint32_t e) { all += seen(e); });
    float rest = all * Rng(number_, 0, voxel).uniform();
    std::uint32_t picked = kNothing;
    forEach(voxel, among, [&](std::uint32_t e) {
        if (rest >= 0.0f) picked = e;
        rest -= seen(e);
    });
    return picked;
}

/// Whether the way from an entry that waits ends at one that faces it. Not while the line is about the plane of one of
/// them and the other lies behind it.
bool LinePartners::endsAt(std::uint32_t waiting, std::uint32_t facing, std::int32_t slice) const
{
    const Orientation &from = voxels_.entries[waiting], &to = voxels_.entries[facing];
    const float way = static_cast<float>(slice - waiting_[waiting].slice) * perSlice_;
    const auto isPassed = [&](const Orientation& plane, std::uint32_t entry, const Orientation& other) {
        return before(plane, other.centroid, voxels_.cellSize()) > kApart ||
               way * glm::abs(cosines_[entry]) > kAboutPlane;
    };
    return isPassed(from, waiting, to) && isPassed(to, facing, from);
}

/// Entries of a voxel that see each other along the line become partners; what is left. One that covers little of what
/// the other shows along the line is met as rarely: the foot of a bump does not darken a whole voxel.
LinePartners::Faces LinePartners::joinCorners(std::uint32_t voxel, const Faces& faces)
{
    Faces left = faces;
    const auto shown = [&](std::uint32_t e) { return voxels_.entries[e].area * glm::abs(cosines_[e]); };
    float place = -1.0f; // drawn when it is wanted
    const auto join = [&](Members from, Members to, Members& leftOver) {
        forEach(voxel, from, [&](std::uint32_t e) {
            const Members seen = seeing(e, voxel, to);
            if (seen == 0) return;
            float covered = 0.0f;
            forEach(voxel, seen, [&](std::uint32_t o) { covered += shown(o); });
            if (covered < kWhollyMet * shown(e)) {
                if (place < 0.0f) place = Rng(number_, 2, voxel).uniform();
                if (place * kWhollyMet * shown(e) >= covered) return;
            }
            partners_[e] = pick(voxel, seen);
            leftOver &= ~(Members(1) << (e - voxels_.firstEntry[voxel]));
        });
    };
    join(faces.forth, faces.back, left.forth);
    join(faces.back, faces.forth, left.back);
    return left;
}

/// Whether a line passes beside surface that covers so much (m2) of its cross-section.
bool LinePartners::passes(std::uint32_t voxel, float covered, float enough) const
{
    return covered < enough && covered <= enough * Rng(number_, 1, voxel).uniform();
}

/// Which faces of a voxel the line passes beside: slivers, which other voxels of the same surface make up for; and at
/// an edge that is open outwards, not at a slab or in a corner, as much as the surface leaves of the line's
/// cross-section.
LinePartners::Faces LinePartners::passedBy(std::uint32_t voxel, const Faces& faces) const
{
    float back = 0.0f, forth = 0.0f;
    const Members all = faces.back | faces.forth;
    bool isEdge = !std::has_single_bit(all);
    forEach(voxel, all, [&](std::uint32_t e) {
        (cosines_[e] < 0.0f ? back : forth) += voxels_.entries[e].area * glm::abs(cosines_[e]);
        isEdge = isEdge && seeing(e, voxel, all) == 0;
        if (!isEdge) return;
        forEach(voxel, all, [&](std::uint32_t o) {
            const Orientation &one = voxels_.entries[e], &other = voxels_.entries[o];
            isEdge = isEdge && glm::dot(one.normal, other.normal) >= -kSameOrientation;
        });
    });
    const float enough = isEdge ? tube_ : kEnough * tube_;
    return {passes(voxel, forth, enough) ? faces.forth : 0, passes(voxel, back, enough) ? faces.back : 0};
}

/// Those that the line passes beside wait before the last one that does: nobody sees them for it.
void LinePartners::wait(Line& line, const VoxelPlace& place, Members members, bool isPassed)
{
    std::uint32_t& before = isPassed && line.waiting != kNothing ? waiting_[line.waiting].before : line.waiting;
    forEach(place.voxel, members, [&](std::uint32_t e) {
        waiting_[e] = {before, place.voxel, members, place.slice};
        before = e;
    });
}

/// Ends ways at those that face the ones that wait, or passes beside; `takers` of them see what waits.
void LinePartners::close(Line& line, const VoxelPlace& place, Members facing, Members takers, bool isPassed)
{
    std::uint32_t last = kNothing; // of those whose way ends here
    const std::uint32_t drawn = pick(place.voxel, facing);
    for (std::uint32_t* link = &line.waiting; *link != kNothing;) {
        const std::uint32_t e = *link;
        std::uint32_t end = endsAt(e, drawn, place.slice) ? drawn : kNothing;
        if (end == kNothing && !std::has_single_bit(facing)) {
            forEach(place.voxel, facing, [&](std::uint32_t f) {
                if (end == kNothing && endsAt(e, f, place.slice)) end = f;
            });
        }
        if (end == kNothing) {
            link = &waiting_[e].before;
            continue;
        }
        if (last == kNothing) last = e;
        if (isPassed) break;
        partners_[e] = end;
        *link = waiting_[e].before;
    }
    if (last != kNothing)
        line.emitter = waiting_[last].voxel, line.emitters = waiting_[last].together;
    else if (place.slice - line.closedAt > kSameWall)
        line.emitter = kNothing;
    line.closedAt = place.slice;
    if (line.emitter == kNothing) return;
    forEach(place.voxel, takers, [&](std::uint32_t e) {
        const Members seen = seeing(e, line.emitter, line.emitters);
        partners_[e] = pick(line.emitter, seen != 0 ? seen : line.emitters);
    });
}

/// The line goes through a voxel of one entry, as most are.
void LinePartners::walkOne(Line& line, const VoxelPlace& place, std::uint32_t entry)
{
    const float cosine = cosines_[entry];
    if (!(glm::abs(cosine) > kAlongSurface)) return;
    const bool isPassed = passes(place.voxel, voxels_.entries[entry].area * glm::abs(cosine), kEnough * tube_);
    if (cosine > 0.0f)
        wait(line, place, 1, isPassed);
    else
        close(line, place, 1, 1, isPassed);
}

void LinePartners::walkSeveral(Line& line, const VoxelPlace& place)
{
    const Faces faces = facesOf(place.voxel);
    Faces left = faces;
    if (faces.forth != 0 && faces.back != 0) left = joinCorners(place.voxel, faces);
    const Faces passed = passedBy(place.voxel, left);
    if (faces.back != 0) close(line, place, left.back != 0 ? left.back : faces.back, left.back, passed.back != 0);
    if (left.forth != faces.forth) line.emitter = place.voxel, line.emitters = faces.forth & ~left.forth;
    wait(line, place, left.forth, passed.forth != 0);
}

std::span<std::uint32_t> LinePartners::find(const LineDirection& direction, std::uint32_t number)
{
    number_ = number;
    along_ = direction.unit;
    perSlice_ = 1.0f / along_[direction.major];
    tube_ = voxels_.cellSize() * voxels_.cellSize() * along_[direction.major];
    const LineNumbers numbers(direction, voxels_.cells);
    if (lines_.size() < numbers.count()) lines_.resize(numbers.count());
    if (++stamp_ == 0) std::ranges::fill(lines_, Line{}), stamp_ = 1;
    partners_.assign(voxels_.entries.size(), kNothing);
    for (std::size_t e = 0; e < cosines_.size(); ++e) cosines_[e] = glm::dot(voxels_.entries[e].normal, along_);
    for (const VoxelPlace& place : orders_.along(direction.major)) {
        Line& line = lines_[numbers.of(place)];
        if (line.stamp != stamp_) line = {.stamp = stamp_};
        const std::uint32_t first = voxels_.firstEntry[place.voxel];
        if (voxels_.firstEntry[place.voxel + 1] - first == 1)
            walkOne(line, place, first);
        else
            walkSeveral(line, place);
    }
    return partners_;
}

} // namespace lightloom
