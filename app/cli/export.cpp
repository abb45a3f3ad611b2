// SPDX-License-Identifier: Apache-2.0
#include "app/cli/methods.h"
#include "app/cli/progress.h"
#include "core/bake/export_bake.h"
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {
namespace {

constexpr double kReadShare = 0.1;

ExportRequest requestOf(const ExportCommand& command)
{
    ExportRequest request;
    request.lightmap = command.lightmap;
    request.gltf = command.gltf;
    request.volume = command.volume;
    request.atlas.size = command.size;
    request.atlas.texelsPerMetre = command.texelsPerMetre.value_or(0.0);
    request.atlas.useSceneUv = command.sceneUv;
    request.withDirect = command.withDirect;
    return request;
}

Result<Done> checkUsage(const ExportCommand& command, const ExportRequest& request)
{
    const auto bad = [](std::string text) { return Error{Error::Kind::badInput, std::move(text)}; };
    if (command.texelsPerMetre && !(*command.texelsPerMetre > 0.0)) {
        return bad(fmt::format("--texels-per-metre {}: give a number above 0", *command.texelsPerMetre));
    }
    if (command.texelsPerMetre && command.sceneUv) {
        return bad("--texels-per-metre cannot change the scene's own UV set; use --atlas-size");
    }
    // what the bake is shows only later: here any octree's
    if (const Result<Done> fine = checkExport(request, Method::lightOctree); !fine) return fine.error();
    return checkAtlasOptions(request.atlas);
}

/// Whether both name one file, there already or not.
bool isSame(const std::filesystem::path& a, const std::filesystem::path& b)
{
    std::error_code unknown;
    return std::filesystem::equivalent(a, b, unknown) || std::filesystem::absolute(a, unknown).lexically_normal() ==
                                                             std::filesystem::absolute(b, unknown).lexically_normal();
}

Result<Done> checkPlaces(const ExportCommand& command, const ExportRequest& request)
{
    std::vector<std::filesystem::path> taken{command.bakeFile, command.scene};
    for (const auto& path : {lightmapFile(request), request.gltf, request.volume}) {
        if (path.empty()) continue;
        for (const auto& other : taken) {
            if (!isSame(path, other)) continue;
            return Error{Error::Kind::badInput, path.string() + ": is read or written already; name another file"};
        }
        taken.push_back(path);
        if (const Result<Done> fine = checkOutput(path.string()); !fine) return fine.error();
    }
    return Done{};
}

nlohmann::json asJson(const ExportReport& report, double seconds, int threads)
{
    nlohmann::json files = nlohmann::json::array();
    for (const auto& file : report.files) files.push_back(file.string());
    nlohmann::json json{{"files", files}, {"seconds", seconds}, {"threads", threads}};
    if (!report.atlas) return json;
    const AtlasReport& atlas = report.atlas->report;
    json["atlas"] = {{"size", report.atlas->size},
                     {"charts", atlas.charts},
                     {"faces", atlas.faces},
                     {"unlit_faces", atlas.unlitFaces},
                     {"shared_faces", atlas.sharedFaces},
                     {"texels_per_metre", atlas.texelsPerMetre},
                     {"utilisation", atlas.utilisation},
                     {"overlapping_texels", atlas.overlappingTexels},
                     {"stretch_mean", atlas.stretch.meanAnisotropy()},
                     {"stretch_worst", atlas.stretch.worstAnisotropy},
                     {"scale_least", atlas.stretch.leastScale},
                     {"scale_most", atlas.stretch.mostScale},
                     {"charts_ms", atlas.chartMs},
                     {"packing_ms", atlas.packMs},
                     {"texels_ms", atlas.texelMs}};
    json["brightest_lux"] = report.brightest;
    json["light_ms"] = report.lightMs;
    return json;
}

void print(const ExportReport& report)
{
    if (report.atlas) {
        const AtlasReport& atlas = report.atlas->report;
        fmt::print(
            "atlas: {0} x {0} texels, {1:.4g} per metre, {2} charts of {3} faces, {4:.1f} % used, {5} overlapping\n"
            "  stretch: {6:.3f} mean, {7:.2f} worst; scale {8:.2f} to {9:.2f}\n",
            report.atlas->size, atlas.texelsPerMetre, atlas.charts, atlas.faces, 100.0 * atlas.utilisation,
            atlas.overlappingTexels, atlas.stretch.meanAnisotropy(), atlas.stretch.worstAnisotropy,
            atlas.stretch.leastScale, atlas.stretch.mostScale);
        if (atlas.sharedFaces > 0) {
            fmt::print("  {} lit backs show their fronts: the scene's UV set has one place for both\n",
                       atlas.sharedFaces);
        }
        fmt::print("brightest: {:.4g} lx\n", report.brightest);
    }
    for (const auto& file : report.files) fmt::print("{}\n", file.string());
}

/// Bytes for the texels, twice in pictures, once more in files.
double atlasBytes(const AtlasOptions& options)
{
    const double side = options.texelsPerMetre > 0.0 ? kMostAtlas : options.size;
    return 90.0 * side * side;
}

} // namespace

int exportBake(const Context& context, const ExportCommand& command)
{
    const ExportRequest request = requestOf(command);
    if (const Result<Done> fine = checkUsage(command, request); !fine) return failUsage(fine.error());
    if (const Result<Done> fine = checkPlaces(command, request); !fine) {
        return fine.error().kind == Error::Kind::badInput ? failUsage(fine.error()) : failWriting(fine.error());
    }
    const Result<Done> fits =
        checkFits(atlasBytes(request.atlas), fmt::format("an atlas of up to {0} x {0} texels", request.atlas.size),
                  "make it smaller");
    if (!fits) return fail(fits.error());

    const auto began = std::chrono::steady_clock::now();
    const Result<Lighting> lighting =
        prepareLighting(context, {command.scene, {}, command.bakeFile, command.options}, kReadShare);
    if (!lighting) return fail(lighting.error());
    BakeInfo info = bakeInfo(*lighting);
    info.params.octreeValues = OctreeValues::exact; // packed numbers are for pixels
    const bool isPacked = lighting->params.octreeValues == OctreeValues::packed;
    if (const Result<Done> fine = checkExport(request, info.method); !fine) return fail(fine.error());
    const LitScene& lit = lighting->lit;
    const Result<ExportReport> report = lightloom::exportBake(
        {*lit.rays, *lit.lights, lit.reach.get(), isPacked ? *lighting->field : *lighting->shown, info}, request,
        *context.workers, context.stop,
        [&](double f) { context.report->progress("export", kReadShare + (1.0 - kReadShare) * f); });
    if (!report) return report.error().kind == Error::Kind::io ? failWriting(report.error()) : fail(report.error());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
    if (context.json) {
        fmt::print("{}\n", asJson(*report, seconds.count(), context.workers->threadCount())
                               .dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    } else if (!context.quiet) {
        print(*report);
    }
    return kDone;
}

} // namespace lightloom::cli
