// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_deposit.h"
#include "core/base/units.h"
#include "core/base/wide_vectors.h"
#include "core/ivg/grid_walk.h"
#include <algorithm>
#include <atomic>
#include <cmath>

namespace lightloom {
namespace {

/// What is summed at one face or in one octant of a cell: the vector's components R x y z, G x y z, B x y z, then
/// squares of luminance for the variance (one for faces, one per axis for cells).
constexpr std::size_t kSummed = 12, kSquares = 9;

struct alignas(64) Slot {
    std::array<float, kSummed> sums{};
    std::uint64_t parts = 0; ///< of the face, what is open (GridOpenness::faceParts)
    void add(std::size_t four, const Floats4& values) { lanesOf<Floats4>(sums.data(), four) += values; }
};
using Totals = std::array<double, kSummed>;

constexpr std::size_t kSlabBytes = 1 << 20; ///< of cells that a thread works on at a time

/// A segment in grid coordinates.
struct GridSegment {
    glm::vec3 from, to, toLight, flux;
    float length;  ///< metres
    bool isInside; ///< both ends are in the grid, and with them all between
};

/// The planes of one axis that a segment crosses, in little memory: slabs look at all segments, and most cross others.
struct ShortRange {
    std::int16_t first = 0, last = -1;
    explicit ShortRange(PlaneRange r = {})
        : first(static_cast<std::int16_t>(r.first)), last(static_cast<std::int16_t>(r.last))
    {
    }
    [[nodiscard]] PlaneRange within(PlaneRange o) const { return PlaneRange{first, last}.within(o); }
};

/// What one block of photons left, ready to be summed.
struct SegmentList {
    RawVector<GridSegment> segments;
    std::array<std::vector<ShortRange>, 3> crossed; ///< by axis and segment
};

std::size_t slotsPerVertex(GridEstimator estimator) { return estimator == GridEstimator::tracks ? 8 : 6; }

std::array<Floats4, 3> packed(const glm::vec3& w, const glm::vec3& flux, const glm::vec3& squares)
{
    const glm::vec3 r = w * flux.x, g = w * flux.y, b = w * flux.z;
    return {Floats4{r.x, r.y, r.z, g.x}, Floats4{g.y, g.z, b.x, b.y}, Floats4{b.z, squares.x, squares.y, squares.z}};
}

/// Resizes what is to be written anew: nothing is copied, and what is too small is freed before, not after.
template<class Vector>
void resizeAnew(Vector& values, std::size_t size)
{
    if (values.capacity() < size) {
        values = Vector();
        values.reserve(size + size / 16); // blocks differ
    }
    values.resize(size);
}

std::uint64_t bitOf(float x, float y, int parts)
{
    const int i = std::min(static_cast<int>(x * static_cast<float>(parts)), parts - 1);
    const int j = std::min(static_cast<int>(y * static_cast<float>(parts)), parts - 1);
    return std::uint64_t{1} << (i + parts * j);
}

/// What lies beyond 0 or `most` is moved there.
Floats4 within(const Floats4& at, float most)
{
    const Floats4 low = at > 0.0f ? at : Floats4{};
    return low < most ? low : Floats4{} + most;
}

/// Of which parts of a face, along one of its sides, places in [0, 1] are.
Ints4 partOf(const Floats4& place)
{
    constexpr int kLast = GridOpenness::kParts - 1;
    const Ints4 part = __builtin_convertvector(place * static_cast<float>(GridOpenness::kParts), Ints4);
    return part < kLast ? part : Ints4{} + kLast;
}

/// Faces that segments cross, gathered before anything is summed: memory is fetched meanwhile, and waiting for it was
/// two fifths of the time. Sums are made in the order of the calls.
class CrossedSlots {
public:
    /// A segment's values, for what is added from now on.
    void begin(const std::array<Floats4, 3>& values)
    {
        if (segments_ == kRoom) flush();
        values_[segments_++] = values;
    }
    /// `part` of the face, a number of GridOpenness::faceParts.
    void add(Slot& slot, int part)
    {
        if (count_ == kRoom) flush();
        __builtin_prefetch(&slot, 1);
        found_[count_++] = {&slot, static_cast<std::uint32_t>(part), static_cast<std::uint32_t>(segments_ - 1)};
    }
    /// Sums what is left. How many faces were open where they were crossed.
    std::uint64_t finish()
    {
        flush();
        return open_;
    }

private:
    void flush()
    {
        for (std::size_t i = 0; i < count_; ++i) {
            const Found& f = found_[i];
            if ((f.slot->parts >> f.part & 1u) == 0) continue;
            for (std::size_t k = 0; k < 3; ++k) f.slot->add(k, values_[f.segment][k]);
            ++open_;
        }
        if (segments_ > 0) values_[0] = values_[segments_ - 1]; // it may go on
        segments_ = std::min<std::size_t>(segments_, 1);
        count_ = 0;
    }
    static constexpr std::size_t kRoom = 64;
    struct Found {
        Slot* slot;
        std::uint32_t part, segment;
    };
    std::array<std::array<Floats4, 3>, kRoom> values_;
    std::array<Found, kRoom> found_;
    std::size_t segments_ = 0, count_ = 0;
    std::uint64_t open_ = 0;
};

glm::mat3 matrixOf(const Totals& sums, double scale)
{
    glm::mat3 m;
    for (int channel = 0; channel < 3; ++channel) {
        for (int c = 0; c < 3; ++c)
            m[channel][c] = static_cast<float>(sums[static_cast<std::size_t>(3 * channel + c)] * scale);
    }
    return m;
}

} // namespace

/// Slots of one estimator, empty between calls. They lie by (axis, plane, v, u, side) for faces, by (vertex, octant)
/// for cells, so that a slab of planes is one stretch of memory.
struct GridDeposit::Work {
    Work(std::shared_ptr<const GridGeometry> at, GridEstimator how) : geometry(std::move(at)), estimator(how)
    {
        slots.resize(slotsPerVertex(how) * lattice().vertexCount());
        if (isTracks()) return;
        for (std::size_t i = 0; i < lattice().vertexCount(); ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                for (int side = 0; side < 2; ++side)
                    slots[faceIndex(axis, lattice().vertex(i), side)].parts =
                        openness().faceParts[i][std::size_t(axis)];
            }
        }
    }
    [[nodiscard]] const GridLattice& lattice() const { return geometry->lattice; }
    [[nodiscard]] const GridOpenness& openness() const { return geometry->openness; }
    [[nodiscard]] bool isTracks() const { return estimator == GridEstimator::tracks; }

    [[nodiscard]] std::size_t faceIndex(int axis, glm::ivec3 vertex, int side) const
    {
        const glm::ivec3 n = lattice().vertices();
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const std::size_t row = std::size_t(vertex[axis]) * std::size_t(n[v]) + std::size_t(vertex[v]);
        return 2 * (std::size_t(axis) * lattice().vertexCount() + row * std::size_t(n[u]) + std::size_t(vertex[u])) +
               std::size_t(side);
    }

    /// Grid planes of `axis`, or layers of cells, that one task takes.
    struct Slab {
        int axis;
        PlaneRange planes;
    };
    /// For faces no more of them than keep all threads busy: each looks at all segments anew, which costs more than
    /// memory that is far away. Cells are cut where layers end, so that theirs must not depend on threads.
    [[nodiscard]] std::vector<Slab> slabs(int threads) const
    {
        const glm::ivec3 n = lattice().vertices();
        const int perAxis = threads > 1 ? (2 * threads + 2) / 3 : 1;
        std::vector<Slab> all;
        for (int axis = isTracks() ? 2 : 0; axis < 3; ++axis) {
            const std::size_t layerBytes = std::size_t(n.x) * std::size_t(n.y) * 8 * sizeof(Slot);
            const int step =
                isTracks() ? std::max(1, static_cast<int>(kSlabBytes / layerBytes)) : (n[axis] + perAxis - 1) / perAxis;
            for (int plane = 0; plane < n[axis]; plane += step)
                all.push_back({axis, {plane, std::min(plane + step, n[axis]) - 1}});
        }
        return all;
    }

    std::uint64_t cross(const SegmentList& list, const Slab& slab)
    {
        return slab.axis == 0 ? cross<0>(list, slab) : slab.axis == 1 ? cross<1>(list, slab) : cross<2>(list, slab);
    }

    template<int axis>
    std::uint64_t cross(const SegmentList& list, const Slab& slab)
    {
        CrossedSlots found;
        const std::vector<ShortRange>& crossed = list.crossed[axis];
        for (std::size_t i = 0; i < crossed.size(); ++i) {
            const PlaneRange planes = crossed[i].within(slab.planes);
            if (planes.first <= planes.last) cross<axis>(list.segments[i], planes, found);
        }
        return found.finish();
    }

    template<int axis>
    void cross(const GridSegment& s, PlaneRange planes, CrossedSlots& found)
    {
        constexpr int u = (axis + 1) % 3, v = (axis + 2) % 3;
        glm::vec3 w = s.toLight;
        const float along = std::abs(w[axis]), light = luminance(s.flux);
        float square = light * along;
        if (estimator == GridEstimator::crossings) {
            w /= std::max(along, kLeastCosine);
            w[axis] = std::copysign(1.0f, w[axis]);
            square = light;
        }
        found.begin(packed(w, s.flux, glm::vec3(square * square, 0.0f, 0.0f)));
        const int side = s.to[axis] < s.from[axis] ? 1 : 0; // light comes from where the photon does
        const auto mostU = static_cast<float>(lattice().cells[u]), mostV = static_cast<float>(lattice().cells[v]);
        const int rowU = lattice().cells[u] + 1, rowV = lattice().cells[v] + 1;
        Slot* const first = slots.data() + 2 * std::size_t(axis) * lattice().vertexCount() + std::size_t(side);
        forFourPlanes<axis>(s.from, s.to, planes, [&](int plane, int count, const Floats4& atU, const Floats4& atV) {
            const Floats4 inU = within(atU, mostU), inV = within(atV, mostV);
            const Ints4 i = __builtin_convertvector(inU + 0.5f, Ints4), j = __builtin_convertvector(inV + 0.5f, Ints4);
            const Ints4 face = 2 * (((plane + Ints4{0, 1, 2, 3}) * rowV + j) * rowU + i); // of 512 cells: still an int
            const Ints4 part = partOf(inU + 0.5f - __builtin_convertvector(i, Floats4)) +
                               GridOpenness::kParts * partOf(inV + 0.5f - __builtin_convertvector(j, Floats4));
            for (int k = 0; k < count; ++k) {
                if (!s.isInside && (inU[k] != atU[k] || inV[k] != atV[k])) continue;
                found.add(first[face[k]], part[k]);
            }
        });
    }

    std::uint64_t pass(const SegmentList& list, const Slab& slab)
    {
        std::uint64_t count = 0;
        for (const GridSegment& s : list.segments) count += pass(s, slab);
        return count;
    }

    std::uint64_t pass(const GridSegment& s, const Slab& slab)
    {
        const float low = std::min(s.from.z, s.to.z), high = std::max(s.from.z, s.to.z);
        if (high < static_cast<float>(slab.planes.first) - 0.5f || low > static_cast<float>(slab.planes.last) + 0.5f)
            return 0;
        const float light = luminance(s.flux);
        const std::array<Floats4, 3> values = packed(s.toLight, s.flux, light * light * s.toLight * s.toLight);
        const std::size_t octant =
            (s.toLight.x > 0.0f ? 1u : 0u) + (s.toLight.y > 0.0f ? 2u : 0u) + (s.toLight.z > 0.0f ? 4u : 0u);
        std::uint64_t count = 0;
        forPieces(s.from, s.to, lattice().cells, slab.planes, [&](const glm::ivec3& vertex, float begin, float share) {
            const std::size_t index = lattice().index(vertex);
            const glm::vec3 middle = s.from + (begin + 0.5f * share) * (s.to - s.from) - glm::vec3(vertex) + 0.5f;
            const int level = std::clamp(static_cast<int>(middle.z * 4.0f), 0, 3);
            const std::uint64_t bit = bitOf(glm::max(middle.x, 0.0f), glm::max(middle.y, 0.0f), 4) << (16 * level);
            if ((openness().cellParts[index] & bit) == 0) return;
            Slot& slot = slots[8 * index + octant];
            const float way = share * s.length;
            const Floats4 last{way, way * way, way * way, way * way};
            slot.add(0, values[0] * way);
            slot.add(1, values[1] * way);
            slot.add(2, values[2] * last);
            ++count;
        });
        return count;
    }

    /// Member by member: copies of a whole wait for what was just written.
    void toGrid(const PhotonSegment& s, GridSegment& made) const
    {
        // far enough to leave the grid from anywhere in it
        made.length = std::min(s.length, 2.0f * glm::length(glm::vec3(lattice().cells) * lattice().cellSize));
        made.from = lattice().toGrid(s.from), made.to = lattice().toGrid(s.from + made.length * s.travel);
        made.toLight = -s.travel, made.flux = s.flux;
        made.isInside = glm::all(glm::greaterThanEqual(glm::min(made.from, made.to), glm::vec3(0.0f))) &&
                        glm::all(glm::lessThanEqual(glm::max(made.from, made.to), glm::vec3(lattice().cells)));
    }

    void read(const SegmentBlock& block, SegmentList& list) const
    {
        resizeAnew(list.segments, block.segments.size());
        for (std::size_t i = 0; i < list.segments.size(); ++i) toGrid(block.segments[i], list.segments[i]);
        for (int axis = 0; axis < (isTracks() ? 0 : 3); ++axis) {
            const PlaneRange all{0, lattice().cells[axis]};
            auto& crossed = list.crossed[static_cast<std::size_t>(axis)];
            resizeAnew(crossed, list.segments.size());
            std::ranges::transform(list.segments, crossed.begin(), [&](const GridSegment& s) {
                return ShortRange(crossedPlanes(s.from[axis], s.to[axis]).within(all));
            });
        }
    }

    /// Moves the sums of a stretch of slots to totals.
    void settle(std::size_t first, std::size_t end, std::vector<Totals>& totals)
    {
        for (std::size_t i = first; i < end; ++i) {
            for (std::size_t k = 0; k < kSummed; ++k) totals[i][k] += static_cast<double>(slots[i].sums[k]);
            slots[i].sums = {};
        }
    }

    /// m2, what is open of a face; 0 where nothing is.
    [[nodiscard]] double openArea(std::size_t index, int axis) const
    {
        const glm::ivec3 vertex = lattice().vertex(index);
        double area = static_cast<double>(lattice().faceArea(axis) * openness().faceShare[index][axis]);
        for (const int across : {(axis + 1) % 3, (axis + 2) % 3}) area *= isBorder(vertex, across) ? 0.5 : 1.0;
        return area;
    }
    [[nodiscard]] double openVolume(std::size_t index) const
    {
        const glm::ivec3 vertex = lattice().vertex(index);
        double volume = static_cast<double>(lattice().cellVolume() * openness().cellShare[index]);
        for (int axis = 0; axis < 3; ++axis) volume *= isBorder(vertex, axis) ? 0.5 : 1.0;
        return volume;
    }
    [[nodiscard]] bool isBorder(glm::ivec3 vertex, int axis) const
    {
        return vertex[axis] == 0 || vertex[axis] == lattice().cells[axis];
    }

    std::shared_ptr<const GridGeometry> geometry;
    GridEstimator estimator;
    std::vector<Slot> slots;
    std::vector<SegmentList> lists; // of the call's blocks
};

GridDeposit::GridDeposit(std::shared_ptr<const GridGeometry> geometry, GridEstimator estimator)
    : GridDeposit(std::make_shared<Work>(std::move(geometry), estimator))
{
}
GridDeposit::GridDeposit(std::shared_ptr<Work> work) : work_(std::move(work)), totals_(work_->slots.size(), Totals{}) {}
GridDeposit::~GridDeposit() = default;

std::unique_ptr<GridDeposit> GridDeposit::another() const
{
    return std::unique_ptr<GridDeposit>(new GridDeposit(work_));
}

bool GridDeposit::add(std::span<const SegmentBlock* const> blocks, Workers& workers, const std::stop_token& stop)
{
    Work& work = *work_;
    work.lists.resize(std::max(work.lists.size(), blocks.size()));
    const bool isRead = workers.run(blocks.size(), stop, [&](std::size_t b) { work.read(*blocks[b], work.lists[b]); });
    if (!isRead) return false;
    const auto slabs = work.slabs(workers.threadCount());
    std::atomic<std::uint64_t> deposits = 0;
    const bool isSummed = workers.run(slabs.size(), stop, [&](std::size_t task) {
        std::uint64_t count = 0;
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            if (stop.stop_requested()) return;
            const SegmentList& list = work.lists[b];
            count += work.isTracks() ? work.pass(list, slabs[task]) : work.cross(list, slabs[task]);
        }
        deposits += count;
    });
    deposits_ += deposits;
    if (!isSummed || stop.stop_requested()) return false;
    constexpr std::size_t kStretch = 4096;
    const std::size_t stretches = (work.slots.size() + kStretch - 1) / kStretch;
    return workers.run(stretches, stop, [&](std::size_t s) {
        work.settle(s * kStretch, std::min(work.slots.size(), (s + 1) * kStretch), totals_);
    });
}

const std::shared_ptr<const GridGeometry>& GridDeposit::geometry() const { return work_->geometry; }
GridEstimator GridDeposit::estimator() const { return work_->estimator; }
std::uint64_t GridDeposit::deposits() const { return deposits_; }

GridLayer GridDeposit::layer(int group, double scale) const
{
    const Work& work = *work_;
    const GridLattice& lattice = work.lattice();
    GridLayer layer{group, {}, {}};
    layer.vectors.resize(lattice.vertexCount(), IrradianceVectors{});
    layer.variance.resize(lattice.vertexCount(), {});
    for (std::size_t i = 0; i < lattice.vertexCount(); ++i) {
        for (std::size_t d = 0; d < 6; ++d) {
            const int axis = static_cast<int>(d / 2), side = static_cast<int>(d % 2);
            const double open = work.isTracks() ? work.openVolume(i) : work.openArea(i, axis);
            if (open <= 0.0) continue;
            Totals total{};
            double square = 0.0;
            if (work.isTracks()) {
                for (std::size_t octant = 0; octant < 8; ++octant) {
                    if (static_cast<int>(octant >> axis & 1) != side) continue;
                    const Totals& part = totals_[8 * i + octant];
                    for (std::size_t k = 0; k < kSquares; ++k) total[k] += part[k];
                    square += part[kSquares + std::size_t(axis)];
                }
            } else {
                total = totals_[work.faceIndex(axis, lattice.vertex(i), side)];
                square = total[kSquares];
            }
            layer.vectors[i][d] = matrixOf(total, scale / open);
            layer.variance[i][d] = static_cast<float>(square * (scale / open) * (scale / open));
        }
    }
    return layer;
}

double GridDeposit::bytesFor(const GridLattice& lattice, GridEstimator estimator, int groups)
{
    return static_cast<double>(lattice.vertexCount() * slotsPerVertex(estimator)) *
           static_cast<double>(sizeof(Slot) + static_cast<std::size_t>(groups) * sizeof(Totals));
}

double GridDeposit::bytesPerSegment() { return sizeof(GridSegment) + 3 * sizeof(ShortRange); }

} // namespace lightloom
