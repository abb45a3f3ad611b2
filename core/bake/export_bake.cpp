// SPDX-License-Identifier: Apache-2.0
#include "core/bake/export_bake.h"
#include "core/atlas/atlas_scene.h"
#include "core/bake/grid_volume.h"
#include "core/bake/octree_volume.h"
#include "core/bake/voxel_volume.h"
#include "core/base/atomic_file.h"
#include "core/ivg/irradiance_grid.h"
#include "core/octree/light_octree.h"
#include "core/params/param_text.h"
#include "core/scene/gltf_writer.h"
#include "core/voxel/voxel_cuts.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

namespace fs = std::filesystem;

constexpr double kAtlasShare = 0.4, kLightShare = 0.9; ///< of the work, about

Error stopped() { return {Error::Kind::cancelled, "the export was interrupted; nothing was written"}; }

std::string lightOf(const ExportRequest& request) { return request.withDirect ? "direct+indirect" : "indirect"; }

ImageNotes notesOf(const ExportSource& source, const ExportRequest& request, const Atlas& atlas)
{
    const BakeInfo& info = source.info;
    ImageNotes notes{{"lightloom.version", info.program},
                     {"lightloom.method", std::string(methodName(info.method))},
                     {"lightloom.scene", toHex(info.sceneHash)},
                     {"lightloom.isa", info.isa},
                     {"lightloom.unit", "lux"},
                     {"lightloom.light", lightOf(request)},
                     {"lightloom.uv", request.atlas.useSceneUv ? "the scene's own TEXCOORD_1" : "atlas"},
                     {"lightloom.texels_per_metre", fmt::format("{}", atlas.report.texelsPerMetre)}};
    for (const ParamSpec& spec : kParams) {
        const bool counts = (spec.methods & (1u << static_cast<unsigned>(info.method))) != 0;
        if (counts) notes.emplace_back(fmt::format("lightloom.{}", spec.key), paramText(info.params, spec));
    }
    if (!info.incomplete.empty()) notes.emplace_back("lightloom.incomplete", info.incomplete);
    const std::vector<LightGroup>& groups = source.rays.scene().groups;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const glm::vec3 gain = gainOf(source.mix, static_cast<int>(g));
        if (gain == glm::vec3(1.0f)) continue;
        notes.emplace_back("lightloom.gain." + groups[g].id, fmt::format("{} {} {}", gain.x, gain.y, gain.z));
    }
    return notes;
}

/// All that is to be written.
struct Made {
    ExportReport report;
    std::optional<FloatImage> lux;
    std::vector<std::uint8_t> gltf, volume;
};

Result<Done> makeLightmap(const ExportSource& source, const ExportRequest& request, Workers& workers,
                          const std::stop_token& stop, const std::function<void(double)>& progress, Made& made)
{
    if (lightmapFile(request).empty()) return Done{};
    const auto tell = [&](double fraction) {
        if (progress) progress(fraction);
    };
    std::shared_ptr<const LightReach> found;
    if (!source.reach) found = LightReach::find(source.rays, source.lights, workers, stop);
    if (stop.stop_requested()) return stopped();
    const LightReach& reach = source.reach ? *source.reach : *found;
    const Result<std::shared_ptr<const Atlas>> atlas =
        makeAtlas(source.rays, reach, request.atlas, workers, stop, [&](double f) { tell(kAtlasShare * f); });
    if (!atlas) return atlas.error().kind == Error::Kind::cancelled ? stopped() : atlas.error();
    made.report.atlas = *atlas;

    const auto began = std::chrono::steady_clock::now();
    DirectInLightmap direct;
    if (request.withDirect)
        direct = {&source.lights, source.info.params.directSamples, source.info.params.seed, source.mix};
    made.lux = bakeLightmap(source.rays, **atlas, &source.field, direct, workers, stop,
                            [&](double f) { tell(kAtlasShare + (kLightShare - kAtlasShare) * f); });
    if (!made.lux) return stopped();
    made.report.lightMs = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
    for (const glm::vec3 e : made.lux->pixels) {
        made.report.brightest = std::max(made.report.brightest, std::max(e.x, std::max(e.y, e.z)));
    }
    return Done{};
}

/// Lamps and glowing surfaces as the mix has them.
void dim(Scene& scene, const Mix& mix)
{
    for (PunctualLight& light : scene.lights) light.intensity *= gainOf(mix, light.group);
    for (const Instance& instance : scene.instances) {
        const glm::vec3 gain = instance.group >= 0 ? gainOf(mix, instance.group) : glm::vec3(1.0f);
        if (gain == glm::vec3(1.0f)) continue;
        Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)]; // this instance's alone
        scene.materials.push_back(scene.materials[static_cast<std::size_t>(mesh.material)]);
        scene.materials.back().emission *= gain;
        mesh.material = static_cast<int>(scene.materials.size()) - 1;
    }
}

Result<Done> makeGltf(const ExportSource& source, const ExportRequest& request, Made& made)
{
    if (request.gltf.empty() || !made.lux) return Done{};
    UnwrappedScene unwrapped = unwrappedScene(source.rays, *made.report.atlas);
    dim(unwrapped.scene, source.mix);
    if (request.withDirect) unwrapped.scene.lights.clear(); // or their light would count twice
    EncodedLightmap encoded = encodeLightmap(*made.lux);
    GltfLightmap lightmap;
    lightmap.image = std::move(encoded.image);
    lightmap.intensity = encoded.intensity;
    lightmap.uv = std::move(unwrapped.uv);
    const fs::path folder = fs::absolute(request.gltf).parent_path();
    lightmap.hdrFile = fs::absolute(lightmapFile(request)).lexically_proximate(folder).generic_string();
    lightmap.light = lightOf(request);
    lightmap.incomplete = source.info.incomplete;
    Result<std::vector<std::uint8_t>> bytes = gltfBytes(unwrapped.scene, &lightmap);
    if (!bytes) return bytes.error();
    made.gltf = *std::move(bytes);
    return Done{};
}

Result<Done> makeVolume(const ExportSource& source, const ExportRequest& request, Made& made)
{
    if (request.volume.empty()) return Done{};
    const auto* octree = dynamic_cast<const LightOctree*>(&source.field);
    const auto* grid = dynamic_cast<const IrradianceGrid*>(&source.field);
    const auto* cuts = dynamic_cast<const VoxelCuts*>(&source.field); // of voxels, looked up in another way
    const auto* voxels = cuts ? &cuts->field() : dynamic_cast<const VoxelField*>(&source.field);
    const Scene& scene = source.rays.scene();
    Result<std::vector<std::uint8_t>> bytes = Error{Error::Kind::unsupported, "the bake has no volume"};
    if (octree) bytes = octreeVolume(*octree, source.info, scene);
    if (grid) bytes = gridVolume(*grid, source.info, scene);
    if (voxels) bytes = voxelVolume(*voxels, source.info, scene);
    if (!bytes) return bytes.error();
    made.volume = *std::move(bytes);
    return Done{};
}

/// One after the other; what was written stays if a later one cannot be.
Result<Done> writeAll(const ExportSource& source, const ExportRequest& request, Made& made)
{
    const auto write = [&](const fs::path& path, const auto& writer) -> Result<Done> {
        if (path.empty()) return Done{};
        const Result<Done> done = writer(path);
        if (done) made.report.files.push_back(path);
        return done;
    };
    LayeredImage image;
    if (made.lux) {
        image.notes = notesOf(source, request, *made.report.atlas);
        image.layers.push_back({"", *std::move(made.lux)});
    }
    Result<Done> done = write(lightmapFile(request), [&](const fs::path& path) { return writeExr(path, image); });
    if (done) done = write(request.gltf, [&](const fs::path& path) { return writeFile(path, made.gltf); });
    if (done) done = write(request.volume, [&](const fs::path& path) { return writeFile(path, made.volume); });
    return done;
}

Result<Done> checkName(const fs::path& path, const char* extension)
{
    std::string found = path.extension().string();
    std::ranges::transform(found, found.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
    if (path.empty() || found == extension) return Done{};
    return Error{Error::Kind::badInput, fmt::format("{} should end in {}", path.string(), extension)};
}

} // namespace

fs::path lightmapFile(const ExportRequest& request)
{
    if (!request.lightmap.empty() || request.gltf.empty()) return request.lightmap;
    return fs::path(request.gltf).replace_extension(".exr");
}

Result<Done> checkExport(const ExportRequest& request, Method method)
{
    for (const Result<Done>& named :
         {checkName(request.lightmap, ".exr"), checkName(request.gltf, ".glb"), checkName(request.volume, ".vdb")}) {
        if (!named) return named.error();
    }
    if (request.lightmap.empty() && request.gltf.empty() && request.volume.empty()) {
        return Error{Error::Kind::badInput, "say what to export: a lightmap, a glTF scene or a volume"};
    }
    if (!request.volume.empty() && method == Method::photonMap) {
        return Error{Error::Kind::badInput,
                     fmt::format("a volume holds the leaves of a light-octree, the vertices of an irradiance-grid or "
                                 "the voxels of voxel-lightcuts; {} has none of them",
                                 methodName(method))};
    }
    return Done{};
}

EncodedLightmap encodeLightmap(const FloatImage& lux)
{
    EncodedLightmap out;
    out.image.name = "lightmap";
    out.image.width = lux.width;
    out.image.height = lux.height;
    float most = 0.0f;
    for (const glm::vec3 e : lux.pixels) most = std::max(most, std::max(e.x, std::max(e.y, e.z)));
    out.intensity = most > 0.0f ? most : 1.0f;
    out.image.rgba.reserve(4 * lux.pixels.size());
    for (const glm::vec3 e : lux.pixels) {
        for (const float v : {e.x, e.y, e.z}) {
            const float part = std::clamp(v / out.intensity, 0.0f, 1.0f);
            out.image.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0f * part)));
        }
        out.image.rgba.push_back(255);
    }
    return out;
}

Result<ExportReport> exportBake(const ExportSource& source, const ExportRequest& request, Workers& workers,
                                const std::stop_token& stop, const std::function<void(double)>& progress)
try {
    if (const Result<Done> fine = checkExport(request, source.info.method); !fine) return fine.error();
    Made made;
    if (const Result<Done> done = makeLightmap(source, request, workers, stop, progress, made); !done)
        return done.error();
    if (stop.stop_requested()) return stopped();
    if (const Result<Done> done = makeGltf(source, request, made); !done) return done.error();
    if (stop.stop_requested()) return stopped();
    if (const Result<Done> done = makeVolume(source, request, made); !done) return done.error();
    if (stop.stop_requested()) return stopped();
    if (const Result<Done> written = writeAll(source, request, made); !written) return written.error();
    if (progress) progress(1.0);
    return std::move(made.report);
} catch (const std::bad_alloc&) {
    return Error{Error::Kind::outOfMemory, "not enough memory for the export; ask for a smaller atlas"};
} catch (const std::exception& failure) {
    return Error{Error::Kind::io, fmt::format("the export failed: {}", failure.what())};
}

} // namespace lightloom
