// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/hash.h"
#include "core/base/result.h"
#include "core/field/indirect_field.h"
#include "core/params/bake_params.h"
#include "core/photonmap/christensen_cache.h"
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace lightloom {

class IrradianceGrid;
class LightOctree;
class VoxelField;
struct PhotonPaths;

/// What a bake file says about itself.
struct BakeInfo {
    Method method = Method::lightOctree;
    BakeParams params;
    std::string isa;                 ///< that Embree used
    Sha256::Digest sceneHash{};      ///< of the scene it was baked for
    std::vector<std::string> groups; ///< ids of all light groups, in the scene's order
    std::vector<std::string> off;    ///< ids of those that were off: they have no layer
    std::string program;             ///< version that wrote it
    std::string incomplete;          ///< of exports: in what way it is less than was asked for; empty: it is all
};

struct BakeFile {
    BakeInfo info;
    std::shared_ptr<const LightOctree> octree;               ///< method light-octree
    std::shared_ptr<const IrradianceGrid> grid;              ///< method irradiance-grid
    std::shared_ptr<const VoxelField> voxels;                ///< method voxel-lightcuts
    std::vector<std::shared_ptr<const PhotonPaths>> photons; ///< method photon-map, by light group; null: was off
    std::vector<ChristensenCache::Values> caches;            ///< the same with photons.lookup=christensen, else empty
};

/// Bytes of a bake file: one OpenVDB stream, sealed (vdb_seal.h). Grids, all in the file's frame:
///   light-octree/d<depth>/geometry/{normal,centroid,area}/<entry>      one per orientation of a leaf
///   light-octree/d<depth>/<group>/scalar/<entry>                       lux on the entry's own surface
///   light-octree/d<depth>/<group>/noise/<entry>                        standard error of its luminance, lux
///   light-octree/d<depth>/<group>/{colour,direction}/<entry>/<slot>    the VDLs
///   light-octree/d<depth + i>/<group>/geometry/..., .../light/...      the same of the group's deeper leaves
///   irradiance-grid/d0/geometry/{face_share,cell_share,sight_low,sight_high}   of vertices in the open, voxels around
///   them irradiance-grid/d0/<group>/vectors/<direction>/<channel>           I_delta, lux; <direction> -x +x -y +y -z
///   +z irradiance-grid/d0/<group>/variance/<direction>                    of the luminance of I_delta . delta, lux^2
///   voxel-lightcuts/d<depth>/geometry/{normal,centroid,area,albedo}/<entry>  of surface voxels
///   voxel-lightcuts/d<depth>/<group>/{direct,indirect,indirect_by_rays}/<entry>  lux on the entry's own surface
///   photon-map/d0/<group>/{position,to_light,flux,normal}/0/0          photon i at (i % 128, i / 128 % 128, i / 16384)
///   photon-map/d0/<group>/{irradiance,noise}/0/0                       of Christensen's cache, point i likewise, lux
/// "/" in group ids is written %2F. The same bake gives the same bytes; nothing in it depends on time or host.
/// `field` is what the method of `info` published.
[[nodiscard]] Result<std::vector<std::uint8_t>> bakeBytes(const IndirectField& field, const BakeInfo& info,
                                                          const Scene& scene);
Result<Done> writeBake(const std::filesystem::path& path, const IndirectField& field, const BakeInfo& info,
                       const Scene& scene);

/// Reads a bake for `scene`. Refused with one clear line: damaged or truncated files, newer formats, other scenes.
[[nodiscard]] Result<BakeFile> readBake(const std::filesystem::path& path, const Scene& scene);
[[nodiscard]] Result<BakeFile> bakeFromBytes(std::span<const std::uint8_t> file, const Scene& scene);

inline constexpr int kBakeFormat = 3; ///< rises when older programs could misread a file

} // namespace lightloom
