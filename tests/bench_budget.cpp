// SPDX-License-Identifier: Apache-2.0
// Do budgets keep what they promise? The table of docs/measurements.md.
//   bench_budget FOLDER [--method NAME] [SCENE ...]
// FOLDER holds SCENE.glb and sweeps of it, SCENE.*.csv, as `lightloom-cli sweep` writes them: what a budget is held
// against. Budgets follow from the sweep: errors of 1.2, 2 and 3 times its least, times within its range, and five
// times its most. Bars: CPU-seconds within 25 % of those asked; error at most 1.5 x the error asked, at no more than 3
// x the cost of the cheapest row that meets it; .01 % and half the floor are refused, and the floor named.
#include "core/bake/solver_for.h"
#include "core/compare/budget.h"
#include "core/compare/field_probe.h"
#include "core/compare/sweep_table.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/gltf_reader.h"
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <sstream>

using namespace lightloom;
namespace fs = std::filesystem;

namespace {

constexpr double kMostTimeOff = 0.25, kMostError = 1.5, kMostCost = 3.0;
constexpr float kReferenceNoise = 0.04f; ///< at most; a better reference that a sweep left is taken

int kept = 0, missed = 0;

const char* verdict(bool isKept)
{
    ++(isKept ? kept : missed);
    return isKept ? "yes" : "NO";
}

std::vector<SweepRow> rowsOf(const fs::path& folder, const std::string& scene, Method method)
{
    std::vector<SweepRow> rows;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with(scene + ".") || !name.ends_with(".csv")) continue;
        std::ostringstream text;
        text << std::ifstream(entry.path()).rdbuf();
        const Result<SweepTable> table = parseSweep(text.str(), method);
        if (table) rows.insert(rows.end(), table->rows.begin(), table->rows.end());
    }
    return rows;
}

class SceneBench {
public:
    SceneBench(const fs::path& folder, const std::string& name, Method method)
        : name_(name), method_(method), rows_(rowsOf(folder, name, method))
    {
        const Result<std::shared_ptr<const Scene>> scene = readScene((folder / (name + ".glb")).string());
        if (!scene || rows_.empty()) return;
        scene_ = *scene;
        BakeControl control(workers_, {});
        const Result<SceneProducts> at = sceneProducts(job({}), products_, control);
        const ReferenceJob reference{kJudgeSeed, 1 << 20, kReferenceNoise, BakeParams().pathDepth,
                                     BakeParams().directSamples};
        const Result<Judge> judge = traceJudge(*at, probeRows(*at, kJudgePoints, kJudgeSeed), reference,
                                               ReferenceStore(folder / (name + ".glb")), workers_, {});
        if (judge) judge_ = *judge;
    }
    [[nodiscard]] bool isReady() const { return !judge_.points.empty(); }

    void run()
    {
        double leastError = 1e300, leastCost = 1e300, mostCost = 0;
        for (const SweepRow& row : rows_) {
            leastError = std::min(leastError, row.error.relRmse);
            leastCost = std::min(leastCost, row.cpuSeconds());
            mostCost = std::max(mostCost, row.cpuSeconds());
        }
        for (const double part : {0.25, 0.75}) time(leastCost * std::pow(mostCost / leastCost, part));
        time(5.0 * mostCost);
        for (const double times : {1.2, 2.0, 3.0}) error(times * leastError);
        floor(leastError);
    }

private:
    [[nodiscard]] BakeJob job(const BakeParams& params) const { return {scene_, params, {}}; }

    Result<BudgetPlan> plan(const BudgetAsked& asked)
    {
        BakeProducts fresh; // as a command begins
        BakeControl control(workers_, {});
        return planBudget(job({}), method_, asked, {}, fresh, control); // nothing stored: pilots at their full cost
    }

    /// Cost and error of a bake from nothing.
    [[nodiscard]] std::pair<double, double> bake(const BakeParams& params)
    {
        BakeProducts fresh;
        std::shared_ptr<const IndirectField> field;
        BakeControl control(workers_, {[&](const Snapshot& s) { field = s.field; }, {}});
        if (!solverFor(method_)->bake(job(params), fresh, control)) return {NAN, NAN};
        const double cost = allCpuSeconds(fresh.counters.stages);
        const Result<SceneProducts> at = sceneProducts(job(params), products_, control);
        const FieldProbe probe(*at->rays, *at->lights, field.get(), params);
        const auto light = probe.indirect(judge_.points, workers_, {});
        return {cost, measureError(luminances(*light), judge_.reference)->relRmse};
    }

    void line(const std::string& asked, const BudgetPlan& plan, std::pair<double, double> actual,
              const std::string& end) const
    {
        const BudgetPick& e = plan.expected;
        fmt::print("| {} | {} | d{} K{} N{} | {:.2f} | {:.2f} | {:.1f} % | {:.2f} | {:.1f} % | {} |\n", name_, asked,
                   e.depth, e.count, e.photons, plan.pilotCpuSeconds, e.cpuSeconds, 100 * e.error, actual.first,
                   100 * actual.second, end);
        std::fflush(stdout);
    }

    void time(double seconds)
    {
        const std::string asked = fmt::format("{:.2f} s", seconds);
        const Result<BudgetPlan> p = plan({seconds, {}});
        if (!p) return failed(asked, p.error());
        const auto actual = bake(p->params);
        double best = 1e300; // for the eye: what the sweep reaches at that cost
        for (const SweepRow& row : rows_)
            if (row.cpuSeconds() <= actual.first) best = std::min(best, row.error.relRmse);
        const double off = actual.first / seconds - 1.0;
        line(asked, *p, actual,
             fmt::format("{:+.0f} % time; best row {:.1f} % | {}", 100 * off, 100 * best,
                         verdict(std::abs(off) <= kMostTimeOff)));
    }

    void error(double wanted)
    {
        const std::string asked = fmt::format("{:.1f} %", 100 * wanted);
        const Result<BudgetPlan> p = plan({{}, wanted});
        if (!p) return failed(asked, p.error());
        const auto actual = bake(p->params);
        double cheapest = 1e300;
        for (const SweepRow& row : rows_)
            if (row.error.relRmse <= wanted) cheapest = std::min(cheapest, row.cpuSeconds());
        const double times = actual.second / wanted, cost = actual.first / cheapest;
        line(asked, *p, actual,
             fmt::format("{:.2f} x error, {:.2f} x cost | {}", times, cost,
                         verdict(times <= kMostError && cost <= kMostCost)));
    }

    /// What cannot be is refused with a floor that is not above what the sweep reached; half of that is refused too.
    void floor(double leastError)
    {
        const Result<BudgetPlan> hopeless = plan({{}, 1e-4});
        const std::string said = hopeless ? "" : hopeless.error().message;
        const std::size_t at = said.find("about ");
        const double floor = at == std::string::npos ? 0.0 : 0.01 * std::strtod(said.c_str() + at + 6, nullptr);
        const Result<BudgetPlan> half = plan({{}, 0.5 * floor});
        const bool isKept = floor > 0.0 && floor <= leastError && !half;
        fmt::print("| {} | 0.01 %, then half the floor | {}; least of the sweep {:.1f} % | | | | | | | {} |\n", name_,
                   hopeless ? "not refused" : said, 100.0 * leastError, verdict(isKept));
        std::fflush(stdout);
    }

    void failed(const std::string& asked, const Error& error) const
    {
        fmt::print("| {} | {} | {} | | | | | | | {} |\n", name_, asked, error.message, verdict(false));
    }

    std::string name_;
    Method method_;
    std::vector<SweepRow> rows_;
    std::shared_ptr<const Scene> scene_;
    Workers workers_;
    BakeProducts products_;
    Judge judge_;
};

} // namespace

int main(int argc, char** argv)
{
    if (argc < 2) return fmt::print("bench_budget FOLDER [--method NAME] [SCENE ...]\n"), 2;
    Method method = Method::lightOctree;
    std::vector<std::string> scenes;
    for (int i = 2; i < argc; ++i) {
        if (std::string(argv[i]) == "--method" && i + 1 < argc)
            method = methodNamed(argv[++i]) ? *methodNamed(argv[i]) : method;
        else
            scenes.emplace_back(argv[i]);
    }
    if (scenes.empty()) scenes = {"cornell", "two_rooms", "figure", "atrium", "gallery"};
    fmt::print("| scene | asked | picked | pilots s | expected s | error | came out s | error | | kept |\n"
               "|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& name : scenes) {
        SceneBench bench(argv[1], name, method);
        if (!bench.isReady()) return fmt::print("{0}: no {0}.glb or no {0}.*.csv in {1}\n", name, argv[1]), 1;
        bench.run();
    }
    fmt::print("\n{} kept, {} missed\n", kept, missed);
    return missed == 0 ? 0 : 1;
}
