// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/indirect_field.h"
#include "core/params/bake_params.h"
#include "core/trace/final_gather.h"
#include "core/trace/reference.h"
#include <functional>
#include <optional>
#include <vector>

namespace lightloom {

/// Light at probe points as a method sees it: exact direct light, and indirect light from a field, gathered where the
/// field keeps no answer (mid-air). What `probe`, `compare` and `sweep` call a method's result. A point's light depends
/// on the seed and the point's own stream, not on its place in a table. Any thread may ask; keeps references only.
class FieldProbe {
public:
    /// `field` null: no indirect light.
    FieldProbe(const RayScene& rays, const LightSampler& lights, const IndirectField* field, const BakeParams& params);
    FieldProbe(const FieldProbe&) = delete; // cached_ points here
    FieldProbe& operator=(const FieldProbe&) = delete;

    [[nodiscard]] glm::vec3 direct(const ProbePoint& point) const;   ///< lux per channel
    [[nodiscard]] glm::vec3 indirect(const ProbePoint& point) const; ///< lux per channel

    /// `indirect` at all points, on all workers; nothing if stopped before the end.
    [[nodiscard]] std::optional<std::vector<glm::vec3>>
    indirect(const std::vector<ProbePoint>& points, Workers& workers, const std::stop_token& stop,
             const std::function<void(double fraction)>& progress = {}) const;

private:
    const RayScene& rays_;
    const LightSampler& lights_;
    const IndirectField* field_;
    std::uint64_t seed_;
    int directSamples_, probeRays_;
    CachedIndirect cached_;
};

} // namespace lightloom
