// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/photon_map.h"
#include "core/base/ordering.h"
#include "core/base/wide_vectors.h"
#include <algorithm>
#include <bit>
#include <limits>

namespace lightloom {

struct PhotonMap::Record {
    float p[3];
    std::uint32_t number;
};

namespace {

/// Blocks that go left. Splits fall between blocks, so that all blocks but the last are full.
std::uint32_t leftBlocks(std::uint32_t blocks) { return (blocks + 1) / 2; }

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
    map->nodes_.resize(2 * std::size_t(std::bit_ceil(blocks)));
    if (blocks > 0) map->split(records, 0, blocks, 0, stop);
    if (stop.stop_requested() || !map->takeInOrder(*paths, records, stop)) return nullptr;
    for (std::uint32_t b = 0; b < blocks; ++b) map->fill(b);
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

void PhotonMap::fill(std::uint32_t number)
{
    Block& block = blocks_[number];
    for (std::uint32_t i = 0; i < kBlock; ++i) {
        const std::size_t at = std::size_t(number) * kBlock + i;
        const bool used = at < paths_.photons.size();
        // an empty place is infinitely far away, and stays so whatever is added to it
        const glm::vec3 p = used ? paths_.photons[at].position : glm::vec3(std::numeric_limits<float>::infinity());
        const glm::vec3 n = used ? paths_.photons[at].normal : glm::vec3(0.0f);
        block.x[i] = p.x, block.y[i] = p.y, block.z[i] = p.z;
        block.nx[i] = n.x, block.ny[i] = n.y, block.nz[i] = n.z;
    }
}

void PhotonMap::split(std::vector<Record>& records, std::uint32_t firstBlock, std::uint32_t blocks, std::uint32_t node,
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
    const std::uint32_t left = leftBlocks(blocks);
    Record* middle = first + std::size_t(left) * kBlock;
    const auto splitAlong = axis == 0 ? splitAt<0, Record> : axis == 1 ? splitAt<1, Record> : splitAt<2, Record>;
    if (!splitAlong(first, middle, last, stop)) return;
    nodes_[node] = {middle->p[axis], axis};
    split(records, firstBlock, left, 2 * node + 1, stop);
    split(records, firstBlock + left, blocks - left, 2 * node + 2, stop);
}

std::size_t PhotonMap::memoryBytes() const
{
    return blocks_.size() * sizeof(Block) + nodes_.size() * sizeof(Node) +
           paths_.photons.size() * (sizeof(Photon) + sizeof(std::uint32_t));
}

namespace {

/// Leaves the `count` least keys, in their order. Returns the squared distance of the largest of them.
float nearest(std::uint32_t count, std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& work)
{
    work = keys; // selection shuffles: what is left must not depend on what else was there
    const auto last = work.begin() + static_cast<std::ptrdiff_t>(count) - 1;
    std::nth_element(work.begin(), last, work.end());
    const std::uint64_t most = *last;
    std::size_t kept = 0;
    for (const std::uint64_t key : keys) {
        keys[kept] = key;
        kept += key <= most ? 1 : 0;
    }
    keys.resize(kept);
    return std::bit_cast<float>(static_cast<std::uint32_t>(most >> 32));
}

} // namespace

/// State of one query. `keys` holds candidates as distance bits above, number below: one integer comparison orders
/// both.
struct PhotonMap::Search {
    const GatherQuery& query;
    float stretch; // stretch^2 - 1
    float limit;   // squared distance beyond which nothing is wanted
    std::vector<std::uint64_t>& keys;
    std::vector<std::uint64_t>& work;
};

namespace {

/// Distances of a block's photons under the query's metric and their normals' cosines. Sixteen lanes at once on
/// whatever vectors the machine has; without contraction every clone gives the same bits.
LIGHTLOOM_WIDE_VECTORS void measure(const float* __restrict x, const float* __restrict y, const float* __restrict z,
                                    const float* __restrict nx, const float* __restrict ny, const float* __restrict nz,
                                    const float* q, float* __restrict squared, float* __restrict cosine)
{
    const float cx = q[0], cy = q[1], cz = q[2], ax = q[3], ay = q[4], az = q[5], stretch = q[6];
    for (int i = 0; i < 16; ++i) {
        const float dx = x[i] - cx, dy = y[i] - cy, dz = z[i] - cz;
        const float along = dx * ax + dy * ay + dz * az;
        squared[i] = dx * dx + dy * dy + dz * dz + stretch * along * along;
        cosine[i] = nx[i] * ax + ny[i] * ay + nz[i] * az;
    }
}

} // namespace

void PhotonMap::scan(Search& search, std::uint32_t number) const
{
    const Block& block = blocks_[number];
    const GatherQuery& query = search.query;
    const float q[7] = {query.centre.x, query.centre.y, query.centre.z, query.normal.x,
                        query.normal.y, query.normal.z, search.stretch};
    alignas(64) float squared[kBlock], cosine[kBlock];
    measure(block.x, block.y, block.z, block.nx, block.ny, block.nz, q, squared, cosine);
    for (std::uint32_t i = 0; i < kBlock; ++i) {
        if (!(squared[i] <= search.limit) || !(cosine[i] > query.leastCosine)) continue;
        search.keys.push_back(std::uint64_t(std::bit_cast<std::uint32_t>(squared[i])) << 32 | (number * kBlock + i));
    }
    if (search.keys.size() >= 2 * std::size_t(query.count))
        search.limit = nearest(query.count, search.keys, search.work);
}

void PhotonMap::descend(Search& search, std::uint32_t firstBlock, std::uint32_t blocks, std::uint32_t node,
                        glm::vec3 offset, float squared) const
{
    if (squared > search.limit) return;
    if (blocks == 1) return scan(search, firstBlock);
    const Node here = nodes_[node];
    const float beyond = search.query.centre[here.axis] - here.split;
    const std::uint32_t left = leftBlocks(blocks);
    // distance to the far half's box: replace what this axis contributed so far
    const float old = offset[here.axis];
    const float farSquared = squared - old * old + beyond * beyond;
    glm::vec3 farOffset = offset;
    farOffset[here.axis] = beyond;
    if (beyond < 0.0f) {
        descend(search, firstBlock, left, 2 * node + 1, offset, squared);
        descend(search, firstBlock + left, blocks - left, 2 * node + 2, farOffset, farSquared);
    } else {
        descend(search, firstBlock + left, blocks - left, 2 * node + 2, offset, squared);
        descend(search, firstBlock, left, 2 * node + 1, farOffset, farSquared);
    }
}

void PhotonMap::gather(const GatherQuery& query, Gathered& out) const
{
    out.photons.clear();
    out.keys.clear();
    out.radius = query.radius;
    out.isFull = false;
    if (blocks_.empty() || query.count == 0) return;
    // if the guess holds enough photons it holds the nearest; if not, the search begins again without it
    const bool isGuessed = out.expected > 0.0f && out.expected < query.radius;
    if (isGuessed) collect(query, out.expected, out);
    if (!isGuessed || out.keys.size() < query.count) {
        out.keys.clear();
        collect(query, query.radius, out);
    }
    if (out.keys.size() >= query.count) {
        out.radius = std::sqrt(nearest(query.count, out.keys, out.work));
        out.expected = 1.1f * out.radius;
        out.isFull = true;
    }
    out.photons.resize(out.keys.size());
    for (std::size_t i = 0; i < out.keys.size(); ++i) out.photons[i] = static_cast<std::uint32_t>(out.keys[i]);
}

void PhotonMap::collect(const GatherQuery& query, float radius, Gathered& out) const
{
    Search search{query, query.stretch * query.stretch - 1.0f, radius * radius, out.keys, out.work};
    descend(search, 0, static_cast<std::uint32_t>(blocks_.size()), 0, glm::vec3(0.0f), 0.0f);
}

} // namespace lightloom
