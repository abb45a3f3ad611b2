// SPDX-License-Identifier: Apache-2.0
#include "app/cli/compare_inputs.h"
#include "app/cli/progress.h"
#include "app/cli/view.h"
#include "core/base/image_file.h"
#include "core/compare/field_probe.h"
#include "core/compare/probes.h"
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace lightloom::cli {
namespace {

const std::string* noteOf(const LayeredImage& image, std::string_view name)
{
    const auto found = std::ranges::find(image.notes, name, &ImageNotes::value_type::first);
    return found == image.notes.end() ? nullptr : &found->second;
}

Pair pairOf(std::vector<glm::vec3> values, const ProbeTable& reference)
{
    return {luminances(values),
            luminances(reference.indirect),
            {},
            {},
            fmt::format("indirect light, {} points", reference.indirect.size()),
            LegendUnit::lux,
            reference.standardError};
}

Result<Pair> readTables(const CompareCommand& command)
{
    Result<ProbeTable> a = readResult(command.a), b = readResult(command.b);
    if (!a) return a.error();
    if (!b) return b.error();
    if (a->indirect.size() != b->indirect.size()) {
        return Error{Error::Kind::badInput, fmt::format("{} has {} points, {} has {}", command.a, a->indirect.size(),
                                                        command.b, b->indirect.size())};
    }
    if (!a->points.empty() && !b->points.empty()) {
        for (std::size_t i = 0; i < a->points.size(); ++i) {
            if (a->points[i] == b->points[i]) continue;
            return Error{Error::Kind::badInput,
                         fmt::format("line {}: {} and {} hold different points", i + 2, command.a, command.b)};
        }
    }
    return pairOf(std::move(a->indirect), *b);
}

Result<LayeredImage> readPicture(const std::string& path, FileKind kind)
{
    if (kind == FileKind::exr) return readExr(path);
    const Result<ByteImage> png = readPng(path);
    if (!png) return png.error();
    return LayeredImage{{{"", toLinear(*png)}}, {}};
}

Result<Pair> pairOf(const CompareCommand& command, const LayeredImage& filesA, const LayeredImage& filesB, bool asSeen)
{
    const bool byIndirect = !asSeen && filesA.find("indirect") && filesB.find("indirect");
    const auto chosen = [&](const LayeredImage& file) -> const FloatImage& {
        const FloatImage* layer = file.find(byIndirect ? "indirect" : "");
        return layer ? *layer : file.layers.front().image;
    };
    const FloatImage &a = chosen(filesA), &b = chosen(filesB);
    if (!a.isSameSize(b)) {
        return Error{Error::Kind::badInput, fmt::format("{} is {} x {} pixels, {} is {} x {}", command.a, a.width,
                                                        a.height, command.b, b.width, b.height)};
    }
    const std::string* unit = noteOf(filesB, "lightloom.unit");
    const FloatImage* errors = filesB.find("stderr");
    return Pair{luminances(a.pixels),
                luminances(b.pixels),
                a,
                b,
                fmt::format("{}, {} x {} pixels", byIndirect ? "indirect light" : "picture", a.width, a.height),
                unit && *unit == "cd/m2" ? LegendUnit::candelaPerM2 : LegendUnit::plain,
                errors ? errors->pixels : std::vector<glm::vec3>{}};
}

Result<Lighting> readBaked(const Context& context, const CompareCommand& command)
{
    return prepareLighting(context, {command.scene, "", command.a, command.options}, 0.0);
}

/// The bake at the reference's points.
Result<Pair> probeBake(const Context& context, const CompareCommand& command)
{
    const Result<ProbeTable> reference = readResult(command.b);
    if (!reference) return reference.error();
    if (reference->points.size() != reference->indirect.size()) {
        return Error{Error::Kind::badInput,
                     fmt::format("{} does not tell where its points are (x,y,z,nx,ny,nz)", command.b)};
    }
    const Result<Lighting> lighting = readBaked(context, command);
    if (!lighting) return lighting.error();
    const LitScene& lit = lighting->lit;
    std::vector<ProbePoint> points;
    for (const ProbeRow& row : reference->points) points.push_back(inScene(*lit.scene, row));
    const FieldProbe probe(*lit.rays, *lit.lights, lighting->shown.get(), lighting->params);
    auto values = probe.indirect(points, *context.workers, context.stop,
                                 [&](double fraction) { context.report->progress("probe", fraction); });
    if (!values) return Error{Error::Kind::cancelled, "interrupted before every point was compared"};
    return pairOf(std::move(*values), *reference);
}

/// The bake as the reference's camera sees it. The header of our own pictures names scene and camera.
Result<Pair> renderBake(const Context& context, const CompareCommand& command, bool asSeen)
{
    const Result<LayeredImage> reference = readExr(command.b);
    if (!reference) return reference.error();
    const Result<Lighting> lighting = readBaked(context, command);
    if (!lighting) return lighting.error();
    const LitScene& lit = lighting->lit;
    const std::string* hash = noteOf(*reference, "lightloom.scene");
    if (hash && *hash != toHex(sceneHash(*lit.scene))) {
        return Error{Error::Kind::badInput, fmt::format("{} shows another scene than {}", command.b, command.scene)};
    }
    const std::string* named = noteOf(*reference, "lightloom.camera");
    if (command.camera.empty() && !named) {
        return Error{Error::Kind::badInput,
                     fmt::format("{} does not tell its camera; name it with --camera", command.b)};
    }
    const FloatImage& size = reference->layers.front().image;
    const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
    const Result<Camera> camera =
        cameraNamed(context, *lit.scene, command.camera.empty() ? *named : command.camera, aspect);
    if (!camera) return camera.error();
    const ViewJob job = viewJob(*lighting, *camera, size.width, size.height);
    View view = renderView(*lit.rays, *lit.lights, {}, lighting->shown.get(), job, *context.workers, context.stop,
                           [&](double f) { context.report->progress("render", f); });
    if (!view.isWhole) return Error{Error::Kind::cancelled, "interrupted before the picture was done"};
    LayeredImage seen;
    seen.layers.push_back({"", wholeView(view)});
    seen.layers.push_back({"indirect", std::move(view.indirect)});
    return pairOf(command, seen, *reference, asSeen);
}

} // namespace

Result<FileKind> kindOf(const std::string& path)
{
    std::string extension = std::filesystem::path(path).extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    if (extension == ".csv") return FileKind::table;
    if (extension == ".exr") return FileKind::exr;
    if (extension == ".png") return FileKind::png;
    if (extension == ".vdb") return FileKind::bake;
    return Error{Error::Kind::unsupported, fmt::format("{}: compare reads .csv, .exr, .png and .vdb files", path)};
}

Result<Done> checkSides(const CompareCommand& command)
{
    const Result<FileKind> kindA = kindOf(command.a), kindB = kindOf(command.b);
    if (!kindA) return kindA.error();
    if (!kindB) return kindB.error();
    const auto refuse = [](std::string message) { return Error{Error::Kind::badInput, std::move(message)}; };
    if (*kindB == FileKind::bake) {
        return refuse(fmt::format("{} is a bake; a reference is a table (.csv) or a picture (.exr)", command.b));
    }
    const bool isTable = *kindB == FileKind::table, isBake = *kindA == FileKind::bake;
    if (isBake && *kindB == FileKind::png) {
        return refuse(fmt::format("{} is a .png; a bake is compared with a .csv or .exr, which hold light", command.b));
    }
    if (isBake && command.scene.empty()) return refuse(command.a + " is a bake: say of what, with --scene SCENE");
    if (!isBake && isTable != (*kindA == FileKind::table)) {
        return refuse(fmt::format("{} and {} are a table and a picture; compare two of a kind", command.a, command.b));
    }
    if (isTable && (command.metric == "flip" || !command.heatmap.empty())) {
        return refuse("FLIP and heatmaps need pictures (.exr or .png), not tables");
    }
    return Done{};
}

Result<Pair> readSides(const Context& context, const CompareCommand& command, bool asSeen)
{
    const FileKind kindA = *kindOf(command.a), kindB = *kindOf(command.b);
    if (kindA == FileKind::bake) {
        return kindB == FileKind::table ? probeBake(context, command) : renderBake(context, command, asSeen);
    }
    if (kindB == FileKind::table) return readTables(command);
    const Result<LayeredImage> a = readPicture(command.a, kindA), b = readPicture(command.b, kindB);
    if (!a) return a.error();
    if (!b) return b.error();
    return pairOf(command, *a, *b, asSeen);
}

} // namespace lightloom::cli
