// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/bake/gpu_layout.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/trace/light_reach.h"
#include <QMetaType>
#include <QString>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lightloom {

/// A refinement of a bake, ready for the viewport: made on a worker, never changed afterwards, cheap to copy.
struct BakeView {
    Snapshot snapshot;                             ///< its field is under the mix numbered `mixSerial`
    std::shared_ptr<const GpuOctree> gpu;          ///< null: the layout was refused, see `problem`
    std::shared_ptr<const IndirectField> colours;  ///< the snapshot's field as a colour octree
    std::shared_ptr<const GpuOctree> gpuOfColours; ///< the same for the viewport; as `gpu`
    QString problem;                               ///< why there is nothing to show; empty: there is
    std::shared_ptr<const PhotonMapField> photons; ///< that it was baked from, under the same mix; null: not known
    BakeParams params;                             ///< that it was baked with
    std::uint64_t mixSerial = 0;
    std::shared_ptr<const RayScene> rays;                         ///< of the same scene, for measuring direct light
    std::shared_ptr<const LightSampler> lights;                   ///< of the same scene
    std::shared_ptr<const LightReach> reach;                      ///< likewise
    std::shared_ptr<const std::vector<SurfacePoint>> noisePoints; ///< where noise is asked for; null: nowhere
    std::optional<double> noise; ///< what the bake itself states, a fraction of the mean, under its mix
    double cpuSeconds = 0;       ///< of all threads, until this was published; what was kept counts as it cost then
    std::uint64_t leaves = 0, entries = 0;
};

/// Light under the cursor.
struct Measurement {
    bool isOnSurface = false;
    glm::vec3 position{0.0f};               ///< scene space
    double directLux = 0, indirectLux = -1; ///< luminance of the illuminance; negative: not known there
};

/// `view` under another mix. Any thread; a few milliseconds to some hundred for the largest bakes.
[[nodiscard]] BakeView withMix(BakeView view, const Mix& mix, std::uint64_t mixSerial);

} // namespace lightloom

Q_DECLARE_METATYPE(lightloom::BakeView)
Q_DECLARE_METATYPE(lightloom::Measurement)
