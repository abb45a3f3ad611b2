// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"
#include "core/photonmap/photon_map.h"
#include "core/photonmap/surface_area.h"

namespace lightloom {

/// What every photon method needs of a job, taken from `products` or made now.
struct PhotonProducts {
    SceneProducts scene;
    std::shared_ptr<const SurfaceArea> area;
    std::vector<std::shared_ptr<const PhotonMap>> maps; ///< by light group; null: the lamp is off
};

/// How well it has to be known what light reaches.
enum class ReachWanted {
    exact,
    quick ///< for a picture at once: roughly, unless it is known exactly from before
};

/// Ray scene, lamps and reach of the job's scene. Where an edit moved a lamp, triangles and spaces are the earlier ones
/// and only that lamp is looked at anew.
[[nodiscard]] Result<SceneProducts> sceneProducts(const BakeJob& job, BakeProducts& products, BakeControl& control,
                                                  ReachWanted reach = ReachWanted::exact);

/// Error out of memory if the job's photons would not fit into this machine, with the figure.
[[nodiscard]] Result<Done> checkPhotonsFit(const BakeJob& job);

/// The above, and photons with their trees for each lamp that is on. Shot once per (surface, lamps of the
/// group, seed, count), whatever method asks and wherever other lamps are. Tells progress from 0 to `share` of the
/// bake. Error out of memory is given before shooting.
[[nodiscard]] Result<PhotonProducts> photonProducts(const BakeJob& job, BakeProducts& products, BakeControl& control,
                                                    double share, ReachWanted reach = ReachWanted::exact);

/// What `photonProducts` left for the same job: nothing is made, nothing is counted as work. Nothing if not all is
/// there.
[[nodiscard]] std::optional<PhotonProducts> keptPhotons(const BakeJob& job, const SceneProducts& scene,
                                                        BakeProducts& products);

[[nodiscard]] inline Error cancelled() { return {Error::Kind::cancelled, "the bake was cancelled"}; }

} // namespace lightloom
