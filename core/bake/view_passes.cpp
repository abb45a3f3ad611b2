// SPDX-License-Identifier: Apache-2.0
#include "core/bake/view_passes.h"
#include "core/base/crossed_mean.h"
#include "core/base/low_discrepancy.h"
#include "core/base/units.h"
#include <atomic>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint64_t kViewStream = hashName("render view"), kGoalStream = hashName("render view, first look");
constexpr int kTile = 16; ///< side of what one thread takes at a time; blocks of pixels are parts of it
constexpr int kBatch = 4; ///< samples; the spread of batches tells the error

View emptyView(const ViewJob& job)
{
    const FloatImage black(job.width, job.height);
    View view{black, black, black};
    view.samples = std::numeric_limits<int>::max();
    return view;
}

} // namespace

glm::vec2 placeInPixel(const ViewJob& job, std::size_t pixel, std::uint64_t number, int perBatch)
{
    const auto each = static_cast<std::uint64_t>(perBatch);
    Rng shift(job.seed, mixBits(kViewStream ^ pixel), number / each); // one shift makes a batch one even set
    return ShiftedPoints(perBatch, shift)[static_cast<int>(number % each)];
}

Radiance ViewPass::sample(std::size_t pixel, std::uint64_t number, int perBatch) const
{
    Rng rng(job.seed, mixBits(kViewStream + pixel), number);
    const auto width = static_cast<std::size_t>(job.width);
    const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
    glm::vec3 origin, travel;
    const MiddleLight* middle = middles ? &middleOf(x, y) : nullptr;
    lens.ray(x, y, placeInPixel(job, pixel, number, perBatch), origin, travel);
    return eye.along(origin, travel, rng, middle);
}

namespace {

int blocksAlong(int pixels, int block) { return (pixels + block - 1) / block; }

} // namespace

std::size_t ViewPass::blockCount() const
{
    return static_cast<std::size_t>(blocksAlong(job.width, job.block)) *
           static_cast<std::size_t>(blocksAlong(job.height, job.block));
}

std::size_t ViewPass::blockOf(int x, int y) const
{
    return static_cast<std::size_t>(y / job.block * blocksAlong(job.width, job.block) + x / job.block);
}

std::vector<int> ViewPass::cutSizes() const
{
    std::vector<int> sizes;
    sizes.reserve(pixelCount());
    for (int y = 0; y < job.height; ++y) {
        for (int x = 0; x < job.width; ++x) sizes.push_back((*middles)[blockOf(x, y)].cutSize);
    }
    return sizes;
}

/// The block's that pixel (x, y) lies in. Looked for by whoever comes first: one thread works on a block.
const MiddleLight& ViewPass::middleOf(int x, int y) const
{
    const int side = job.block;
    MiddleLight& middle = (*middles)[blockOf(x, y)];
    if (middle.isKnown) return middle;
    const int left = x / side * side, top = y / side * side;
    const glm::vec2 half = 0.5f * glm::vec2(glm::min(side, job.width - left), glm::min(side, job.height - top));
    glm::vec3 origin, travel;
    lens.ray(left, top, half, origin, travel);
    middle = eye.middle(origin, travel);
    return middle;
}

View evenView(const ViewPass& pass, std::vector<PixelSums>& pixels)
{
    const ViewJob& job = pass.job;
    pixels.resize(pass.pixelCount());
    const int perBatch = job.samples >= 2 * kBatch ? kBatch : 1; // two batches at least
    const Blocks tiles(job.width, job.height, kTile);
    const double all = static_cast<double>(tiles.count()) * job.samples;
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (const PixelSums& p : pixels) least = std::min(least, p.samples);
    std::atomic<std::uint64_t> done = least * tiles.count();
    const auto add = [&](std::size_t i, std::uint64_t number) {
        PixelSums& sums = pixels[i];
        if (sums.samples > number) return; // a stop came between this pixel and others
        const Radiance seen = pass.sample(i, number, perBatch);
        sums.direct += glm::dvec3(seen.direct);
        sums.indirect += glm::dvec3(seen.indirect);
        sums.open += glm::dvec3(seen.direct) + glm::dvec3(seen.indirect);
        if (++sums.samples % static_cast<std::uint64_t>(perBatch) != 0) return;
        const glm::dvec3 mean = sums.open / static_cast<double>(perBatch);
        sums.squares += mean * mean;
        sums.open = glm::dvec3(0.0);
    };
    for (std::uint64_t number = least; number < static_cast<std::uint64_t>(job.samples); ++number) {
        const bool whole = pass.workers.run(tiles.count(), pass.stop, [&](std::size_t tile) {
            tiles.forPixels(tile, [&](std::size_t i) {
                if (i % kTile == 0 && pass.stop.stop_requested()) return false;
                add(i, number);
                return true;
            });
            if (pass.progress) pass.progress(static_cast<double>(++done) / all);
        });
        if (!whole || pass.stop.stop_requested()) break;
    }

    View view = emptyView(job);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const PixelSums& sums = pixels[i];
        view.samples = glm::min(view.samples, static_cast<int>(sums.samples));
        view.rays += sums.samples;
        const double scale = 1.0 / static_cast<double>(std::max<std::uint64_t>(1, sums.samples));
        view.direct.pixels[i] = glm::vec3(sums.direct * scale);
        view.indirect.pixels[i] = glm::vec3(sums.indirect * scale);
        const auto n = static_cast<double>(sums.samples / static_cast<std::uint64_t>(perBatch));
        if (n < 2.0) continue;
        const glm::dvec3 mean = (sums.direct + sums.indirect - sums.open) / (n * perBatch);
        const glm::dvec3 spread = glm::max(glm::dvec3(0.0), sums.squares - n * mean * mean);
        view.standardError.pixels[i] = glm::vec3(glm::sqrt(spread / (n * (n - 1.0))));
    }
    view.isWhole = view.samples >= job.samples;
    return view;
}

namespace {

constexpr int kSide = 4;                   ///< pixels a side that decide together when they are done
constexpr std::size_t kFirstLook = 16'384; ///< samples, over the picture, that tell its mean luminance

using Sums = CrossedMean<6>; ///< cd/m2: direct R G B, direct + indirect R G B

double luminous(const Sums::Values& v, std::size_t first)
{
    return static_cast<double>(kLumaR) * v[first] + static_cast<double>(kLumaG) * v[first + 1] +
           static_cast<double>(kLumaB) * v[first + 2];
}

/// A rough picture, and the mean luminance of what it reflects.
double firstLook(const ViewPass& pass, View& view)
{
    const std::size_t each = (kFirstLook + pass.pixelCount() - 1) / pass.pixelCount();
    const Blocks tiles(pass.job.width, pass.job.height, kTile);
    std::vector<double> sums(tiles.count(), 0.0);
    pass.workers.run(tiles.count(), pass.stop, [&](std::size_t tile) {
        tiles.forPixels(tile, [&](std::size_t i) {
            for (std::size_t s = 0; s < each; ++s) {
                Rng rng(pass.job.seed, mixBits(kGoalStream + i), s);
                const float u = rng.uniform(), v = rng.uniform();
                const auto width = static_cast<std::size_t>(pass.job.width);
                glm::vec3 origin, travel;
                pass.lens.ray(static_cast<int>(i % width), static_cast<int>(i / width), {u, v}, origin, travel);
                const Radiance seen = pass.eye.along(origin, travel, rng);
                sums[tile] += static_cast<double>(luminance(seen.direct - seen.emitted + seen.indirect));
                view.direct.pixels[i] += seen.direct / static_cast<float>(each);
                view.indirect.pixels[i] += seen.indirect / static_cast<float>(each);
            }
            return !pass.stop.stop_requested();
        });
    });
    double sum = 0.0; // in the tiles' order: the same bits on any threads
    for (const double s : sums) sum += s;
    return sum / (static_cast<double>(each) * static_cast<double>(pass.pixelCount()));
}

/// The pixels of one block, worked on together.
class Block {
public:
    Block(const ViewPass& pass, const Blocks& blocks, std::size_t number) : pass_(pass)
    {
        blocks.forPixels(number, [&](std::size_t i) {
            pixels_.push_back(i);
            return true;
        });
        sums_.resize(pixels_.size());
    }
    /// False: stopped.
    bool refine(double goal)
    {
        const auto most = static_cast<std::uint64_t>((pass_.job.samples + kBatch - 1) / kBatch);
        while (!sums_[0].isEnded() && sums_[0].batches() < most) {
            if (pass_.stop.stop_requested()) return false;
            for (std::size_t k = 0; k < pixels_.size(); ++k) addBatch(k);
            if (!sums_[0].isLookDue()) continue;
            for (int chain = 0; chain < 2; ++chain) {
                if (sums_[0].isEnded(chain) || !(foretold(1 - chain) <= goal)) continue;
                for (Sums& s : sums_) s.end(chain);
            }
        }
        return true;
    }
    void write(std::vector<PixelLight>& ended) const
    {
        for (std::size_t k = 0; k < pixels_.size(); ++k) {
            PixelLight& light = ended[pixels_[k]];
            for (int c = 0; c < 3; ++c) {
                const auto d = static_cast<std::size_t>(c), w = d + 3;
                light.direct[c] = static_cast<float>(sums_[k].mean(d));
                light.indirect[c] = static_cast<float>(std::max(0.0, sums_[k].mean(w) - sums_[k].mean(d)));
                light.error[c] = static_cast<float>(sums_[k].standardError(w));
            }
            light.samples = static_cast<std::uint32_t>(sums_[k].batches() * kBatch);
        }
    }
    [[nodiscard]] bool isCapped() const { return !sums_[0].isEnded(); }
    [[nodiscard]] const std::vector<std::size_t>& pixels() const { return pixels_; }

private:
    void addBatch(std::size_t k)
    {
        const std::uint64_t first = sums_[k].batches() * kBatch;
        glm::dvec3 direct(0.0), whole(0.0);
        for (std::uint64_t s = first; s < first + kBatch; ++s) {
            const Radiance seen = pass_.sample(pixels_[k], s, kBatch);
            direct += glm::dvec3(seen.direct);
            whole += glm::dvec3(seen.direct) + glm::dvec3(seen.indirect);
        }
        direct /= kBatch;
        whole /= kBatch;
        sums_[k].add({direct.x, direct.y, direct.z, whole.x, whole.y, whole.z});
    }
    /// Rms over the pixels: one pixel's few batches say little of their own spread.
    [[nodiscard]] double foretold(int chain) const
    {
        double squares = 0.0;
        for (const Sums& s : sums_) {
            const double error = luminous(s.foretold(chain), 3);
            squares += error * error;
        }
        return std::sqrt(squares / static_cast<double>(sums_.size()));
    }

    const ViewPass& pass_;
    std::vector<std::size_t> pixels_;
    std::vector<Sums> sums_;
};

} // namespace

View adaptiveView(const ViewPass& pass, std::vector<PixelLight>& ended)
{
    View view = emptyView(pass.job);
    ended.resize(pass.pixelCount());
    const double goal = firstLook(pass, view) * static_cast<double>(pass.job.targetError);
    const Blocks blocks(pass.job.width, pass.job.height, kSide);
    std::atomic<std::size_t> done = 0;
    std::atomic<std::uint64_t> capped = 0;
    pass.workers.run(blocks.count(), pass.stop, [&](std::size_t number) {
        Block block(pass, blocks, number);
        if (ended[block.pixels().front()].samples == 0 && block.refine(goal)) {
            block.write(ended);
            if (block.isCapped()) capped += block.pixels().size();
        }
        if (pass.progress) pass.progress(static_cast<double>(++done) / static_cast<double>(blocks.count()));
    });

    const FloatImage direct = std::move(view.direct), indirect = std::move(view.indirect);
    view = viewOf(pass.job, ended);
    view.capped = capped;
    for (std::size_t i = 0; i < ended.size(); ++i) {
        if (ended[i].samples > 0) continue;
        view.direct.pixels[i] = direct.pixels[i];
        view.indirect.pixels[i] = indirect.pixels[i];
    }
    return view;
}

View viewOf(const ViewJob& job, const std::vector<PixelLight>& pixels)
{
    View view = emptyView(job);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const PixelLight& light = pixels[i];
        view.samples = glm::min(view.samples, static_cast<int>(light.samples));
        view.rays += light.samples;
        view.direct.pixels[i] = light.direct;
        view.indirect.pixels[i] = light.indirect;
        view.standardError.pixels[i] = light.error;
    }
    view.isWhole = view.samples > 0;
    return view;
}

} // namespace lightloom
