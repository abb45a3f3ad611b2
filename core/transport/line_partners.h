// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/line_slots.h"
#include "core/transport/partner_finder.h"

namespace lightloom {

/// What the surface sees along discrete lines of one direction, both ways in one pass, O(voxels). An entry that faces
/// along +direction looks that way, one that faces along -direction the other way: each has one partner, the entry that
/// it takes light from, or none.
///
/// A wall is one or two voxels thick along a line and would hide itself from the light: entries that face along the
/// line wait until an entry faces them, which sees the last of them; so do those that follow it within two slices, the
/// next steps of the same wall. Entries see each other if each lies before the other's plane: the far side of a slab
/// thinner than a voxel is passed over while the line is about that plane. Within a voxel this makes corners that are
/// open inwards see themselves; all else that faces back in a voxel comes before what faces forth. Where surface bends
/// away from a line or ends at an edge that is open outwards, lines pass beside it, as often as it leaves room in their
/// cross-section. Where several entries of a voxel could answer, one is drawn by how much of it is seen: area times
/// cosine (docs/methods/voxel-lightcuts.md).
class LinePartners final : public PartnerFinder {
public:
    /// Both must outlive this.
    LinePartners(const SurfaceVoxels& voxels, const VoxelOrders& orders);

    std::span<std::uint32_t> find(const LineDirection& direction, std::uint32_t number) override;

private:
    /// Entries of one voxel, a bit each.
    using Members = std::uint32_t;
    static_assert(kMostOrientations <= 32 && kMostVoxels <= 1024);
    /// All by slot. Those that wait are a chain, the last one first.
    struct alignas(32) Line {
        std::uint32_t last = kNothing;    // of the chain
        std::uint32_t seen = kNothing;    // which of it is seen: the last one that the line did not pass beside
        Members together = 0;             // those of its voxel that wait; 0: it is alone
        std::uint32_t emitter = kNothing; // what those who faced the chain last saw
        Members emitters = 0;             // as `together`
        std::uint16_t lastSlice = 0;      // of `last`
        std::uint16_t farAfter = 0;       // slice beyond which the line has left all planes of the chain behind
        std::uint16_t closedAt = 0;       // slice
        std::uint16_t stamp = 0;          // of the direction; an older one: a line without voxels so far
        std::uint16_t covered = 0;        // of its cross-section by the run of surface that it skims, in kWhole
        std::uint16_t skimmed = 0;        // slice of the last of that run, twice; the lowest bit: it faces forth
    };
    static_assert(sizeof(Line) == 32);
    /// A voxel of several entries, while a line goes through it.
    struct Several {
        std::uint32_t slot, count; // of its first entry; entries
        std::uint16_t slice;
    };
    /// Which others of its voxel an entry sees: each lies before the other's plane; with which it makes an edge that is
    /// open outwards: each lies behind the other's plane, and they are no sheet.
    struct Beside {
        Members seen = 0, edge = 0;
    };
    struct Faces {
        Members forth = 0, back = 0;
    };
    /// One that faces what waits near by, to be ended at after the others of its slice.
    struct NearEnd {
        std::uint32_t slot;
        bool isPassed;
    };
    void findBeside();
    [[nodiscard]] const Beside& besideAt(std::uint32_t slot) const { return beside_[order_->entry[slot]]; }
    [[nodiscard]] std::uint32_t firstOfVoxel(std::uint32_t slot) const;
    [[nodiscard]] float shownBy(std::uint32_t slot) const;
    [[nodiscard]] Faces facesOf(const Several& voxel) const;
    [[nodiscard]] std::uint32_t pick(std::uint32_t firstSlot, Members among) const;
    [[nodiscard]] std::uint32_t seenBy(std::uint32_t slot, const Line& line) const;
    [[nodiscard]] bool endsAt(std::uint32_t from, std::uint32_t to) const;
    Faces joinCorners(const Several& voxel, const Faces& faces);
    [[nodiscard]] bool skims(std::uint32_t slot) const;
    [[nodiscard]] bool leavesAtEdge(std::uint32_t slot) const;
    static bool passes(Line& line, std::uint16_t slice, int share, int place, bool isForth);
    [[nodiscard]] Faces passedBy(const Several& voxel, const Faces& faces, Line& line);
    void wait(Line& line, std::uint32_t slot, std::uint16_t slice, std::int32_t reach, Members together, bool isPassed);
    template<class EndOf>
    void close(Line& line, std::uint16_t slice, bool isPassed, EndOf endOf);
    void closeNear(Line& line, std::uint32_t slot, std::uint16_t slice, bool isPassed);
    void closeSeveral(Line& line, const Several& voxel, Members facing, Members takers, bool isPassed);
    void walkSeveral(const Several& voxel, Line& line);
    template<bool kIsBent>
    void walkOnes(std::uint32_t begin, std::uint32_t first, std::uint32_t end, std::uint16_t slice);
    void walkSlice(const LineNumbers& numbers, std::uint16_t slice);
    void finish();
    Line& lineAt(std::uint32_t number);
    [[nodiscard]] std::int32_t reachOf(std::uint32_t slot) const;

    const SurfaceVoxels& voxels_;
    const VoxelOrders& orders_;
    std::vector<Beside> beside_; // by entry
    std::uint32_t none_;         // the slot after the last
    const WalkOrder* order_ = nullptr;
    glm::vec3 along_{0.0f};
    float perSlice_ = 1.0f;               // cells along the line
    float wholePerArea_ = 1.0f;           // per m2: 1 is the cross-section of the space that belongs to a line
    std::array<std::uint32_t, 3> keys_{}; // of what is drawn along this direction
    std::uint16_t stamp_ = 0;
    std::vector<Line> lines_;
    std::vector<std::uint32_t> numbers_; // of lines, by slot of a slice, as the next two
    std::vector<std::int32_t> kinds_;
    std::vector<std::int32_t> reaches_;  // slices until a line has left the plane behind
    std::vector<NearEnd> near_;          // of a slice
    std::vector<float> cosines_;         // by slot, as all that follows
    std::vector<std::uint32_t> before_;  // of one that waits: the one before it in the chain
    std::vector<std::uint32_t> chained_; // those that wait after others, in their order
    std::size_t chainedCount_ = 0;
    std::vector<Members> together_;       // of a voxel of several: those that wait, if they are several
    std::vector<std::uint32_t> ends_;     // partners; none_ for none
    std::vector<std::uint32_t> partners_; // by entry
};

} // namespace lightloom
