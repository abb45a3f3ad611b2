// SPDX-License-Identifier: Apache-2.0
// Frame time of each mode against plain mode, all in one run and in turn, so that the machine's mood hits all.
// Run: xvfb-run -a -s "-screen 0 1280x1024x24" bench_gui_frame [SCENE NAME] [WIDTHxHEIGHT]
#include "core/scene/sample_scenes.h"
#include "tests/bench_clock.h"
#include "tests/gui_fixture.h"
#include "widgets/gl/gl_probe.h"
#include <QElapsedTimer>
#include <QGuiApplication>
#include <fmt/format.h>

using namespace lightloom;

namespace {

constexpr int kRounds = 31;

} // namespace

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QGuiApplication application(argc, argv);
    const std::string name = argc > 1 ? argv[1] : "cornell";
    glm::ivec2 size(800, 600);
    if (argc > 2) std::sscanf(argv[2], "%dx%d", &size.x, &size.y);
    Result<Scene> made = sampleScene(name);
    if (!made) return fmt::print(stderr, "{}\n", made.error().message), 2;
    const auto scene = std::make_shared<const Scene>(std::move(*made));
    BakeParams params;
    params.photonCount = 100'000;
    const auto octree = bakeOctree(scene, params);
    GlFixture gl;
    if (!octree || !gl.start(size)) return fmt::print(stderr, "no bake or no OpenGL 3.3\n"), 1;
    const auto gpu = makeGpuOctree(*octree), colours = makeGpuOctree(*octree->showing(OctreeShow::colour));
    auto renderer = Renderer::make(*gl.gl);
    if (!gpu || !colours || !renderer) return 1;
    Renderer& draw = **renderer;
    if (!draw.setScene(makeDrawData(scene)) || !draw.setOctree(std::make_shared<GpuOctree>(*gpu)) ||
        !draw.setColours(std::make_shared<GpuOctree>(*colours))) {
        return 1;
    }
    Workers workers;
    const auto rays = RayScene::build(scene);
    if (!rays) return 1;
    const auto reach = LightReach::find(**rays, LightSampler(*rays), workers, {});
    const auto atlas = makeAtlas(**rays, *reach, {}, workers, {});
    if (!atlas || !draw.setAtlas(makeAtlasDraw(**rays, **atlas))) return 1;
    QElapsedTimer atlasClock;
    atlasClock.start();
    while (!draw.renderAtlas(1000.0)) {
    }
    const double atlasMs = static_cast<double>(atlasClock.nsecsElapsed()) * 1e-6;
    while (!draw.drawShadows(1000.0)) {
    }
    QElapsedTimer mirrors;
    mirrors.start();
    while (!draw.drawEnvironments(1000.0)) {
    }
    const double mirrorsMs = static_cast<double>(mirrors.nsecsElapsed()) * 1e-6;
    draw.overlay().setPhotons(FloatImage(size.x, size.y));

    const struct {
        const char* label;
        ViewMode mode;
        bool indirectOnly;
        bool showsPhotons = false;
    } modes[] = {{"plain", ViewMode::plain, false},
                 {"direct", ViewMode::direct, false},
                 {"octree, indirect only", ViewMode::octree, true},
                 {"octree", ViewMode::octree, false},
                 {"atlas, indirect only", ViewMode::atlas, true},
                 {"atlas", ViewMode::atlas, false},
                 {"colours, indirect only", ViewMode::colours, true},
                 {"colours", ViewMode::colours, false},
                 {"photon map's picture", ViewMode::plain, false, true}};
    std::vector<double> times[std::size(modes)];
    FrameView frame = viewOf(*scene, 0, size);
    for (int round = 0; round < kRounds; ++round) {
        for (std::size_t i = 0; i < std::size(modes); ++i) {
            frame.mode = modes[i].mode;
            frame.indirectOnly = modes[i].indirectOnly;
            frame.showsPhotons = modes[i].showsPhotons;
            QElapsedTimer clock;
            clock.start();
            if (!draw.draw(frame, 0, size, gl.target(), size)) return 1;
            draw.finish();
            times[i].push_back(static_cast<double>(clock.nsecsElapsed()) * 1e-6);
        }
    }
    const double plain = median(times[0]);
    fmt::print("{} {}x{} depth {} leaves {} k {} ({})\n", name, size.x, size.y, gpu->depth, gpu->leafCount,
               gpu->vdlCount, reinterpret_cast<const char*>(gl.gl->glGetString(GL_RENDERER)));
    for (std::size_t i = 0; i < std::size(modes); ++i) {
        fmt::print("{:24} {:8.1f} ms  {:5.2f} x plain\n", modes[i].label, median(times[i]), median(times[i]) / plain);
    }
    fmt::print("octree into an atlas of {0} x {0} texels, once per light: {1:.0f} ms\n", (*atlas)->size, atlasMs);
    if (draw.environmentCount() > 0) {
        fmt::print("{} environment maps, once per light: {:.1f} ms a face\n", draw.environmentCount(),
                   mirrorsMs / (6.0 * draw.environmentCount()));
    }
    return 0;
}
