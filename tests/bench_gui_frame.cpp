// SPDX-License-Identifier: Apache-2.0
// Frame time of each mode against plain mode, all in one run and in turn, so that the machine's mood hits all.
// Run: xvfb-run -a -s "-screen 0 1280x1024x24" bench_gui_frame [SCENE NAME] [WIDTHxHEIGHT] [ROUNDS]
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "tests/bench_clock.h"
#include "tests/gui_fixture.h"
#include "widgets/gl/gl_probe.h"
#include <QElapsedTimer>
#include <QGuiApplication>
#include <fmt/format.h>

using namespace lightloom;

namespace {

constexpr int kRounds = 31; ///< unless asked for others

/// A grid of the parameters' size in the forms and filters that the window shows.
struct GridForm {
    std::string label;
    std::shared_ptr<const GpuGrid> gpu;
};
std::vector<GridForm> gridForms(const std::shared_ptr<const Scene>& scene, const BakeParams& params)
{
    std::shared_ptr<const IrradianceGrid> grid = bakeGrid(scene, params);
    std::vector<GridForm> out;
    if (!grid) return out;
    const auto add = [&](GridRemap remap, GridFilter filter, GridPacking packing = GridPacking::exact) {
        Result<GpuGrid> gpu = makeGpuGrid(*grid->withShow({remap, filter, params.gridOffset}), packing);
        if (!gpu) return;
        const bool isCompressed = packing == GridPacking::compressed;
        out.push_back({fmt::format("grid {}{} {}{}", kGridRemapNames[static_cast<std::size_t>(remap)],
                                   isCompressed ? " compressed" : "",
                                   kGridFilterNames[static_cast<std::size_t>(filter)], gpu->inside ? ", nested" : ""),
                       std::make_shared<const GpuGrid>(std::move(*gpu))});
    };
    for (const GridFilter filter : {GridFilter::trilinear, GridFilter::bspline}) {
        for (const GridRemap remap : {GridRemap::joined, GridRemap::flux, GridRemap::harmonic, GridRemap::paper})
            add(remap, filter);
        add(GridRemap::paper, filter, GridPacking::compressed);
    }
    add(GridRemap::joined, GridFilter::catmullRom);
    BakeParams nested = params;
    nested.gridNest = GridNest::automatic;
    grid = bakeGrid(scene, nested);
    for (const GridFilter filter : {GridFilter::trilinear, GridFilter::bspline}) {
        if (grid && grid->inside().grid) add(GridRemap::joined, filter);
    }
    return out;
}

} // namespace

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QGuiApplication application(argc, argv);
    const std::string name = argc > 1 ? argv[1] : "cornell";
    glm::ivec2 size(800, 600);
    if (argc > 2) std::sscanf(argv[2], "%dx%d", &size.x, &size.y);
    const int rounds = argc > 3 ? std::max(1, std::atoi(argv[3])) : kRounds;
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
    if (!renderer) return fmt::print(stderr, "{}\n", renderer.error().message), 1;
    if (!gpu || !colours) return 1;
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
    draw.overlay().setMade(FloatImage(size.x, size.y));

    const std::vector<GridForm> grids = gridForms(scene, params);
    if (grids.empty()) return 1;
    SceneBuilder builder("guest");
    const float radius = 0.08f * scene->bounds.longestSide();
    builder.add("Ball", sphereMesh(glm::vec3(0.0f), radius, 48), builder.addMaterial("grey", glm::vec3(0.6f)));
    const auto guest = makeDrawData(std::make_shared<const Scene>(builder.finish()));

    struct Mode {
        std::string label;
        ViewMode mode;
        bool indirectOnly;
        bool showsMade = false;
        std::shared_ptr<const GpuGrid> grid = nullptr; ///< null: the octree
        bool hasGuest = false;                         ///< which moves from picture to picture
    };
    std::vector<Mode> modes = {{"plain", ViewMode::plain, false},
                               {"direct", ViewMode::direct, false},
                               {"octree, indirect only", ViewMode::octree, true},
                               {"octree", ViewMode::octree, false},
                               {"atlas, indirect only", ViewMode::atlas, true},
                               {"atlas", ViewMode::atlas, false},
                               {"colours, indirect only", ViewMode::colours, true},
                               {"colours", ViewMode::colours, false},
                               {"photon map's picture", ViewMode::plain, false, true}};
    for (const GridForm& form : grids) modes.push_back({form.label, ViewMode::grid, true, false, form.gpu});
    modes.push_back({"grid joined, all light", ViewMode::grid, false, false, grids[0].gpu});
    modes.push_back({"the same, a ball moves", ViewMode::grid, false, false, grids[0].gpu, true});
    std::vector<std::vector<double>> times(modes.size());
    std::shared_ptr<const GpuGrid> set;
    FrameView frame = viewOf(*scene, 0, size);
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < modes.size(); ++i) {
            frame.mode = modes[i].mode;
            frame.indirectOnly = modes[i].indirectOnly;
            frame.showsMade = modes[i].showsMade;
            if (modes[i].grid != set) {
                set = modes[i].grid;
                if (!(set ? draw.setGrid(set) : draw.setOctree(std::make_shared<GpuOctree>(*gpu)))) return 1;
                if (!draw.draw(frame, 0, size, gl.target(), size)) return 1; // textures are brought in, shaders made
            }
            draw.setGuest(modes[i].hasGuest ? guest : nullptr);
            const float way = 0.1f * static_cast<float>(round % 7 - 3);
            draw.setGuestPlace(glm::translate(glm::mat4(1.0f), scene->bounds.centre() + way * scene->bounds.size()));
            draw.finish();
            QElapsedTimer clock;
            clock.start();
            if (!draw.draw(frame, 0, size, gl.target(), size)) return 1;
            draw.finish();
            times[i].push_back(static_cast<double>(clock.nsecsElapsed()) * 1e-6);
        }
    }
    const double plain = median(times[0]);
    fmt::print("{} {}x{} {} rounds, depth {} leaves {} k {} ({})\n", name, size.x, size.y, rounds, gpu->depth,
               gpu->leafCount, gpu->vdlCount, reinterpret_cast<const char*>(gl.gl->glGetString(GL_RENDERER)));
    const glm::ivec3 cells = grids[0].gpu->lattice.cells;
    fmt::print("grid of {} x {} x {} cells, {:.1f} MB joined, {:.1f} MB as printed\n", cells.x, cells.y, cells.z,
               static_cast<double>(grids[0].gpu->memoryBytes()) / 1e6,
               static_cast<double>(grids[3].gpu->memoryBytes()) / 1e6);
    for (std::size_t i = 0; i < modes.size(); ++i) {
        fmt::print("{:36} {:8.1f} ms  {:5.2f} x plain\n", modes[i].label, median(times[i]), median(times[i]) / plain);
    }
    fmt::print("octree into an atlas of {0} x {0} texels, once per light: {1:.0f} ms\n", (*atlas)->size, atlasMs);
    if (draw.environmentCount() > 0) {
        fmt::print("{} environment maps, once per light: {:.1f} ms a face\n", draw.environmentCount(),
                   mirrorsMs / (6.0 * draw.environmentCount()));
    }
    return 0;
}
