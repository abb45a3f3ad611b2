// SPDX-License-Identifier: Apache-2.0
#include "core/transport/line_partners.h"
#include "core/base/rng.h"

namespace lightloom {
namespace {

constexpr std::int32_t kSameWall = 2; ///< slices

/// Above 0: `at` lies before the entry's plane, in cells.
float before(const Orientation& entry, glm::vec3 at, float cell)
{
    return glm::dot(at - entry.centroid, entry.normal) / cell;
}

} // namespace

LinePartners::Faces LinePartners::facesOf(std::uint32_t voxel, glm::vec3 along) const
{
    constexpr float kApart = 1e-3f; // cells: the two sides of a sheet are neither before nor behind each other
    const std::uint32_t first = voxels_.firstEntry[voxel], end = voxels_.firstEntry[voxel + 1];
    Faces faces;
    for (std::uint32_t e = first; e < end; ++e) {
        const Orientation& entry = voxels_.entries[e];
        const float cosine = glm::dot(entry.normal, along);
        faces.back |= cosine < -kAlongSurface;
        if (!(cosine > kAlongSurface)) continue;
        faces.forth = true;
        for (std::uint32_t o = first; o < end && !faces.areConcave; ++o) {
            const Orientation& other = voxels_.entries[o];
            faces.areConcave = glm::dot(other.normal, along) < -kAlongSurface &&
                               before(entry, other.centroid, voxels_.cellSize()) > kApart &&
                               before(other, entry.centroid, voxels_.cellSize()) > kApart;
        }
    }
    return faces;
}

/// One of the voxel's entries that face `towards`, drawn by area times cosine.
std::uint32_t LinePartners::pick(std::uint32_t voxel, glm::vec3 towards) const
{
    const std::uint32_t first = voxels_.firstEntry[voxel], end = voxels_.firstEntry[voxel + 1];
    const auto seen = [&](std::uint32_t e) {
        const float cosine = glm::dot(voxels_.entries[e].normal, towards);
        return cosine > kAlongSurface ? voxels_.entries[e].area * cosine : 0.0f;
    };
    float all = 0.0f;
    std::uint32_t last = kNothing, count = 0;
    for (std::uint32_t e = first; e < end; ++e) {
        if (seen(e) > 0.0f) all += seen(e), last = e, ++count;
    }
    if (count < 2) return last;
    float rest = all * Rng(number_, 0, voxel).uniform();
    for (std::uint32_t e = first; e < end; ++e) {
        if (seen(e) > 0.0f && (rest -= seen(e)) < 0.0f) return e;
    }
    return last;
}

void LinePartners::wait(Line& line, std::uint32_t voxel, glm::vec3 along)
{
    for (std::uint32_t e = voxels_.firstEntry[voxel]; e < voxels_.firstEntry[voxel + 1]; ++e) {
        if (!(glm::dot(voxels_.entries[e].normal, along) > kAlongSurface)) continue;
        nextWaiting_[e] = line.firstWaiting;
        line.firstWaiting = e;
    }
    line.lastWaiting = voxel;
}

void LinePartners::close(Line& line, std::uint32_t voxel, std::int32_t slice, glm::vec3 along)
{
    if (line.lastWaiting != kNothing) {
        const std::uint32_t seen = pick(voxel, -along);
        for (std::uint32_t e = line.firstWaiting; e != kNothing; e = nextWaiting_[e]) partners_[e] = seen;
        line.emitter = line.lastWaiting;
        line.firstWaiting = line.lastWaiting = kNothing;
    } else if (slice - line.closedAt > kSameWall) {
        line.emitter = kNothing;
    }
    line.closedAt = slice;
    if (line.emitter == kNothing) return;
    const std::uint32_t seen = pick(line.emitter, along);
    for (std::uint32_t e = voxels_.firstEntry[voxel]; e < voxels_.firstEntry[voxel + 1]; ++e) {
        if (glm::dot(voxels_.entries[e].normal, along) < -kAlongSurface) partners_[e] = seen;
    }
}

std::span<std::uint32_t> LinePartners::find(const LineDirection& direction, std::uint32_t number)
{
    number_ = number;
    const LineNumbers numbers(direction, voxels_.cells);
    if (lines_.size() < numbers.count()) lines_.resize(numbers.count());
    if (++stamp_ == 0) std::ranges::fill(lines_, Line{}), stamp_ = 1;
    partners_.assign(voxels_.entries.size(), kNothing);
    nextWaiting_.resize(voxels_.entries.size());
    const glm::vec3 along = direction.unit;
    for (const VoxelPlace& place : orders_.along(direction.major)) {
        Line& line = lines_[numbers.of(place)];
        if (line.stamp != stamp_) line = {.stamp = stamp_};
        const Faces faces = facesOf(place.voxel, along);
        if (faces.areConcave) wait(line, place.voxel, along);
        if (faces.back) close(line, place.voxel, place.slice, along);
        if (faces.forth && !faces.areConcave) wait(line, place.voxel, along);
    }
    return partners_;
}

} // namespace lightloom
