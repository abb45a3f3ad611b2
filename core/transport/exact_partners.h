// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/ray_scene.h"
#include "core/transport/line_partners.h"

namespace lightloom {

/// Partners by exact rays for entries whose discrete line leaves a closed room through a corner: few, but what they
/// miss is missing at every bounce. Where more than a twentieth of the entries found none the direction leads into the
/// open, and nothing is looked for.
class ExactPartners {
public:
    /// Both must outlive this; the rays' scene is the one that was voxelised.
    ExactPartners(const RayScene& rays, const SurfaceVoxels& voxels) : rays_(rays), voxels_(voxels) {}

    /// Fills in what `LinePartners::find` left at kNothing, as far as a ray finds surface with an entry.
    void complete(const LineDirection& direction, std::span<std::uint32_t> partners) const;

private:
    [[nodiscard]] std::uint32_t seenFrom(const Orientation& entry, glm::vec3 towards) const;

    const RayScene& rays_;
    const SurfaceVoxels& voxels_;
};

} // namespace lightloom
