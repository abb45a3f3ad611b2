// SPDX-License-Identifier: Apache-2.0
#include "app/cli/progress.h"
#include "app/cli/view.h"
#include "core/base/image_file.h"
#include "core/params/param_text.h"
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {
namespace {

constexpr double kBakeShare = 0.5;

/// Everything the picture depends on, for the file's header: no time and no place, equal pictures are equal files.
ImageNotes notesOf(const Lighting& lighting, const ViewJob& job, float ev, bool isWhole, int samples)
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
    if (!isWhole) {
        notes.emplace_back("lightloom.incomplete", fmt::format("{} of {} samples per pixel", samples, job.samples));
    }
    return notes;
}

Result<Done> writePicture(const std::string& output, bool isExr, View view, float ev, const ImageNotes& notes)
{
    FloatImage whole = wholeView(view);
    if (!isExr) return writePng(output, onScreen(whole, ev), notes);
    LayeredImage image;
    image.layers.push_back({"", std::move(whole)});
    image.layers.push_back({"direct", std::move(view.direct)});
    image.layers.push_back({"indirect", std::move(view.indirect)});
    image.notes = notes;
    return writeExr(output, image);
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
    LightingRequest request{command.scene, command.method, command.bakeFile, command.options};
    if (command.samplesPerPixel) {
        request.options.set.push_back(fmt::format("render.samples={}", *command.samplesPerPixel));
    }
    if (const Result<Done> fine = checkRequest(request); !fine) return failUsage(fine.error());
    const Result<bool> isExr = isExrName(command.output);
    if (!isExr) return failUsage(isExr.error());
    if (const Result<Done> fine = checkOutput(command.output); !fine) return failWriting(fine.error());
    const double pixels =
        static_cast<double>(command.width) * command.height; // sums, layers and the file: 140 bytes each
    const Result<Done> fits = checkFits(
        140.0 * pixels, fmt::format("a picture of {} x {}", command.width, command.height), "make it smaller");
    if (!fits) return fail(fits.error());

    const auto began = std::chrono::steady_clock::now();
    const Result<Lighting> lighting = prepareLighting(context, request, kBakeShare);
    if (!lighting) return fail(lighting.error());
    const Scene& scene = *lighting->lit.scene;
    const float aspect = static_cast<float>(command.width) / static_cast<float>(command.height);
    const Result<Camera> camera = cameraNamed(context, scene, command.camera, aspect);
    if (!camera) return fail(camera.error());

    const ViewJob job = viewJob(*lighting, *camera, command.width, command.height);
    const double from = lighting->bakeSeconds > 0 ? kBakeShare : 0.0;
    View view =
        renderView(*lighting->lit.rays, *lighting->lit.lights, {}, lighting->field.get(), job, *context.workers,
                   context.stop, [&](double f) { context.report->progress("render", from + (1.0 - from) * f); });
    const bool isWhole = view.samples == job.samples;
    if (!isWhole && view.samples == 0) {
        return fail({Error::Kind::cancelled, "interrupted before every pixel had a sample; nothing was written"});
    }
    const int samples = view.samples;
    const float ev = command.ev ? *command.ev : scene.exposureEv ? *scene.exposureEv : suitingEv(wholeView(view));
    const Result<Done> written =
        writePicture(command.output, *isExr, std::move(view), ev, notesOf(*lighting, job, ev, isWhole, samples));
    if (!written) return failWriting(written.error());
    if (!isWhole) {
        return fail({Error::Kind::cancelled, fmt::format("interrupted; {} has {} of {} samples per pixel and is marked "
                                                         "as incomplete",
                                                         command.output, samples, job.samples)});
    }
    if (context.json) {
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
        const nlohmann::json json{{"method", methodName(lighting->method)},
                                  {"camera", job.camera.name},
                                  {"width", job.width},
                                  {"height", job.height},
                                  {"samples", samples},
                                  {"exposure_ev", ev},
                                  {"seconds", seconds.count()},
                                  {"bake_seconds", lighting->bakeSeconds},
                                  {"threads", context.workers->threadCount()},
                                  {"output", command.output}};
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    }
    return kDone;
}

} // namespace lightloom::cli
