// SPDX-License-Identifier: Apache-2.0
#include "core/transport/line_partners.h"
#include "core/base/rng.h"
#include <algorithm>
#include <bit>

namespace lightloom {
namespace {

constexpr int kSameWall = 2;       ///< slices
constexpr float kWhollyMet = 0.5f; ///< share of what an entry shows that is enough to end all its ways in a corner
/// By which the share of a line's cross-section counts that a sheet or a corner covers: a quarter is met for certain. A
/// wall covers all of it in at most three steps: one of them is large enough.
constexpr float kCertainly = 4.0f;
constexpr std::uint32_t kAhead = 16; ///< slots: lines are fetched so long before they are walked on
constexpr float kApart = 1e-3f;      ///< cells: the two sides of a sheet are neither before nor behind each other

/// Whether each lies before the other's plane.
bool see(const Plane& one, const Plane& other) { return one.before(other) > kApart && other.before(one) > kApart; }

bool makeEdge(const Plane& one, const Plane& other)
{
    return one.before(other) < kApart && other.before(one) < kApart &&
           glm::dot(one.normal, other.normal) > -kSameOrientation;
}

/// Calls `what` with the number of each.
template<class Do>
void forEach(std::uint32_t members, Do what)
{
    for (; members != 0; members &= members - 1) what(static_cast<std::uint32_t>(std::countr_zero(members)));
}

} // namespace

LinePartners::LinePartners(const SurfaceVoxels& voxels, const VoxelOrders& orders)
    : voxels_(voxels), orders_(orders), beside_(voxels.entries.size()),
      none_(static_cast<std::uint32_t>(voxels.entries.size())), cosines_(voxels.entries.size() + WalkOrder::kSpare),
      before_(voxels.entries.size()), chained_(voxels.entries.size() + 1), together_(voxels.entries.size()),
      ends_(voxels.entries.size() + 1), partners_(voxels.entries.size())
{
    findBeside();
    std::uint32_t most = 0; // slots of a slice
    for (int axis = 0; axis < 3; ++axis) {
        const std::vector<std::uint32_t>& first = orders.along(axis).firstSlot;
        for (std::size_t slice = 0; slice + 1 < first.size(); ++slice)
            most = std::max(most, first[slice + 1] - first[slice]);
    }
    numbers_.resize(most + kAhead), kinds_.resize(most + kAhead), reaches_.resize(most + kAhead);
    near_.resize(most);
}

void LinePartners::findBeside()
{
    const WalkOrder& order = orders_.along(0);
    for (std::uint32_t slot = 0; slot < none_; ++slot) {
        Beside& beside = beside_[order.entry[slot]];
        const Plane& one = order.planes[slot];
        const std::uint32_t voxel = order.voxel[slot], first = slot - (order.entry[slot] - voxels_.firstEntry[voxel]);
        const std::uint32_t count = voxels_.firstEntry[voxel + 1] - voxels_.firstEntry[voxel];
        for (std::uint32_t k = 0; k < count && count > 1; ++k) {
            const Plane& other = order.planes[first + k];
            beside.seen |= Members(see(one, other)) << k;
            beside.edge |= Members(makeEdge(one, other)) << k;
        }
    }
}

/// Slot of the first entry of a slot's voxel.
std::uint32_t LinePartners::firstOfVoxel(std::uint32_t slot) const
{
    return slot - (order_->entry[slot] - voxels_.firstEntry[order_->voxel[slot]]);
}

/// What an entry covers of lines' cross-section, m2.
float LinePartners::shownBy(std::uint32_t slot) const { return order_->area[slot] * glm::abs(cosines_[slot]); }

LinePartners::Faces LinePartners::facesOf(const Several& voxel) const
{
    Faces faces;
    for (std::uint32_t i = 0; i < voxel.count; ++i) {
        faces.forth |= Members(cosines_[voxel.slot + i] > kAlongSurface) << i;
        faces.back |= Members(cosines_[voxel.slot + i] < -kAlongSurface) << i;
    }
    return faces;
}

/// One of a voxel's entries, drawn by area times cosine.
std::uint32_t LinePartners::pick(std::uint32_t firstSlot, Members among) const
{
    if (std::has_single_bit(among)) return firstSlot + static_cast<std::uint32_t>(std::countr_zero(among));
    float all = 0.0f;
    forEach(among, [&](std::uint32_t i) { all += shownBy(firstSlot + i); });
    float rest = all * drawn(keys_[0], order_->voxel[firstSlot]);
    std::uint32_t picked = kNothing;
    forEach(among, [&](std::uint32_t i) {
        if (rest >= 0.0f) picked = firstSlot + i;
        rest -= shownBy(firstSlot + i);
    });
    return picked;
}

/// What an entry sees of the line's emitter.
std::uint32_t LinePartners::seenBy(std::uint32_t slot, const Line& line) const
{
    if (line.emitter == kNothing) return none_;
    if (line.emitters == 0) return line.emitter;
    const std::uint32_t first = firstOfVoxel(line.emitter);
    Members seen = 0;
    forEach(line.emitters,
            [&](std::uint32_t i) { seen |= Members(see(order_->planes[slot], order_->planes[first + i])) << i; });
    return pick(first, seen != 0 ? seen : line.emitters);
}

/// Whether the way from an entry that waits ends at one that faces it. Not while the line is about the plane of one of
/// them and the other lies behind it.
bool LinePartners::endsAt(std::uint32_t from, std::uint32_t to) const
{
    const Plane &one = order_->planes[from], &other = order_->planes[to];
    const float way = (other.slice - one.slice) * perSlice_;
    const auto isPassed = [&](const Plane& plane, const Plane& seen) {
        return way * glm::abs(glm::dot(plane.normal, along_)) > kAboutPlane || plane.before(seen) > kApart;
    };
    return isPassed(one, other) && isPassed(other, one);
}

/// Entries of a voxel that see each other along the line become partners; what is left. One that covers little of what
/// the other shows along the line is met as rarely: the foot of a bump does not darken a whole voxel.
LinePartners::Faces LinePartners::joinCorners(const Several& voxel, const Faces& faces)
{
    Faces left = faces;
    const float place = drawn(keys_[2], order_->voxel[voxel.slot]);
    const auto join = [&](Members from, Members to, Members& leftOver) {
        forEach(from, [&](std::uint32_t i) {
            const std::uint32_t slot = voxel.slot + i;
            const Members seen = besideAt(slot).seen & to;
            if (seen == 0) return;
            float covered = 0.0f;
            forEach(seen, [&](std::uint32_t k) { covered += shownBy(voxel.slot + k); });
            const float shown = shownBy(slot);
            if (covered < kWhollyMet * shown && covered <= place * kWhollyMet * shown) return;
            ends_[slot] = pick(voxel.slot, seen);
            leftOver &= ~(Members(1) << i);
        });
    };
    join(faces.forth, faces.back, left.forth);
    join(faces.back, faces.forth, left.back);
    return left;
}

/// Whether a line may pass beside surface that bends away from it or ends near by.
bool LinePartners::skims(std::uint32_t slot) const
{
    const WalkOrder& o = *order_;
    const float most = o.bendX[slot] * along_.x + o.bendY[slot] * along_.y + o.bendZ[slot] * along_.z;
    if (cosines_[slot] * cosines_[slot] < kSkimDepth * (o.bend[slot] + most * most)) return true;
    return leavesAtEdge(slot);
}

/// Whether surface beyond an edge near an entry does not face what the entry faces.
bool LinePartners::leavesAtEdge(std::uint32_t slot) const
{
    const std::uint32_t number = order_->edges[slot];
    return number != 0 && std::ranges::any_of(orders_.edges()[number], [&](glm::vec3 beyond) {
               return beyond != glm::vec3(0.0f) &&
                      glm::dot(beyond, along_) * cosines_[slot] < kAlongSurface * kAlongSurface;
           });
}

/// Whether a line passes beside surface that covers so much of its cross-section, in kWhole. All that it skims in a run
/// covers together what it covers one by one: of surface that ends ways, the place that was drawn in the cross-section
/// is covered from some voxel on; of surface that ways begin at, one voxel has it, the last if they cover it twice.
[[gnu::always_inline]] inline bool LinePartners::passes(Line& line, std::uint16_t slice, int share, int place,
                                                        bool isForth)
{
    const int face = isForth ? 1 : 0;
    const bool goesOn = ((line.skimmed & 1) == face) & (slice - (line.skimmed >> 1) <= kSameWall);
    const int before = goesOn ? line.covered : 0, after = before + share;
    const bool isReached = (after + kWhole - 1 - place) / kWhole != (before + kWhole - 1 - place) / kWhole;
    line.covered = static_cast<std::uint16_t>(after < 2 * kWhole ? after : kWhole + after % kWhole);
    line.skimmed = static_cast<std::uint16_t>(2 * slice + face);
    return isForth ? !isReached : after <= place;
}

/// Which faces of a voxel the line passes beside: at an edge that is open outwards, not at a slab or in a corner, and
/// where all of it bends away, as much as the surface leaves of the line's cross-section; else slivers alone.
LinePartners::Faces LinePartners::passedBy(const Several& voxel, const Faces& faces, Line& line)
{
    float back = 0.0f, forth = 0.0f;
    const Members all = faces.back | faces.forth;
    bool isHollow = false, isEdge = false, isSkimmed = true;
    forEach(all, [&](std::uint32_t i) {
        const Beside& beside = besideAt(voxel.slot + i);
        const bool isBack = (faces.back >> i & 1u) != 0;
        (isBack ? back : forth) += shownBy(voxel.slot + i);
        isHollow = isHollow || (beside.seen & all) != 0;
        isEdge = isEdge || (beside.edge & ~(isBack ? faces.back : faces.forth)) != 0;
        isSkimmed = isSkimmed && skims(voxel.slot + i);
    });
    const float weight = !isHollow && (isEdge || isSkimmed) ? 1.0f : kCertainly;
    const auto share = [&](float shown) {
        return static_cast<int>(std::min(weight * shown * wholePerArea_, kMostShare));
    };
    const auto number = static_cast<std::uint32_t>(&line - lines_.data());
    const int place = placeIn(keys_[1], number);
    Faces passed;
    if (faces.back != 0 && passes(line, voxel.slice, share(back), place, false)) passed.back = faces.back;
    if (faces.forth != 0 && passes(line, voxel.slice, share(forth), place, true)) passed.forth = faces.forth;
    return passed;
}

/// One joins the chain. One that the line passes beside is not seen while there is another.
[[gnu::always_inline]] inline void LinePartners::wait(Line& line, std::uint32_t slot, std::uint16_t slice,
                                                      std::int32_t reach, Members together, bool isPassed)
{
    const bool isFirst = line.last == kNothing, isSeen = isFirst || !isPassed;
    before_[slot] = line.last;
    chained_[chainedCount_] = slot;
    chainedCount_ += isFirst ? 0 : 1;
    line.last = slot;
    line.seen = isSeen ? slot : line.seen;
    line.together = isSeen ? together : line.together;
    line.lastSlice = slice;
    const auto farAfter = static_cast<std::uint16_t>(slice + reach);
    line.farAfter = isFirst || farAfter > line.farAfter ? farAfter : line.farAfter;
}

/// Ends the ways of those that wait for which `endOf` has an end, or none where the line passes by; sets the emitter.
template<class EndOf>
void LinePartners::close(Line& line, std::uint16_t slice, bool isPassed, EndOf endOf)
{
    std::uint32_t ended = kNothing, last = line.last;
    bool isSeenThere = false;
    Members together = line.together;
    int farAfter = 0;
    for (std::uint32_t* link = &last; *link != kNothing;) {
        const std::uint32_t slot = *link, end = endOf(slot);
        if (end != kNothing && (ended == kNothing || slot == line.seen)) ended = slot;
        if (end == kNothing || isPassed) {
            isSeenThere = isSeenThere || slot == line.seen;
            farAfter = std::max(farAfter, order_->slice[slot] + reachOf(slot));
            link = &before_[slot];
        } else {
            ends_[slot] = end;
            *link = before_[slot];
            before_[slot] = kNothing;
        }
    }
    const auto togetherAt = [&](std::uint32_t slot) {
        return slot < order_->firstOfSeveral[order_->slice[slot]] ? Members(0) : together_[slot];
    };
    if (ended != kNothing)
        line.emitter = ended, line.emitters = ended == line.seen ? together : togetherAt(ended);
    else if (slice - line.closedAt > kSameWall)
        line.emitter = kNothing;
    line.closedAt = slice;
    line.last = last;
    line.farAfter = static_cast<std::uint16_t>(farAfter);
    if (last == kNothing) return;
    line.lastSlice = order_->slice[last];
    if (!isSeenThere) line.seen = last, line.together = togetherAt(last);
}

/// Ends ways at an entry that faces those that wait, some of which are near.
void LinePartners::closeNear(Line& line, std::uint32_t slot, std::uint16_t slice, bool isPassed)
{
    close(line, slice, isPassed, [&](std::uint32_t from) { return endsAt(from, slot) ? slot : kNothing; });
    ends_[slot] = seenBy(slot, line);
}

/// The same at several entries of a voxel; `takers` of them see what waits.
void LinePartners::closeSeveral(Line& line, const Several& voxel, Members facing, Members takers, bool isPassed)
{
    const std::uint32_t drawnOne = pick(voxel.slot, facing);
    close(line, voxel.slice, isPassed, [&](std::uint32_t from) {
        if (endsAt(from, drawnOne)) return drawnOne;
        for (Members left = std::has_single_bit(facing) ? 0 : facing; left != 0; left &= left - 1) {
            const std::uint32_t slot = voxel.slot + static_cast<std::uint32_t>(std::countr_zero(left));
            if (endsAt(from, slot)) return slot;
        }
        return kNothing;
    });
    forEach(takers, [&](std::uint32_t i) { ends_[voxel.slot + i] = seenBy(voxel.slot + i, line); });
}

std::int32_t LinePartners::reachOf(std::uint32_t slot) const
{
    return static_cast<std::int32_t>(std::min(kAboutPlane / perSlice_ / glm::abs(cosines_[slot]), kFurthest));
}

LinePartners::Line& LinePartners::lineAt(std::uint32_t number)
{
    Line& line = lines_[number];
    if (line.stamp != stamp_) line = Line{.stamp = stamp_};
    return line;
}

void LinePartners::walkSeveral(const Several& voxel, Line& line)
{
    std::fill_n(ends_.begin() + voxel.slot, voxel.count, none_);
    const Faces faces = facesOf(voxel);
    Faces left = faces;
    if (faces.forth != 0 && faces.back != 0) left = joinCorners(voxel, faces);
    const Faces passed = passedBy(voxel, left, line);
    if (faces.back != 0)
        closeSeveral(line, voxel, left.back != 0 ? left.back : faces.back, left.back, passed.back != 0);
    const Members joined = faces.forth & ~left.forth;
    if (joined != 0) {
        line.emitter = voxel.slot + static_cast<std::uint32_t>(std::countr_zero(joined));
        line.emitters = std::has_single_bit(joined) ? 0 : joined;
    }
    const bool isPassed = passed.forth != 0 && line.last != kNothing;
    const Members together = std::has_single_bit(left.forth) ? 0 : left.forth;
    forEach(left.forth, [&](std::uint32_t i) {
        const std::uint32_t slot = voxel.slot + i;
        together_[slot] = together;
        wait(line, slot, voxel.slice, reachOf(slot), together, isPassed);
    });
}

/// Voxels of one entry each, slots [first, end) of a slice that starts at `begin`. Branches go by what surface faces,
/// as slots are ordered; what else differs from one voxel to the next is selected.
template<bool kIsBent>
void LinePartners::walkOnes(std::uint32_t begin, std::uint32_t first, std::uint32_t end, std::uint16_t slice)
{
    const Line kNew{};
    const std::uint32_t none = none_;
    Line* const lines = lines_.data();
    std::uint32_t *const ends = ends_.data(), *const before = before_.data(), *const chained = chained_.data();
    const std::uint32_t* const edges = order_->edges.data();
    const Plane* const planes = order_->planes.data();
    NearEnd* const near = near_.data();
    std::size_t chainedCount = chainedCount_, nearCount = 0;
    const std::uint16_t stamp = stamp_;
    for (std::uint32_t slot = first; slot < end; ++slot) {
        const std::uint32_t i = slot - begin;
        __builtin_prefetch(&lines[numbers_[i + kAhead]], 1);
        const std::int32_t kind = kinds_[i], reach = reaches_[i];
        Line& line = lines[numbers_[i]];
        const Line& from = line.stamp == stamp ? line : kNew;
        const std::uint32_t last = from.last;
        bool isPassed = false;
        if (kIsBent && ((kind & kSkims) != 0 || (edges[slot] != 0 && leavesAtEdge(slot)))) {
            if (line.stamp != stamp) line = Line{.stamp = stamp};
            isPassed = passes(line, slice, kind >> kShareBit & kShareBits, kind >> kPlaceBit, (kind & kForth) != 0);
        }
        ends[slot] = none;
        if ((kind & kForth) != 0) {
            const bool isFirst = last == kNothing, isSeen = isFirst | !isPassed;
            before[slot] = last;
            chained[chainedCount] = slot;
            chainedCount += isFirst ? 0 : 1;
            const int farAfter = slice + reach, farBefore = isFirst ? 0 : from.farAfter;
            line = {slot,
                    isSeen ? slot : from.seen,
                    isSeen ? 0 : from.together,
                    from.emitter,
                    from.emitters,
                    slice,
                    static_cast<std::uint16_t>(std::max(farAfter, farBefore)),
                    from.closedAt,
                    stamp,
                    from.covered,
                    from.skimmed};
        } else if ((kind & kBack) != 0) {
            const bool isWaiting = last != kNothing;
            if (isWaiting & ((slice <= from.farAfter) | (slice - from.lastSlice <= reach))) {
                __builtin_prefetch(&planes[slot]), __builtin_prefetch(&planes[last]);
                near[nearCount++] = {slot, isPassed};
                continue;
            }
            const bool isRecent = slice - from.closedAt <= kSameWall;
            const std::uint32_t emitter = isWaiting ? from.seen : isRecent ? from.emitter : kNothing;
            const Members emitters = isWaiting ? from.together : from.emitters;
            ends[isWaiting & !isPassed ? last : none] = slot;
            line = {isPassed ? last : kNothing,
                    from.seen,
                    from.together,
                    emitter,
                    emitters,
                    from.lastSlice,
                    from.farAfter,
                    slice,
                    stamp,
                    from.covered,
                    from.skimmed};
            ends[slot] = emitter == kNothing ? none : emitter;
            if (emitters != 0) ends[slot] = seenBy(slot, line);
        }
    }
    chainedCount_ = chainedCount;
    // each is on a line of its own: they can wait until their planes have come from memory
    for (std::size_t i = 0; i < nearCount; ++i)
        closeNear(lines[numbers_[near[i].slot - begin]], near[i].slot, slice, near[i].isPassed);
}

void LinePartners::walkSlice(const LineNumbers& numbers, std::uint16_t slice)
{
    const WalkOrder& o = *order_;
    const std::uint32_t first = o.firstSlot[slice], end = o.firstSlot[slice + std::size_t(1)],
                        several = o.firstOfSeveral[slice];
    if (first == end) return;
    const SliceSlots slots{&o.x[first],     &o.y[first],     &o.z[first],     &o.area[first], &o.bend[first],
                           &o.bendX[first], &o.bendY[first], &o.bendZ[first], &o.uv[first]};
    const SliceWalk walk{along_,   numbers.width(),         numbers.offset(slice),
                         keys_[1], kAboutPlane / perSlice_, wholePerArea_};
    const PreparedSlots prepared{&cosines_[first], numbers_.data(), kinds_.data(), reaches_.data()};
    prepareSlots(slots, end - first, walk, prepared);
    markSkimmed(slots, o.firstBent[slice] - first, several - first, walk, prepared);
    walkOnes<false>(first, first, o.firstBent[slice], slice);
    walkOnes<true>(first, o.firstBent[slice], several, slice);
    for (std::uint32_t slot = several, next = 0; slot < end; slot = next) {
        for (next = slot + 1; next < end && o.voxel[next] == o.voxel[slot];) ++next;
        walkSeveral({slot, next - slot, slice}, lineAt(numbers_[slot - first]));
    }
}

/// Those that waited before others ended where these did; partners by entry.
void LinePartners::finish()
{
    for (std::size_t i = chainedCount_; i-- > 0;) {
        const std::uint32_t slot = chained_[i];
        if (before_[slot] != kNothing) ends_[before_[slot]] = ends_[slot];
    }
    toEntries(order_->entry.data(), ends_.data(), partners_.size(), partners_.data());
}

std::span<std::uint32_t> LinePartners::find(const LineDirection& direction, std::uint32_t number)
{
    for (std::uint32_t purpose = 0; purpose < keys_.size(); ++purpose)
        keys_[purpose] = static_cast<std::uint32_t>(mixBits(4 * std::uint64_t(number) + purpose));
    along_ = direction.unit;
    order_ = &orders_.along(direction.major);
    perSlice_ = 1.0f / along_[direction.major];
    wholePerArea_ = static_cast<float>(kWhole) / (voxels_.cellSize() * voxels_.cellSize() * along_[direction.major]);
    const LineNumbers numbers(direction, voxels_.cells);
    if (lines_.size() < numbers.count()) lines_.resize(numbers.count());
    if (++stamp_ == 0) std::ranges::fill(lines_, Line{}), stamp_ = 1;
    chainedCount_ = 0;
    for (int slice = 0; slice < voxels_.cells; ++slice) walkSlice(numbers, static_cast<std::uint16_t>(slice));
    finish();
    return partners_;
}

} // namespace lightloom
