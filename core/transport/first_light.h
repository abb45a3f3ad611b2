// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/surface.h"
#include "core/transport/voxel_bounces.h"
#include <functional>

namespace lightloom {

/// What a surface sends on of the light that falls on it, its metallic part as if it scattered evenly; per channel, at
/// most kLargestAlbedo.
[[nodiscard]] inline glm::vec3 evenAlbedo(const Surface& surface)
{
    return glm::min(surface.diffuse + surface.specular, glm::vec3(kLargestAlbedo));
}

/// The same without what a mirror sends on.
[[nodiscard]] inline glm::vec3 mattAlbedo(const Surface& surface)
{
    return surface.isMirror() ? glm::min(surface.diffuse, glm::vec3(kLargestAlbedo)) : evenAlbedo(surface);
}

/// What each entry's surface sends on of the light that falls on it, per channel: its diffuse and metallic parts,
/// textures looked up at the centroids of its pieces, weighted by area. Metals count as if they scattered evenly.
/// O(pieces).
[[nodiscard]] std::vector<glm::vec3> entryAlbedos(const RayScene& rays, const LightReach& reach,
                                                  const SurfaceVoxels& voxels);

/// The same without mirrors and glass, whose light photons carry (`specularLight`). Empty: no entry has any.
[[nodiscard]] std::vector<glm::vec3> entryMattAlbedos(const RayScene& rays, const LightReach& reach,
                                                      const SurfaceVoxels& voxels);

/// A place on an entry's surface from which lamps are looked for.
struct PointOnEntry {
    glm::vec3 position, normal;
};

/// Such places of all entries: entry e's are [e * samples, (e + 1) * samples).
struct EntryPoints {
    int samples = 0;
    std::vector<PointOnEntry> points;
    [[nodiscard]] static std::size_t bytesFor(std::size_t entries, int samples)
    {
        return entries * static_cast<std::size_t>(samples) * sizeof(PointOnEntry);
    }
};

/// `samples` points spread over the surface of each entry; those of entry e depend on (seed, e) alone. They hold
/// whatever lamps do, and cost more than the shadow rays from them: facets are clipped to their cell anew. The same on
/// any number of threads. Null: stopped.
[[nodiscard]] std::shared_ptr<const EntryPoints> entryPoints(const LightReach& reach, const SurfaceVoxels& voxels,
                                                             int samples, std::uint64_t seed, Workers& workers,
                                                             const std::stop_token& stop);

/// Direct illuminance (lux) of each entry, red, green and blue of one of `groups` (light groups by number) after the
/// other: shadow rays to their lamps from `samples` points that are spread over its surface (METHODS 5: better than
/// photons, but for light that comes by mirrors or through glass, which this leaves out: `specularLight`). Points of
/// entry e depend on (seed, e) alone, shadow rays on these and the group: a group gets the same light whatever others
/// are asked for, to the bit, on any number of threads. `kept`, where given: `entryPoints` of the same samples and
/// seed, which are made for this call alone without; the light is the same. Empty: stopped.
[[nodiscard]] EntryValues firstLight(const LightSampler& lights, const LightReach& reach, const SurfaceVoxels& voxels,
                                     std::span<const int> groups, int samples, std::uint64_t seed, Workers& workers,
                                     const std::stop_token& stop,
                                     const std::function<void(double fraction)>& progress = {},
                                     const EntryPoints* kept = nullptr);

/// What entries send on of the light that falls on them: lux times albedo, lm/m2.
[[nodiscard]] EntryValues reflected(EntryValues lux, std::span<const glm::vec3> albedo);

} // namespace lightloom
