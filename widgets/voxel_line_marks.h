// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/params/voxel_choices.h"
#include "widgets/gl/mark_pass.h"
#include <QMetaType>
#include <QString>
#include <memory>

namespace lightloom {

struct BakeView;
struct SurfaceVoxels;
class LightReach;

/// Lines of one direction through a bake's voxels, as marks; `about` says what they are. Nothing to draw: no marks.
struct VoxelLineMarks {
    int direction = -1;
    std::vector<Mark> marks;
    QString about;
};

/// Voxels that lines were drawn through last: another direction needs no others.
struct LineVoxels {
    std::shared_ptr<const LightReach> reach;
    int cells = 0;
    float shift = 0.0f;
    VoxelLines lines = VoxelLines::covered;
    std::shared_ptr<const SurfaceVoxels> voxels;
};

/// Lines of direction number `direction` (from 0) with the pairs of entries that exchange light along them, coloured by
/// what each takes, through the voxels of `view`. Some 100 ms for the largest; any thread.
[[nodiscard]] VoxelLineMarks voxelLineMarks(const BakeView& view, int direction, LineVoxels& kept);

} // namespace lightloom

Q_DECLARE_METATYPE(lightloom::VoxelLineMarks)
