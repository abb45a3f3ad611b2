// SPDX-License-Identifier: Apache-2.0
// How little an irradiance grid minds the geometry it is used on (RR-6983, section 5): baked on figure with few
// triangles and with many, both used on the one with many.
//   bench_grid_robust [--set NAME=VALUE ...] [FEW MANY]      24000 and 2000000 triangles without
// Differences of the two pictures' indirect luminance, as shares of the brighter one's maximum, and of the maximum of
// the whole picture with direct light, glowing surfaces themselves left out (the report compares whole pictures).
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

struct Pictures {
    std::vector<float> indirect;
    float brightest = 0.0f, brightestWhole = 0.0f; ///< cd/m2; the second with direct light, without lamps themselves
};

Pictures picturesWith(const IndirectField& field, const Bake& scene, Workers& workers)
{
    ViewJob job;
    job.camera = scene.at.rays->scene().cameras.front();
    job.width = 320, job.height = 240, job.samples = 1;
    job.indirect = ViewJob::Indirect::field;
    float glow = 0.0f;
    for (const Material& m : scene.at.rays->scene().materials) glow = std::max(glow, luminance(m.emission));
    const View view = renderView(*scene.at.rays, *scene.at.lights, {}, &field, job, workers, {});
    Pictures pictures;
    for (std::size_t i = 0; i < view.indirect.pixels.size(); ++i) {
        const float indirect = luminance(view.indirect.pixels[i]), direct = luminance(view.direct.pixels[i]);
        pictures.indirect.push_back(indirect);
        pictures.brightest = std::max(pictures.brightest, indirect);
        if (direct < 0.5f * glow) pictures.brightestWhole = std::max(pictures.brightestWhole, direct + indirect);
    }
    return pictures;
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
    const Pictures a = picturesWith(*few->field, *many, workers), b = picturesWith(*many->field, *many, workers);
    double sum = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < a.indirect.size(); ++i) {
        const double off = std::abs(static_cast<double>(a.indirect[i]) - static_cast<double>(b.indirect[i]));
        sum += off, largest = std::max(largest, off);
    }
    const double mean = sum / static_cast<double>(a.indirect.size());
    const auto tell = [&](std::string_view of, float most) {
        fmt::print("difference on average {:.3f} %, at most {:.2f} % of {}'s maximum\n",
                   100.0 * mean / static_cast<double>(most), 100.0 * largest / static_cast<double>(most), of);
    };
    tell("the indirect light", std::max(a.brightest, b.brightest));
    tell("the whole picture", std::max(a.brightestWhole, b.brightestWhole));
    fmt::print("baking took {:.2f} of the time\n", few->cpuSeconds / many->cpuSeconds);
    return 0;
}
