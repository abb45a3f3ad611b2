// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/chart_pack.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace lightloom {
namespace {

using Word = std::uint64_t;
constexpr int kWord = 64;

/// A set of blocks, rows of bits.
class Blocks {
public:
    Blocks(int width, int height)
        : width_(width), height_(height), words_((width + kWord - 1) / kWord + 1),
          bits_(static_cast<std::size_t>(words_) * static_cast<std::size_t>(height), 0)
    {
    }
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    void set(int x, int y) { word(x, y) |= Word(1) << (x % kWord); }
    [[nodiscard]] bool has(int x, int y) const { return (row(y)[x / kWord] >> (x % kWord)) & 1; }

    /// Whether `shape` laid at (x, y) meets a block of this set. It must lie inside.
    [[nodiscard]] bool meets(const Blocks& shape, int x, int y) const
    {
        const int shift = x % kWord;
        for (int r = 0; r < shape.height_; ++r) {
            const Word* mine = row(y + r) + x / kWord;
            const Word* other = shape.row(r);
            for (int w = 0; w + 1 < shape.words_; ++w) {
                if ((other[w] << shift) & mine[w]) return true;
                if (shift > 0 && ((other[w] >> (kWord - shift)) & mine[w + 1])) return true;
            }
        }
        return false;
    }
    /// All blocks of row `y` taken.
    [[nodiscard]] bool isFull(int y) const
    {
        for (int x = 0; x < width_; ++x) {
            if (x % kWord == 0 && x + kWord <= width_ && row(y)[x / kWord] == ~Word(0)) {
                x += kWord - 1;
                continue;
            }
            if (!has(x, y)) return false;
        }
        return true;
    }

private:
    [[nodiscard]] const Word* row(int y) const
    {
        return bits_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(words_);
    }
    Word& word(int x, int y)
    {
        return bits_[static_cast<std::size_t>(y) * static_cast<std::size_t>(words_) +
                     static_cast<std::size_t>(x / kWord)];
    }

    int width_, height_, words_; // one word more than needed, so that a shifted row may look past its end
    std::vector<Word> bits_;
};

/// Whether a triangle and a box meet; touching counts. Separating axes: the box's two and the triangle's three.
bool meet(const std::array<glm::dvec2, 3>& t, glm::dvec2 low, glm::dvec2 high)
{
    if (glm::max(t[0].x, glm::max(t[1].x, t[2].x)) < low.x || glm::min(t[0].x, glm::min(t[1].x, t[2].x)) > high.x ||
        glm::max(t[0].y, glm::max(t[1].y, t[2].y)) < low.y || glm::min(t[0].y, glm::min(t[1].y, t[2].y)) > high.y) {
        return false;
    }
    const glm::dvec2 centre = 0.5 * (low + high), half = 0.5 * (high - low);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 edge = t[(k + 1) % 3] - t[k], across(-edge.y, edge.x);
        const double own = glm::dot(across, t[k]), tip = glm::dot(across, t[(k + 2) % 3]);
        const double middle = glm::dot(across, centre);
        const double reach = std::abs(across.x) * half.x + std::abs(across.y) * half.y;
        if (middle + reach < std::min(own, tip) || middle - reach > std::max(own, tip)) return false;
    }
    return true;
}

/// The blocks that a chart needs for itself at a scale, its low corner's block at (0, 0).
Blocks footprint(const Chart& chart, bool isTurned, double scale)
{
    const ChartPlace atOrigin{glm::ivec2(0), isTurned};
    const glm::dvec2 size = glm::dvec2(isTurned ? glm::vec2(chart.size.y, chart.size.x) : chart.size) * scale;
    const auto blocks = [](double texels) {
        return std::max(1, static_cast<int>(std::ceil((texels + 2.0 * kPadding) / kBlock)));
    };
    Blocks shape(blocks(size.x), blocks(size.y));
    for (const glm::uvec3 c : chart.corners) {
        const std::array<glm::dvec2, 3> t{atOrigin.texel(chart, chart.uv[c.x], scale),
                                          atOrigin.texel(chart, chart.uv[c.y], scale),
                                          atOrigin.texel(chart, chart.uv[c.z], scale)};
        const glm::dvec2 low = glm::min(t[0], glm::min(t[1], t[2])), high = glm::max(t[0], glm::max(t[1], t[2]));
        const glm::ivec2 from = glm::max(glm::ivec2(glm::floor((low - double(kPadding)) / double(kBlock))), 0);
        const glm::ivec2 to = glm::min(glm::ivec2(glm::floor((high + double(kPadding)) / double(kBlock))),
                                       glm::ivec2(shape.width() - 1, shape.height() - 1));
        for (int y = from.y; y <= to.y; ++y) {
            for (int x = from.x; x <= to.x; ++x) {
                const glm::dvec2 corner(glm::ivec2(x, y) * kBlock);
                if (!shape.has(x, y) && meet(t, corner - double(kPadding), corner + double(kBlock + kPadding))) {
                    shape.set(x, y);
                }
            }
        }
    }
    return shape;
}

class Packer {
public:
    Packer(int side, std::size_t charts) : taken_(side, side)
    {
        packing_.side = side;
        packing_.places.resize(charts);
        packing_.owner.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), -1);
        for (int y = 0; y < std::min(kVoidBlocks, side); ++y) {
            for (int x = 0; x < std::min(kVoidBlocks, side); ++x) taken_.set(x, y);
        }
    }

    bool place(const Chart& chart, std::size_t number, double scale)
    {
        const std::array<Blocks, 2> shapes{footprint(chart, false, scale), footprint(chart, true, scale)};
        while (firstRow_ < packing_.side && taken_.isFull(firstRow_)) ++firstRow_;
        std::optional<glm::ivec2> best;
        bool isTurned = false;
        for (int turn = 0; turn < 2; ++turn) {
            const std::optional<glm::ivec2> at = find(shapes[static_cast<std::size_t>(turn)]);
            const auto bottom = [&](glm::ivec2 p, int t) { return p.y + shapes[static_cast<std::size_t>(t)].height(); };
            if (!at || (best && bottom(*at, turn) >= bottom(*best, 0))) continue;
            best = at;
            isTurned = turn == 1;
        }
        if (!best) return false;
        take(shapes[isTurned ? 1 : 0], *best, static_cast<std::int32_t>(number));
        packing_.places[number] = {*best, isTurned};
        return true;
    }

    Packing& packing() { return packing_; }

private:
    /// First place from the top. Shapes of one size look on where the last of them was found: what lies above was full
    /// for it, and its gaps differ too little to look again.
    std::optional<glm::ivec2> find(const Blocks& shape)
    {
        int& row = rows_[{shape.width(), shape.height()}];
        for (row = std::max(row, firstRow_); row + shape.height() <= packing_.side; ++row) {
            for (int x = 0; x + shape.width() <= packing_.side; ++x) {
                if (!taken_.meets(shape, x, row)) return glm::ivec2(x, row);
            }
        }
        return {};
    }

    void take(const Blocks& shape, glm::ivec2 at, std::int32_t number)
    {
        for (int y = 0; y < shape.height(); ++y) {
            for (int x = 0; x < shape.width(); ++x) {
                if (!shape.has(x, y)) continue;
                taken_.set(at.x + x, at.y + y);
                packing_.owner[static_cast<std::size_t>(at.y + y) * static_cast<std::size_t>(packing_.side) +
                               static_cast<std::size_t>(at.x + x)] = number;
            }
        }
    }

    Packing packing_;
    Blocks taken_;
    std::map<std::pair<int, int>, int> rows_;
    int firstRow_ = 0;
};

double areaOf(const std::vector<Chart>& charts)
{
    double sum = 0.0;
    for (const Chart& chart : charts) sum += chart.stretch.area;
    return sum;
}

} // namespace

std::optional<Packing> pack(const std::vector<Chart>& charts, int side, double texelsPerMetre,
                            const std::stop_token& stop)
{
    double most = 0.0; // texels of the longest chart: it must fit, and its blocks into memory
    for (const Chart& chart : charts) most = std::max(most, double(chart.size.x) * texelsPerMetre);
    if (!(most <= double(side) * kBlock)) return {};
    std::vector<std::uint32_t> order(charts.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) {
        const glm::vec2 s = charts[a].size, t = charts[b].size;
        return s.x + s.y > t.x + t.y;
    });
    Packer packer(side, charts.size());
    packer.packing().texelsPerMetre = texelsPerMetre;
    for (const std::uint32_t i : order) {
        if (stop.stop_requested() || !packer.place(charts[i], i, texelsPerMetre)) return {};
    }
    return std::move(packer.packing());
}

std::optional<Packing> packIntoSide(const std::vector<Chart>& charts, int side, const std::stop_token& stop)
{
    const double area = areaOf(charts);
    if (charts.empty() || !(area > 0.0)) return pack(charts, side, 1.0, stop);
    double high = side * kBlock / std::sqrt(area); // full to the last texel: cannot fit
    double low = 0.75 * high;
    std::optional<Packing> best;
    for (int i = 0; i < 40 && !best && !stop.stop_requested(); ++i) {
        best = pack(charts, side, low, stop);
        if (!best) high = low, low *= 0.8;
    }
    while (best && high > 1.01 * low && !stop.stop_requested()) {
        const double middle = 0.5 * (low + high);
        std::optional<Packing> tried = pack(charts, side, middle, stop);
        if (tried) best = std::move(tried);
        (best->texelsPerMetre == middle ? low : high) = middle;
    }
    if (stop.stop_requested()) return {};
    return best;
}

} // namespace lightloom
