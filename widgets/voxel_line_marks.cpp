// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/voxel_line_marks.h"
#include "core/base/image.h"
#include "core/base/units.h"
#include "core/compare/legend.h"
#include "core/voxel/shown_lines.h"
#include "core/voxel/voxel_cuts.h"
#include "core/voxel/voxel_solver.h"
#include "widgets/bake_view.h"
#include <cmath>

namespace lightloom {

namespace {

constexpr std::size_t kMostLines = 250;
constexpr float kDecades = 3.0f; ///< of colours, below the brightest
const glm::vec4 kLine(1.0f, 1.0f, 1.0f, 0.22f), kExact(0.55f, 0.85f, 0.4f, 1.0f);

/// As the bake made them; null: it is none of voxels, or they cannot be made again.
std::shared_ptr<const SurfaceVoxels> voxelsOf(const BakeView& view, const VoxelField& field, LineVoxels& kept)
{
    if (!view.rays || !view.reach) return nullptr;
    const int cells = field.surface().cells;
    const float shift = view.params.gridShift;
    const VoxelLines lines = view.params.voxelLines;
    if (kept.reach != view.reach || kept.cells != cells || kept.shift != shift || kept.lines != lines) {
        Workers workers(1);
        auto voxels = voxelise(view.rays->scene().bounds, *view.reach, cells, shift, workers, {});
        kept = {view.reach, cells, shift, lines, voxelsFor(lines, std::move(voxels))};
    }
    const bool isSame = kept.voxels && kept.voxels->entries.size() == field.surface().leaves->entries.size();
    return isSame ? kept.voxels : nullptr;
}

/// Over the picture, where the dark end of the colours would be lost.
glm::vec4 asShown(float value, float top)
{
    constexpr float kDarkest = 0.35f;
    const float part = value > 0.0f ? 1.0f + std::log10(value / top) / kDecades : 0.0f;
    const glm::vec3 linear = falseColour(kDarkest + (1.0f - kDarkest) * glm::clamp(part, 0.0f, 1.0f));
    return {encodeSrgb(linear.x), encodeSrgb(linear.y), encodeSrgb(linear.z), 1.0f};
}

} // namespace

VoxelLineMarks voxelLineMarks(const BakeView& view, int direction, LineVoxels& kept)
{
    VoxelLineMarks out;
    out.direction = direction;
    const auto* cuts = dynamic_cast<const VoxelCuts*>(view.snapshot.field.get());
    const auto* field = cuts ? &cuts->field() : dynamic_cast<const VoxelField*>(view.snapshot.field.get());
    if (direction < 0 || !field) return out;
    const auto voxels = voxelsOf(view, *field, kept);
    if (!voxels || voxels->entries.empty()) return out;
    const ShownLines shown = shownLines(*view.rays, *voxels, kept.lines, direction, kMostLines);

    for (const ShownLines::Line& line : shown.lines) out.marks.push_back({line.from, line.to, kLine, 1.0f});
    ScalarImage taken{static_cast<int>(shown.pairs.size()), 1, {}};
    for (const ShownLines::Pair& pair : shown.pairs) taken.values.push_back(luminance(field->exitance(pair.partner)));
    const float top = legendTop(taken);
    for (std::size_t i = 0; i < shown.pairs.size(); ++i) {
        const ShownLines::Pair& pair = shown.pairs[i];
        const glm::vec3 a = voxels->entries[pair.entry].centroid, b = voxels->entries[pair.partner].centroid;
        out.marks.push_back({a, b, pair.isExact ? kExact : asShown(taken.values[i], top), 1.6f});
    }
    const glm::ivec3 step = shown.direction.step;
    out.about = QObject::tr("Direction (%1, %2, %3): %L4 lines, %5 drawn (faint) with %L6 pairs that exchange "
                            "light, dark to pale by up to %7 lm/m\u00b2 and more; green: by exact rays")
                    .arg(step.x)
                    .arg(step.y)
                    .arg(step.z)
                    .arg(shown.allLines)
                    .arg(shown.every == 1 ? QObject::tr("all") : QObject::tr("one of %1 each way").arg(shown.every))
                    .arg(shown.pairs.size())
                    .arg(static_cast<double>(top), 0, 'g', 3);
    return out;
}

} // namespace lightloom
