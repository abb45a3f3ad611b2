// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/photon_map.h"
#include "core/base/ordering.h"
#include "core/base/wide_vectors.h"
#include "core/photonmap/least_keys.h"
#include "core/photonmap/screen_lanes.h"
#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace lightloom {

struct PhotonMap::Record {
    float p[3];
    std::uint32_t number;
};

namespace {

/// Orders by (coordinate, number): with ties broken the tree is the same on any machine.
template<int Axis, class Record>
bool splitAt(Record* first, Record* middle, Record* last, const std::stop_token& stop)
{
    const auto isBefore = [](const Record& a, const Record& b) {
        return a.p[Axis] != b.p[Axis] ? a.p[Axis] < b.p[Axis] : a.number < b.number;
    };
    return selectNth(first, middle, last, isBefore, stop);
}

int widestAxis(glm::vec3 size)
{
    if (size.x >= size.y && size.x >= size.z) return 0;
    return size.y >= size.z ? 1 : 2;
}

} // namespace

std::shared_ptr<const PhotonMap> PhotonMap::build(const std::shared_ptr<const PhotonPaths>& paths,
                                                  const std::stop_token& stop)
{
    const std::shared_ptr<PhotonMap> map(new PhotonMap);
    std::vector<Record> records(paths->photons.size());
    for (std::uint32_t i = 0; i < records.size(); ++i) {
        if (i % 65'536 == 0 && stop.stop_requested()) return nullptr;
        const glm::vec3 p = paths->photons[i].position;
        records[i] = {{p.x, p.y, p.z}, i};
    }
    const auto blocks = static_cast<std::uint32_t>((records.size() + kBlock - 1) / kBlock);
    map->blocks_.resize(blocks);
    if (blocks > 0) split(records, 0, blocks, stop);
    if (stop.stop_requested() || !map->takeInOrder(*paths, records, stop)) return nullptr;
    std::vector<BoxGroups::Box> boxes(blocks);
    BoxGroups::Box all;
    for (std::uint32_t b = 0; b < blocks; ++b) {
        boxes[b] = map->fill(b);
        all.add(boxes[b].low), all.add(boxes[b].high);
    }
    map->boxes_ = BoxGroups(boxes);
    if (blocks > 0)
        map->everyRadius_ = glm::distance(all.low, all.high) / std::sqrt(static_cast<float>(records.size()));
    return map;
}

bool PhotonMap::takeInOrder(const PhotonPaths& paths, const std::vector<Record>& records, const std::stop_token& stop)
{
    paths_ = paths.withoutPhotons();
    paths_.photons.resize(records.size());
    origin_.resize(records.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
        if (i % 65'536 == 0 && stop.stop_requested()) return false;
        origin_[i] = records[i].number;
        paths_.photons[i] = paths.photons[records[i].number];
    }
    return true;
}

std::vector<std::uint32_t> PhotonMap::listOrder() const
{
    std::vector<std::uint32_t> order(origin_.size());
    for (std::uint32_t i = 0; i < origin_.size(); ++i) order[origin_[i]] = i;
    return order;
}

BoxGroups::Box PhotonMap::fill(std::uint32_t number)
{
    Block& block = blocks_[number];
    BoxGroups::Box box;
    for (std::uint32_t i = 0; i < kBlock; ++i) {
        const std::size_t at = std::size_t(number) * kBlock + i;
        const bool used = at < paths_.photons.size();
        // an empty place is infinitely far away, and stays so whatever is added to it
        const glm::vec3 p = used ? paths_.photons[at].position : glm::vec3(std::numeric_limits<float>::infinity());
        const glm::vec3 n = used ? paths_.photons[at].normal : glm::vec3(0.0f);
        block.x[i] = p.x, block.y[i] = p.y, block.z[i] = p.z;
        block.nx[i] = n.x, block.ny[i] = n.y, block.nz[i] = n.z;
        if (used) box.add(p);
    }
    return box;
}

void PhotonMap::split(std::vector<Record>& records, std::uint32_t firstBlock, std::uint32_t blocks,
                      const std::stop_token& stop)
{
    Record* first = records.data() + std::size_t(firstBlock) * kBlock;
    Record* last = records.data() + std::min(records.size(), (std::size_t(firstBlock) + blocks) * kBlock);
    if (blocks == 1) {
        std::ranges::sort(first, last, {}, &Record::number); // selection leaves them in any order
        return;
    }
    if (blocks > 1024 && stop.stop_requested()) return;
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
    for (const Record* r = first; r < last; ++r) {
        const glm::vec3 p(r->p[0], r->p[1], r->p[2]);
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    const int axis = widestAxis(high - low);
    const std::uint32_t left = BoxGroups::firstPart(blocks); // splits fall between blocks: all but the last are full
    Record* middle = first + std::size_t(left) * kBlock;
    const auto splitAlong = axis == 0 ? splitAt<0, Record> : axis == 1 ? splitAt<1, Record> : splitAt<2, Record>;
    if (!splitAlong(first, middle, last, stop)) return;
    split(records, firstBlock, left, stop);
    split(records, firstBlock + left, blocks - left, stop);
}

std::size_t PhotonMap::memoryBytes() const
{
    return blocks_.size() * sizeof(Block) + boxes_.memoryBytes() +
           paths_.photons.size() * (sizeof(Photon) + sizeof(std::uint32_t));
}

namespace {

constexpr std::size_t kAhead = 2; ///< blocks that are asked for before they are scanned: they lie far apart in memory

template<class Element>
void fetch(const Element* first, std::size_t count)
{
    const auto begin = reinterpret_cast<std::uintptr_t>(first);
    for (std::uintptr_t line = 0; line < count * sizeof(Element); line += 64)
        __builtin_prefetch(reinterpret_cast<const void*>(begin + line)); // past the end of an array it does nothing
}

} // namespace

/// State of one query. Distances are measured from `centre` with those along `normal` stretched.
struct PhotonMap::Search {
    float centre[3], normal[3];
    float stretch;            // stretch^2 - 1
    float leastCosine, limit; // squared distance beyond which nothing is wanted
    std::size_t wanted;       // K, or all there are
    std::size_t room;         // for candidates
    std::uint64_t* keys;      // candidates
    std::size_t found = 0;
    std::vector<std::uint64_t>& work;
    Screens screens;

    /// Keeps the K nearest.
    void thin()
    {
        const std::uint64_t most = leastKey(keys, found, wanted, work);
        found = keepUpTo(most, keys, found);
        limit = squaredOf(most);
    }
};

namespace {

/// Adds the photons of a block that the query may want to `keys`. Sixteen lanes at once on whatever vectors the machine
/// has; without contraction every clone gives the same bits.
template<class Search>
[[gnu::always_inline]] inline std::size_t addNear(const Search& s, const float* x, const float* y, const float* z,
                                                  const float* nx, const float* ny, const float* nz,
                                                  std::uint32_t number)
{
    Ints8 bits[2], isNear[2];
    for (std::size_t half = 0; half < 2; ++half) {
        const Floats8 dx = lanesOf<Floats8>(x, half) - s.centre[0], dy = lanesOf<Floats8>(y, half) - s.centre[1],
                      dz = lanesOf<Floats8>(z, half) - s.centre[2];
        const Floats8 along = dx * s.normal[0] + dy * s.normal[1] + dz * s.normal[2];
        const Floats8 squared = dx * dx + dy * dy + dz * dz + s.stretch * along * along;
        const Floats8 cosine = lanesOf<Floats8>(nx, half) * s.normal[0] + lanesOf<Floats8>(ny, half) * s.normal[1] +
                               lanesOf<Floats8>(nz, half) * s.normal[2];
        isNear[half] = (squared <= s.limit) & (cosine > s.leastCosine);
        if (!s.screens.empty()) dropHidden(s.screens, dx, dy, dz, isNear[half]);
        std::memcpy(&bits[half], &squared, sizeof squared);
    }
    std::uint64_t* const first = s.keys + s.found;
    std::uint64_t* next = first;
    for (std::size_t i = 0; i < 2 * kLanes; ++i) { // without branches: they would be taken half the time
        const auto distance = static_cast<std::uint32_t>(bits[i / kLanes][i % kLanes]);
        *next = std::uint64_t(distance) << 32 | (number + i);
        next -= isNear[i / kLanes][i % kLanes];
    }
    return static_cast<std::size_t>(next - first);
}

} // namespace

LIGHTLOOM_WIDE_VECTORS std::size_t PhotonMap::addBlock(const Search& search, const Block& block, std::uint32_t number)
{
    return addNear(search, block.x, block.y, block.z, block.nx, block.ny, block.nz, number);
}

void PhotonMap::scan(Search& search, std::uint32_t number) const
{
    const std::size_t added = addBlock(search, blocks_[number], number * kBlock);
    search.found += added;
    if (added > 0) fetch(&paths_.photons[std::size_t(number) * kBlock], kBlock); // whoever gathers looks at them next
    if (search.found + kBlock > search.room) search.thin();
}

/// All photons within the root of `search.limit`, or so many of them that the nearest K are among them.
void PhotonMap::collect(Search& search, BoxGroups::Near& near) const
{
    const glm::vec3 centre(search.centre[0], search.centre[1], search.centre[2]);
    search.found = 0;
    std::span<std::uint64_t> blocks = boxes_.within(centre, search.limit, near);
    const std::size_t few = 8 + search.wanted / 8;
    if (blocks.size() > 4 * few) { // too many by far: the nearest ones tell how far off the K-th photon is at most
        std::ranges::nth_element(blocks, blocks.begin() + static_cast<std::ptrdiff_t>(few));
        for (const std::uint64_t key : blocks.first(few)) scan(search, static_cast<std::uint32_t>(key));
        if (search.found >= search.wanted) search.thin();
        search.found = 0;
        blocks = boxes_.within(centre, search.limit, near);
    }
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        if (i + kAhead < blocks.size()) fetch(&blocks_[static_cast<std::uint32_t>(blocks[i + kAhead])], 1);
        if (squaredOf(blocks[i]) <= search.limit) scan(search, static_cast<std::uint32_t>(blocks[i]));
    }
}

void PhotonMap::gather(const GatherQuery& query, Gathered& out) const
{
    out.photons.clear();
    out.keys.clear();
    out.radius = query.radius;
    out.isFull = false;
    if (blocks_.empty() || query.count == 0) return;
    const std::size_t wanted = std::min<std::size_t>(query.count, size()), room = 2 * wanted + 4 * kBlock;
    out.candidates.resize(std::max(out.candidates.size(), room));
    Search search{{query.centre.x, query.centre.y, query.centre.z},
                  {query.normal.x, query.normal.y, query.normal.z},
                  query.stretch * query.stretch - 1.0f,
                  query.leastCosine,
                  0.0f,
                  wanted,
                  room,
                  out.candidates.data(),
                  0,
                  out.work,
                  query.screens};
    // if a guess holds enough photons it holds the nearest; if not, the search begins again with a wider one
    float radius = out.expected > 0.0f ? out.expected : everyRadius_ * std::sqrt(static_cast<float>(wanted));
    while (true) {
        const bool isLast = !(radius > 0.0f && radius < query.radius);
        if (isLast) radius = query.radius;
        search.limit = std::min(radius * radius, std::numeric_limits<float>::max()); // empty places stay outside
        collect(search, out.near);
        if (isLast || search.found >= wanted) break;
        radius *= 1.2f * std::sqrt(static_cast<float>(wanted + kBlock) / static_cast<float>(search.found + 1));
    }
    if (search.found >= query.count) {
        search.thin();
        out.radius = std::sqrt(search.limit);
        out.expected = 1.1f * out.radius;
        out.isFull = true;
    }
    out.keys.assign(search.keys, search.keys + search.found);
    out.photons.resize(search.found);
    for (std::size_t i = 0; i < search.found; ++i) {
        out.photons[i] = static_cast<std::uint32_t>(out.keys[i]);
    }
}

} // namespace lightloom
