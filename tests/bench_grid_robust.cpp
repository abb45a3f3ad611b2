// SPDX-License-Identifier: Apache-2.0
// How little an irradiance grid minds the geometry it is used on (RR-6983, section 5): baked on figure with few
// triangles and with many, both used on the one with many.
//   bench_grid_robust [--set NAME=VALUE ...] [FEW MANY]      24000 and 2000000 triangles without
// Differences of the two pictures' indirect luminance, as shares of the brighter one's maximum.
#include "core/bake/render_view.h"
#include "core/base/units.h"
#include "core/ivg/ivg_solver.h"
#include "tests/bench_clock.h"
#include "tests/bench_judge.h"
#include "tests/bench_scene.h"

using namespace lightloom;

namespace {

struct Bake {
    SceneProducts at;
    std::shared_ptr<const IndirectField> field;
    double cpuSeconds = 0.0;
};

std::optional<Bake> bakeOf(const std::string& name, const BakeParams& params, Workers& workers)
{
    const Result<Scene> made = benchScene(name);
    if (!made) return fmt::print("{}\n", made.error().message), std::nullopt;
    Bake bake;
    BakeProducts products;
    BakeControl control(workers, {[&](const Snapshot& s) { bake.field = s.field; }, {}});
    const BakeJob job{std::make_shared<const Scene>(*made), params, {}};
    const Result<Done> done = IvgSolver().bake(job, products, control);
    if (!done) return fmt::print("{}\n", done.error().message), std::nullopt;
    bake.cpuSeconds = allCpuSeconds(products.counters.stages);
    bake.at = *sceneProducts(job, products, control);
    fmt::print("{}: {:.2f} CPU-s in all", name, bake.cpuSeconds);
    for (const StageCost& s : products.counters.stages) {
        if (!s.isKept) fmt::print(", {} {:.2f}", s.stage, s.cpuMs / 1000.0);
    }
    fmt::print("\n");
    std::fflush(stdout);
    return bake;
}

std::vector<float> pictureWith(const IndirectField& field, const Bake& scene, Workers& workers)
{
    ViewJob job;
    job.camera = scene.at.rays->scene().cameras.front();
    job.width = 320, job.height = 240, job.samples = 1;
    job.indirect = ViewJob::Indirect::field;
    job.withDirect = false;
    std::vector<float> light;
    for (const glm::vec3 pixel :
         renderView(*scene.at.rays, *scene.at.lights, {}, &field, job, workers, {}).indirect.pixels)
        light.push_back(luminance(pixel));
    return light;
}

} // namespace

int main(int argc, char** argv)
{
    std::optional<JudgeSettings> settings = JudgeSettings::read(argc, argv);
    if (!settings) return 2;
    const bool isSaid = settings->words.size() == 2;
    Workers workers;
    const auto few = bakeOf("figure:" + (isSaid ? settings->words[0] : "24000"), settings->params, workers);
    const auto many = bakeOf("figure:" + (isSaid ? settings->words[1] : "2000000"), settings->params, workers);
    if (!few || !many) return 1;
    const std::vector<float> a = pictureWith(*few->field, *many, workers),
                             b = pictureWith(*many->field, *many, workers);
    double sum = 0.0, largest = 0.0, brightest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double off = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
        sum += off, largest = std::max(largest, off);
        brightest = std::max(brightest, static_cast<double>(std::max(a[i], b[i])));
    }
    fmt::print(
        "difference on average {:.3f} %, at most {:.2f} % of the picture's maximum; baking took {:.2f} of the time\n",
        100.0 * sum / (static_cast<double>(a.size()) * brightest), 100.0 * largest / brightest,
        few->cpuSeconds / many->cpuSeconds);
    return 0;
}
