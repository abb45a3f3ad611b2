// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/voxel_discs.h"
#include "core/base/image.h"
#include "core/base/units.h"
#include "core/voxel/voxel_field.h"
#include <algorithm>
#include <cmath>

namespace lightloom {

namespace {

std::uint8_t byteOf(float shown)
{
    return static_cast<std::uint8_t>(std::lround(255.0f * glm::clamp(shown, 0.0f, 1.0f)));
}

constexpr int kMostDecades = 4; ///< a dark room beside a bright one shows as well

/// As many as all but the darkest hundredth of what is lit takes up: a scene of little contrast gets all the colours.
int decadesOf(std::vector<float> values, float top)
{
    std::erase_if(values, [](float v) { return !(v > 0.0f); });
    if (values.empty()) return kMostDecades;
    const auto least = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 100);
    std::ranges::nth_element(values, least);
    return std::clamp(static_cast<int>(std::ceil(std::log10(top / *least))), 1, kMostDecades);
}

glm::u8vec4 asShown(glm::vec3 linear)
{
    return {byteOf(encodeSrgb(linear.x)), byteOf(encodeSrgb(linear.y)), byteOf(encodeSrgb(linear.z)), 255};
}

glm::u8vec4 ofNormal(glm::vec3 n)
{
    const glm::vec3 shown = 0.5f + 0.5f * n;
    return {byteOf(shown.x), byteOf(shown.y), byteOf(shown.z), 255};
}

} // namespace

std::shared_ptr<const VoxelDiscs> voxelDiscs(const VoxelField& field, VoxelMarks by)
{
    if (by == VoxelMarks::none) return nullptr;
    const OctreeGeometry& leaves = *field.surface().leaves;
    auto out = std::make_shared<VoxelDiscs>();
    out->by = by;
    out->cellSize = leaves.cellSize();
    const float face = out->cellSize * out->cellSize;
    ScalarImage values{static_cast<int>(leaves.entries.size()), 1, {}};
    for (std::size_t e = 0; e < leaves.entries.size(); ++e) {
        const OctreeEntry& entry = leaves.entries[e];
        out->discs.push_back({entry.centroid, std::sqrt(entry.area / kPi), entry.normal, ofNormal(entry.normal)});
        values.values.push_back(by == VoxelMarks::area ? entry.area / face : luminance(field.exitance(e)));
    }
    if (by == VoxelMarks::normal) return out;
    const bool isArea = by == VoxelMarks::area;
    out->scale.kind = ErrorKind::absolute;
    out->scale.unit = isArea ? LegendUnit::percent : LegendUnit::plain;
    out->scale.top = isArea ? 1.0f : legendTop(values); // more than a face, as slanted surface has, is a full voxel too
    out->scale.decades = isArea ? 0 : decadesOf(values.values, out->scale.top);
    for (std::size_t e = 0; e < out->discs.size(); ++e)
        out->discs[e].colour = asShown(out->scale.colourOf(values.values[e]));
    return out;
}

} // namespace lightloom
