// SPDX-License-Identifier: Apache-2.0
// What unwrapping costs and how good the atlas is, by scene.
//   bench_atlas [--size N] [--threads N] [--runs N] [--pictures FOLDER] [SCENE[:TRIANGLES] ...]
#include "core/atlas/atlas.h"
#include "core/base/image_file.h"
#include "core/base/rng.h"
#include "core/scene/sample_scenes.h"
#include "tests/bench_clock.h"
#include <charconv>
#include <chrono>
#include <cstring>
#include <fmt/format.h>

using namespace lightloom;

namespace {

/// Charts in colours of their own, padding darker.
ByteImage pictureOf(const Atlas& atlas)
{
    ByteImage picture{atlas.size, atlas.size, std::vector<std::uint8_t>(3 * atlas.texelCount(), 0)};
    const auto paint = [&](std::size_t i, int divisor) {
        const std::uint64_t hue = mixBits(static_cast<std::uint64_t>(atlas.owners[i]) + 1);
        for (std::size_t c = 0; c < 3; ++c) {
            picture.rgb[3 * i + c] = static_cast<std::uint8_t>((64 + (hue >> (8 * c)) % 192) / std::uint64_t(divisor));
        }
    };
    for (std::size_t i = 0; i < atlas.owners.size(); ++i) {
        if (atlas.owners[i] >= 0) paint(i, 3);
    }
    for (const SurfaceTexel& t : atlas.texels) paint(t.texel, 1);
    return picture;
}

bool measure(const std::string& what, const AtlasOptions& options, int runs, Workers& workers,
             const std::string& pictures)
{
    const std::size_t colon = what.find(':');
    std::optional<std::uint64_t> triangles;
    if (colon != std::string::npos) triangles = std::stoull(what.substr(colon + 1));
    Result<Scene> scene = sampleScene(what.substr(0, colon), triangles);
    if (!scene) return fmt::print(stderr, "{}\n", scene.error().message), false;
    const auto rays = RayScene::build(std::make_shared<const Scene>(*std::move(scene)));
    if (!rays) return fmt::print(stderr, "{}\n", rays.error().message), false;
    const LightSampler lights(*rays);
    const auto reach = LightReach::find(**rays, lights, workers, {});
    std::vector<double> charts, packs, texels, cpu;
    std::shared_ptr<const Atlas> atlas;
    for (int run = 0; run < runs; ++run) {
        const double before = cpuSeconds(CpuOf::process);
        const auto made = makeAtlas(**rays, *reach, options, workers, {});
        if (!made) return fmt::print(stderr, "{}: {}\n", what, made.error().message), false;
        cpu.push_back(1000.0 * (cpuSeconds(CpuOf::process) - before));
        atlas = *made;
        charts.push_back(atlas->report.chartMs), packs.push_back(atlas->report.packMs);
        texels.push_back(atlas->report.texelMs);
    }
    const AtlasReport& r = atlas->report;
    fmt::print("| {} | {} | {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.3f} | {:.2f} | {:.2f} .. {:.2f} | {:.1f} | "
               "{:.1f} % | {} |\n",
               what, r.faces, r.charts, median(charts), median(packs), median(texels), median(cpu),
               r.stretch.meanAnisotropy(), r.stretch.worstAnisotropy, r.stretch.leastScale, r.stretch.mostScale,
               r.texelsPerMetre, 100.0 * r.utilisation, r.overlappingTexels);
    if (pictures.empty()) return true;
    const Result<Done> written = writePng(pictures + "/" + what.substr(0, colon) + ".png", pictureOf(*atlas));
    if (!written) fmt::print(stderr, "{}\n", written.error().message);
    return bool(written);
}

} // namespace

int main(int argc, char** argv)
{
    AtlasOptions options;
    int threads = 0, runs = 5;
    std::string pictures;
    std::vector<std::string> scenes;
    for (int i = 1; i < argc; ++i) {
        const bool hasValue = i + 1 < argc;
        if (!std::strcmp(argv[i], "--size") && hasValue) {
            options.size = std::atoi(argv[++i]);
        } else if (!std::strcmp(argv[i], "--threads") && hasValue) {
            threads = std::atoi(argv[++i]);
        } else if (!std::strcmp(argv[i], "--runs") && hasValue) {
            runs = std::max(1, std::atoi(argv[++i]));
        } else if (!std::strcmp(argv[i], "--pictures") && hasValue) {
            pictures = argv[++i];
        } else {
            scenes.emplace_back(argv[i]);
        }
    }
    if (scenes.empty()) scenes = {"cornell", "two_rooms", "atrium", "gallery", "figure", "figure:70000"};
    Workers workers(threads);
    fmt::print(
        "| scene | faces | charts | charts ms | packing ms | texels ms | CPU ms | stretch, mean | worst | scale | "
        "texels/m | used | overlapping |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    bool fine = true;
    for (const std::string& scene : scenes) fine = measure(scene, options, runs, workers, pictures) && fine;
    return fine ? 0 : 1;
}
