// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/view_eye.h"

/// The two ways through a picture: all pixels alike, or each as long as it needs.
namespace lightloom {

/// What both need.
struct ViewPass {
    const Eye& eye;
    const ViewJob& job;
    Lens lens;
    Workers& workers;
    const std::stop_token& stop;
    const std::function<void(double)>& progress;
    std::vector<MiddleLight>* middles = nullptr; ///< of all blocks; null: each sample asks the field

    [[nodiscard]] std::size_t blockCount() const; ///< of ViewJob::block
    /// `middles`, for each pixel the one of its block.
    [[nodiscard]] std::vector<int> cutSizes() const;
    [[nodiscard]] std::size_t pixelCount() const
    {
        return static_cast<std::size_t>(job.width) * static_cast<std::size_t>(job.height);
    }
    /// Sample `number` of a pixel; `perBatch` samples are one even set over the pixel.
    [[nodiscard]] Radiance sample(std::size_t pixel, std::uint64_t number, int perBatch) const;

private:
    [[nodiscard]] std::size_t blockOf(int x, int y) const;
    [[nodiscard]] const MiddleLight& middleOf(int x, int y) const;
};

/// One camera ray at a time for every pixel, so that a stop leaves an even picture.
[[nodiscard]] View evenView(const ViewPass& pass, std::vector<PixelSums>& pixels);

/// Where in the pixel sample `number` looks: `perBatch` samples are one even set over it.
[[nodiscard]] glm::vec2 placeInPixel(const ViewJob& job, std::size_t pixel, std::uint64_t number, int perBatch);

/// Block after block, each until its errors meet the target.
[[nodiscard]] View adaptiveView(const ViewPass& pass, std::vector<PixelLight>& ended);

/// Tells which pixels a square block of the picture holds.
class Blocks {
public:
    Blocks(int width, int height, int side)
        : width_(width), height_(height), side_(side), across_((width + side - 1) / side)
    {
    }
    [[nodiscard]] std::size_t count() const
    {
        return static_cast<std::size_t>(across_) * static_cast<std::size_t>((height_ + side_ - 1) / side_);
    }
    /// Calls `visit(pixel)` in rows from the top; stops early when it gives false.
    template<class Visit>
    void forPixels(std::size_t block, const Visit& visit) const
    {
        const int left = static_cast<int>(block) % across_ * side_, top = static_cast<int>(block) / across_ * side_;
        for (int y = top; y < glm::min(top + side_, height_); ++y) {
            for (int x = left; x < glm::min(left + side_, width_); ++x) {
                const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
                if (!visit(row + static_cast<std::size_t>(x))) return;
            }
        }
    }

private:
    int width_, height_, side_, across_;
};

} // namespace lightloom
