// SPDX-License-Identifier: Apache-2.0
#include "app/cli/progress.h"
#include "app/cli/view.h"
#include "core/bake/solver_for.h"
#include "core/bake/view_caustics.h"
#include "core/base/image_file.h"
#include "core/compare/cut_map.h"
#include "core/compare/legend.h"
#include "core/compare/noise_map.h"
#include "core/compare/reference_store.h"
#include "core/compare/view_error.h"
#include "core/params/param_text.h"
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {
namespace {

constexpr double kBakeShare = 0.5;

/// What a picture that was interrupted has; "" for a whole one.
std::string howFar(const View& view, const ViewJob& job)
{
    if (view.isWhole) return {};
    if (view.causticRounds > 0) {
        return fmt::format("{} of {} rounds of photons by way of mirrors", view.causticRounds, causticRounds(job));
    }
    if (job.targetError == 0.0f) return fmt::format("{} of {} samples per pixel", view.samples, job.samples);
    const auto isDone = [](glm::vec3 error) { return error != glm::vec3(0.0f); };
    return fmt::format("{} of {} pixels are done", std::ranges::count_if(view.standardError.pixels, isDone),
                       view.standardError.pixels.size());
}

/// Everything the picture depends on, for the file's header: no time and no place, equal pictures are equal files.
ImageNotes notesOf(const Lighting& lighting, const ViewJob& job, float ev, const View& view)
{
    ImageNotes notes{{"lightloom.version", LIGHTLOOM_VERSION},
                     {"lightloom.method", std::string(methodName(lighting.method))},
                     {"lightloom.scene", toHex(sceneHash(*lighting.lit.scene))},
                     {"lightloom.camera", job.camera.name},
                     {"lightloom.isa", std::string(lighting.lit.rays->isaName())},
                     {"lightloom.exposure", fmt::format("{}", ev)},
                     {"lightloom.unit", "cd/m2"}};
    for (const ParamSpec& spec : kParams) {
        const bool counts = (spec.methods & (1u << static_cast<unsigned>(lighting.method))) != 0;
        if (counts) notes.emplace_back(fmt::format("lightloom.{}", spec.key), paramText(lighting.params, spec));
    }
    if (job.finalGather) notes.emplace_back("lightloom.final_gather", fmt::format("{} rays", job.gatherRays));
    if (view.causticRounds > 0) {
        notes.emplace_back("lightloom.caustics", fmt::format("small lamps in mirrors by {} photons",
                                                             view.causticRounds * CausticJob{}.photons));
    }
    if (const std::string part = howFar(view, job); !part.empty()) notes.emplace_back("lightloom.incomplete", part);
    return notes;
}

/// The reference from disk where it is kept, any other method rendered now.
View renderNow(const Context& context, const RenderCommand& command, const Lighting& lighting, const ViewJob& job)
{
    const double from = lighting.bakeSeconds > 0 ? kBakeShare : 0.0;
    const auto progress = [&](double f) { context.report->progress("render", from + (1.0 - from) * f); };
    const LitScene& lit = lighting.lit;
    if (lighting.method != Method::reference) {
        return renderView(*lit.rays, *lit.lights, {}, lighting.shown.get(), job, *context.workers, context.stop,
                          progress);
    }
    const ReferenceStore store = storeOf(context, command.scene, command.cache);
    KeptView kept = store.picture(*lit.rays, *lit.lights, {}, job, ReferenceMatch::sameBits, *context.workers,
                                  context.stop, progress);
    const View& view = kept.result;
    if (kept.wasStored) log(context.log, LogLevel::info, fmt::format("from {}", kept.file.string()));
    if (kept.resumed > 0) {
        log(context.log, LogLevel::info,
            fmt::format("{} of {} camera rays were traced before", kept.resumed, view.rays));
    }
    if (view.capped > 0) {
        log(context.log, LogLevel::warning,
            fmt::format("{} of {} pixels used all {} samples before they met the target; raise --spp", view.capped,
                        view.direct.pixels.size(), job.samples));
    }
    return std::move(kept.result);
}

Result<Done> writePicture(const std::string& output, bool isExr, View view, bool withErrors, float ev,
                          const ImageNotes& notes)
{
    FloatImage whole = wholeView(view);
    if (!isExr) return writePng(output, onScreen(whole, ev), notes);
    LayeredImage image;
    image.layers.push_back({"", std::move(whole)});
    image.layers.push_back({"direct", std::move(view.direct)});
    image.layers.push_back({"indirect", std::move(view.indirect)});
    if (withErrors) image.layers.push_back({"stderr", std::move(view.standardError)});
    image.notes = notes;
    return writeExr(output, image);
}

/// Before the picture, which takes longer.
Result<Done> writeNoiseMap(const Context& context, const RenderCommand& command, const Lighting& lighting,
                           const Camera& camera)
{
    const ScalarImage map = noiseMap(*lighting.lit.rays, *lighting.field, camera, command.width, command.height,
                                     *context.workers, context.stop);
    if (map.values.empty()) return Error{Error::Kind::cancelled, "interrupted; nothing was written"};
    const HeatmapStyle style{ErrorKind::relative, legendTop(map), LegendUnit::percent, "stated noise / mean light"};
    return writePng(command.noiseMap, heatmap(map, style), {{"Title", style.caption}});
}

Result<Done> writeCutMap(const RenderCommand& command, const CutMap& cuts)
{
    const HeatmapStyle style{ErrorKind::absolute, cuts.top(), LegendUnit::plain,
                             fmt::format("cut size, mean {:.0f}, p99 {}, max {}", cuts.mean, cuts.p99, cuts.most)};
    return writePng(command.cutMap, heatmap(cuts.sizes, style), {{"Title", style.caption}});
}

/// There must be a field for the gather rays to end in.
Result<Done> checkFinalGather(const RenderCommand& command)
{
    if (!command.finalGather || !command.bakeFile.empty() || solverFor(*methodNamed(command.method))) return Done{};
    return Error{Error::Kind::badInput,
                 fmt::format("--final-gather looks into a bake, and {} bakes nothing", command.method)};
}

/// A reference and direct light are baked into no field that could tell its noise.
Result<Done> checkNoiseMap(const RenderCommand& command)
{
    if (command.noiseMap.empty() || !command.bakeFile.empty() || solverFor(*methodNamed(command.method))) return Done{};
    return Error{Error::Kind::badInput,
                 fmt::format("--noise-map shows the noise of a bake, and {} bakes nothing", command.method)};
}

/// Only lightcuts have sizes; told before a bake where no file has to be read for it.
Result<Done> checkCutMap(const RenderCommand& command, const LightingRequest& request)
{
    if (command.cutMap.empty()) return Done{};
    if (command.finalGather) {
        return Error{Error::Kind::badInput, "--cut-map shows lightcuts, and --final-gather makes none"};
    }
    if (!command.bakeFile.empty()) return Done{};
    const Result<Method> method = methodNamed(command.method);
    if (*method != Method::voxelLightcuts) {
        return Error{
            Error::Kind::badInput,
            fmt::format("--cut-map shows the lightcuts of voxel-lightcuts, and {} makes none", command.method)};
    }
    const Result<BakeParams> params = bakeParams(request.options, *method);
    if (params->voxelLookup == VoxelLookup::lightcuts) return Done{};
    return Error{Error::Kind::badInput, "--cut-map shows lightcuts; leave voxel.lookup at lightcuts"};
}

Result<Done> checkOutputs(const RenderCommand& command)
{
    for (const std::string* output : {&command.output, &command.noiseMap, &command.cutMap}) {
        if (output != &command.output && output->empty()) continue;
        if (const Result<Done> fine = checkOutput(*output); !fine) return fine;
    }
    return Done{};
}

bool isByCuts(const Lighting& lighting)
{
    return lighting.method == Method::voxelLightcuts && lighting.params.voxelLookup == VoxelLookup::lightcuts;
}

Result<bool> isExrName(const std::string& output)
{
    const std::string extension = std::filesystem::path(output).extension().string();
    if (extension == ".exr" || extension == ".EXR") return true;
    if (extension == ".png" || extension == ".PNG") return false;
    return Error{Error::Kind::badInput, fmt::format("{}: pictures are written as .exr or .png", output)};
}

} // namespace

int render(const Context& context, const RenderCommand& command)
{
    LightingRequest request{command.scene, command.method, command.bakeFile, command.options, command.cache};
    if (command.samplesPerPixel) {
        request.options.set.push_back(fmt::format("render.samples={}", *command.samplesPerPixel));
    }
    if (const Result<Done> fine = checkRequest(request); !fine) return failUsage(fine.error());
    if (const Result<Done> fine = checkNoiseMap(command); !fine) return failUsage(fine.error());
    if (const Result<Done> fine = checkFinalGather(command); !fine) return failUsage(fine.error());
    if (const Result<Done> fine = checkCutMap(command, request); !fine) return failUsage(fine.error());
    const Result<bool> isExr = isExrName(command.output);
    if (!isExr) return failUsage(isExr.error());
    if (const Result<Done> fine = checkOutputs(command); !fine) return failWriting(fine.error());
    const double pixels =
        static_cast<double>(command.width) * command.height; // sums, layers, discs and the files: 700 bytes each
    const Result<Done> fits = checkFits(
        700.0 * pixels, fmt::format("a picture of {} x {}", command.width, command.height), "make it smaller");
    if (!fits) return fail(fits.error());

    const auto began = std::chrono::steady_clock::now();
    const Result<Lighting> lighting = prepareLighting(context, request, kBakeShare);
    if (!lighting) return fail(lighting.error());
    const Scene& scene = *lighting->lit.scene;
    const float aspect = static_cast<float>(command.width) / static_cast<float>(command.height);
    const Result<Camera> camera = cameraNamed(context, scene, command.camera, aspect);
    if (!camera) return fail(camera.error());

    if (!command.cutMap.empty() && !isByCuts(*lighting)) {
        return fail({Error::Kind::badInput,
                     fmt::format("{} is not looked up by lightcuts: --cut-map has nothing to show", command.bakeFile)});
    }
    if (!command.noiseMap.empty()) {
        const Result<Done> written = writeNoiseMap(context, command, *lighting, *camera);
        if (!written && written.error().kind == Error::Kind::cancelled) return fail(written.error());
        if (!written) return failWriting(written.error());
    }
    ViewJob job = viewJob(*lighting, *camera, command.width, command.height);
    job.finalGather = command.finalGather;
    View view = renderNow(context, command, *lighting, job);
    const std::string part = howFar(view, job);
    if (view.rays == 0 || (!view.isWhole && view.samples == 0 && job.targetError == 0.0f)) {
        return fail({Error::Kind::cancelled, "interrupted before every pixel had a sample; nothing was written"});
    }
    const float ev = command.ev ? *command.ev : scene.exposureEv ? *scene.exposureEv : suitingEv(wholeView(view));
    const double rays = static_cast<double>(view.rays), error = pictureNoise(view);
    const ImageNotes notes = notesOf(*lighting, job, ev, view);
    const CutMap cuts = cutMap(view);
    if (cuts.pixels > 0) {
        log(context.log, LogLevel::info,
            fmt::format("cuts of {:.0f} clusters on average, in 99 % of the pixels at most {}, {} at most", cuts.mean,
                        cuts.p99, cuts.most));
    }
    if (view.glossByRays > 0) {
        log(context.log, LogLevel::info,
            fmt::format(
                "{} pixels show metal smoother than roughness .5: its lobe is too narrow for the lights of a cut, "
                "one ray a sample looks instead",
                view.glossByRays));
    }
    const std::uint64_t gloss[2] = {view.glossByCut, view.glossByRays};
    if (!command.cutMap.empty()) {
        if (const Result<Done> written = writeCutMap(command, cuts); !written) return failWriting(written.error());
    }
    const Result<Done> written =
        writePicture(command.output, *isExr, std::move(view), lighting->method == Method::reference, ev, notes);
    if (!written) return failWriting(written.error());
    if (!part.empty()) {
        const bool canResume = lighting->method == Method::reference && command.cache.isUsed;
        return fail({Error::Kind::cancelled, fmt::format("interrupted: {}{}; {} holds this, marked as incomplete", part,
                                                         canResume ? " (--resume goes on)" : "", command.output)});
    }
    if (context.json) {
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
        nlohmann::json json{{"method", methodName(lighting->method)},
                            {"camera", job.camera.name},
                            {"width", job.width},
                            {"height", job.height},
                            {"samples", rays / (static_cast<double>(job.width) * job.height)},
                            {"relative_standard_error", error},
                            {"exposure_ev", ev},
                            {"seconds", seconds.count()},
                            {"bake_seconds", lighting->bakeSeconds},
                            {"threads", context.workers->threadCount()},
                            {"output", command.output}};
        if (cuts.pixels > 0) {
            json["cut_sizes"] = {{"mean", cuts.mean}, {"p99", cuts.p99}, {"max", cuts.most}};
            json["glossy_pixels"] = {{"by_cut", gloss[0]}, {"by_rays", gloss[1]}};
        }
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    }
    return kDone;
}

} // namespace lightloom::cli
