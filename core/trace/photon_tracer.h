// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/base/raw_vector.h"
#include "core/trace/light_sampler.h"

namespace lightloom {

/// A stored hit of a photon: second surface or later, or after a specular bounce (METHODS section 1).
struct Photon {
    glm::vec3 position; ///< on the surface, scene space
    glm::vec3 toLight;  ///< unit: where the light comes from (minus the photon's travel)
    glm::vec3 flux;     ///< lumen per channel, divided by the number shot
    glm::vec3 normal;   ///< geometric, unit, of the side that was hit
};

/// Where the light of a group went, lumen per channel in double. emitted = absorbed + escaped + terminated.
struct Ledger {
    glm::dvec3 emitted{0.0}, absorbed{0.0}, escaped{0.0}, terminated{0.0};
    [[nodiscard]] glm::dvec3 missing() const { return emitted - absorbed - escaped - terminated; }
    Ledger& operator+=(const Ledger& o)
    {
        emitted += o.emitted, absorbed += o.absorbed, escaped += o.escaped, terminated += o.terminated;
        return *this;
    }
};

/// All photons of one light group, in an order that is always the same: blocks of 4096 numbers one after the other.
struct PhotonPaths {
    int group = 0;
    std::uint64_t shot = 0;    ///< photons that left the lamps: normalises
    std::uint64_t rays = 0;    ///< rays traced
    std::uint64_t caustic = 0; ///< stored after a specular bounce without a diffuse one before
    std::uint64_t cutOff = 0;  ///< paths that reached the longest length
    Ledger ledger;
    RawVector<Photon> photons;
    /// The counts alone.
    [[nodiscard]] PhotonPaths withoutPhotons() const { return {group, shot, rays, caustic, cutOff, ledger, {}}; }
};

struct PhotonJob {
    int group = 0;
    std::uint64_t seed = 1, count = 0;
    int pathDepth = 64;
    bool oneByOne = false; ///< each photon's rays alone, not eight photons' together: slower, to compare with
};

/// Shoots a group's photons. Photon i is a function of (seed, group id, i): the result is the same bits on any number
/// of threads. Eight photons are under way at a time, and their rays traced together. `blockDone(done, all)` is called
/// after each block of 4096 from some worker. Null: stopped.
[[nodiscard]] std::shared_ptr<const PhotonPaths>
tracePhotons(const RayScene& rays, const LightSampler& lights, const PhotonJob& job, Workers& workers,
             const std::stop_token& stop, const std::function<void(std::uint64_t, std::uint64_t)>& blockDone = {});

} // namespace lightloom
