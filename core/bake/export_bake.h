// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/atlas/lightmap.h"
#include "core/bake/bake_file.h"
#include "core/base/image_file.h"

namespace lightloom {

/// What other programs are to get of a bake; empty paths: not wanted.
struct ExportRequest {
    std::filesystem::path lightmap; ///< .exr: lux per texel, plain RGB float, parameters in the header
    std::filesystem::path gltf;     ///< .glb: the scene with the lightmap in it; the .exr beside it is written too
    std::filesystem::path volume;   ///< .vdb: an octree's leaves or a grid's vertices (octree_volume.h, grid_volume.h)
    AtlasOptions atlas;
    bool withDirect = false; ///< direct light in the lightmap too; the lamps are then left out of the .glb
};

/// A finished bake and its scene.
struct ExportSource {
    const RayScene& rays;
    const LightSampler& lights;
    const LightReach* reach = nullptr; ///< null: found anew
    const IndirectField& field;
    const BakeInfo& info;
    Mix mix{}; ///< of the field; lamps are dimmed likewise
};

/// What was written, in order, and the atlas where one was made.
struct ExportReport {
    std::vector<std::filesystem::path> files;
    std::shared_ptr<const Atlas> atlas;
    float brightest = 0.0f; ///< lux, of any channel of any texel
    double lightMs = 0.0;   ///< for the light of all texels
};

/// Wrong wishes, told before any work: nothing asked for, names of the wrong kind, one file asked for twice, a volume
/// of a bake that is neither an octree nor a grid.
[[nodiscard]] Result<Done> checkExport(const ExportRequest& request, Method method);

/// Where the lightmap goes: as asked, or beside the .glb under its name. Empty: none is wanted.
[[nodiscard]] std::filesystem::path lightmapFile(const ExportRequest& request);

/// Makes everything first and writes it then, each file whole or not at all; a stop before that leaves no file.
/// `progress` from 0 to 1, on any worker. Same source and request, same bytes, on any number of threads.
[[nodiscard]] Result<ExportReport> exportBake(const ExportSource& source, const ExportRequest& request,
                                              Workers& workers, const std::stop_token& stop,
                                              const std::function<void(double)>& progress = {});

/// The lightmap as 8-bit image over its brightest channel, which is returned as `intensity`.
struct EncodedLightmap {
    Image image;
    float intensity = 1.0f;
};
[[nodiscard]] EncodedLightmap encodeLightmap(const FloatImage& lux);

} // namespace lightloom
