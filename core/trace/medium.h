// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/material.h"

namespace lightloom {

/// What a path runs through: air, or the solid glass it entered last. A border is always one between glass and air: of
/// glass within glass the inner one counts alone, and bends light as if air lay around it. The back of a border tells
/// the medium by itself, so that paths may begin inside and open meshes do no harm.
class Medium {
public:
    [[nodiscard]] bool isAir() const { return !isInside_; }
    /// True if the segment that ended at `hit` ran through glass that absorbs.
    [[nodiscard]] bool absorbs(const Hit& hit, const Surface& surface) const
    {
        if (!isInside_ && !(surface.glass.share > 0.0f)) return false; // nearly always
        return along(hit, surface) != glm::vec3(0.0f);
    }
    /// What that segment left of the light, per channel (Beer's law).
    [[nodiscard]] glm::vec3 transmittance(const Hit& hit, const Surface& surface) const
    {
        return glm::exp(-along(hit, surface) * hit.distance);
    }
    /// Call after the path has gone on from `hit`.
    void cross(const Hit& hit, const Surface& surface, const Scatter& next)
    {
        if (!next.isThrough || surface.glass.isThin) return;
        isInside_ = hit.isFront;
        absorption_ = hit.isFront ? surface.glass.absorption : glm::vec3(0.0f);
    }

private:
    [[nodiscard]] glm::vec3 along(const Hit& hit, const Surface& surface) const
    {
        const bool tells = !hit.isFront && surface.glass.share > 0.0f && !surface.glass.isThin;
        return tells ? surface.glass.absorption : absorption_;
    }

    bool isInside_ = false;
    glm::vec3 absorption_{0.0f}; // 1/m
};

} // namespace lightloom
