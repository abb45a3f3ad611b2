// SPDX-License-Identifier: Apache-2.0
// What comparing in the window costs: time until the rough reference, the reference of 8 camera rays per pixel, the
// picture of a bake that is judged (first look, whole), and the error figures with their map.
//   bench_live_compare [SCENE ...]
#include "core/bake/solver_for.h"
#include "core/compare/live_compare.h"
#include "core/field/solver.h"
#include "core/scene/sample_scenes.h"
#include <chrono>
#include <fmt/format.h>

using namespace lightloom;

namespace {

using Clock = std::chrono::steady_clock;

double msSince(Clock::time_point then)
{
    return std::chrono::duration<double, std::milli>(Clock::now() - then).count();
}

std::shared_ptr<const IndirectField> bake(const std::shared_ptr<const Scene>& scene, Workers& workers)
{
    std::shared_ptr<const IndirectField> field;
    BakeProducts products;
    BakeControl control(workers, {[&](const Snapshot& s) { field = s.field; }, {}});
    static_cast<void>(solverFor(Method::lightOctree)->bake({scene, {}, {}}, products, control));
    return field;
}

bool measure(const std::string& name)
{
    const Result<Scene> made = sampleScene(name);
    if (!made) return false;
    const auto scene = std::make_shared<const Scene>(*made);
    const auto rays = RayScene::build(scene);
    if (!rays || scene->cameras.empty()) return false;
    const auto lights = std::make_shared<LightSampler>(*rays);
    Workers workers;
    const auto field = bake(scene, workers);
    ViewJob job{scene->cameras.front(), 696, 578};
    job.samples = 8;
    job.indirect = ViewJob::Indirect::paths;

    Clock::time_point began = Clock::now();
    LiveCompare live({*rays, lights, {}, job, {}});
    static_cast<void>(live.advanceReference(workers, {}));
    const double rough = msSince(began);
    while (!live.isWhole()) static_cast<void>(live.advanceReference(workers, {}));
    const double whole = msSince(began);
    live.setField(field);
    began = Clock::now();
    static_cast<void>(live.advanceField(workers, {}));
    const double first = msSince(began);
    while (live.wantsField()) static_cast<void>(live.advanceField(workers, {}));
    const double judged = msSince(began);
    began = Clock::now();
    const auto error = live.error(ErrorKind::absolute);
    const double figures = msSince(began);
    fmt::print("| {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} |\n", name, rough, whole, first, judged, figures);
    return error && *error;
}

} // namespace

int main(int argc, char** argv)
{
    std::vector<std::string> scenes(argv + 1, argv + argc);
    if (scenes.empty()) scenes = {"cornell", "two_rooms", "gallery"};
    fmt::print("| scene | rough, ms | 8 rays, ms | bake, first look, ms | bake, ms | figures and map, ms |\n");
    fmt::print("|---|---|---|---|---|---|\n");
    for (const std::string& scene : scenes) {
        if (measure(scene)) continue;
        fmt::print(stderr, "{}: not measured\n", scene);
        return 1;
    }
    return 0;
}
