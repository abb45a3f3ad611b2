// SPDX-License-Identifier: Apache-2.0
// How long a bake goes on after it was cancelled, at moments spread evenly over the whole of it: wall time and CPU time
// of all threads, by stage. The contract is 100 ms.
//   bench_cancel [--runs N] [--set NAME=VALUE ...] [SCENE[:TRIANGLES] ...]
#include "core/bake/bake_session.h"
#include "core/octree/octree_solver.h"
#include "core/params/param_text.h"
#include "tests/bench_clock.h"
#include "tests/bench_scene.h"
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <future>
#include <map>
#include <thread>

using namespace lightloom;

namespace {

struct Taken {
    std::vector<double> wallMs, cpuMs;
};

/// One bake from nothing, cancelled after `ms`.
class Run {
public:
    Run(Workers& workers, const BakeJob& job)
        : session_(workers, std::make_unique<OctreeSolver>(),
                   {[](const Snapshot&) {}, [this](const Progress& p) { stage_ = p.stage; },
                    [this](std::uint64_t, const Result<Done>& outcome) { ended_.set_value(bool(outcome)); }})
    {
        session_.post(job);
    }

    /// False: the bake was done before.
    bool cancelAfter(double ms, std::map<std::string, Taken>& byStage)
    {
        std::future<bool> end = ended_.get_future();
        if (end.wait_for(std::chrono::duration<double, std::milli>(ms)) == std::future_status::ready) return false;
        Taken& taken = byStage[std::string(stageName(stage_))];
        const auto asked = Clock::now();
        const double cpu = cpuSeconds(CpuOf::process);
        session_.cancel();
        if (end.get()) return false;
        taken.wallMs.push_back(msSince(asked));
        taken.cpuMs.push_back(1000.0 * (cpuSeconds(CpuOf::process) - cpu));
        return true;
    }

    double waitMs() // for the whole bake
    {
        const auto began = Clock::now();
        ended_.get_future().wait();
        return msSince(began);
    }

private:
    std::atomic<Stage> stage_ = Stage::shoot;
    std::promise<bool> ended_;
    BakeSession session_;
};

void print(const std::string& scene, const std::string& stage, const Taken& taken)
{
    if (taken.wallMs.empty()) return;
    const auto part = [](std::vector<double> v, double share) {
        std::ranges::sort(v);
        return v[static_cast<std::size_t>(share * static_cast<double>(v.size() - 1) + 0.5)];
    };
    fmt::print("| {} | {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", scene, stage, taken.wallMs.size(),
               part(taken.wallMs, 0.95), part(taken.wallMs, 1.0), part(taken.cpuMs, 0.95), part(taken.cpuMs, 1.0));
    std::fflush(stdout);
}

void measure(const std::string& name, const BakeParams& params, int runs)
{
    const Result<Scene> made = benchScene(name);
    if (!made) {
        fmt::print("{}\n", made.error().message);
        return;
    }
    BakeJob job;
    job.scene = std::make_shared<const Scene>(*made);
    job.params = params;
    Workers workers;
    const double whole = Run(workers, job).waitMs();
    std::map<std::string, Taken> byStage;
    for (int i = 0; i < runs; ++i) Run(workers, job).cancelAfter(whole * (i + 0.5) / runs, byStage);
    for (const auto& [stage, taken] : byStage) print(name, stage, taken);
}

} // namespace

int main(int argc, char** argv)
{
    int runs = 60;
    BakeParams params;
    std::vector<std::string> scenes;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const char* value = i + 1 < argc ? argv[i + 1] : "";
        if (word == "--runs") {
            std::from_chars(value, value + std::strlen(value), runs);
            ++i;
        } else if (word == "--set") {
            const Result<BakeParams> set = withAssignment(params, value);
            if (!set) return fmt::print("{}\n", set.error().message), 2;
            params = *set;
            ++i;
        } else {
            scenes.push_back(word);
        }
    }
    if (scenes.empty()) scenes = {"cornell", "figure:2000000"};
    fmt::print("| scene | stage | runs | p95 ms | max ms | p95 CPU ms | max CPU ms |\n|---|---|---|---|---|---|---|\n");
    for (const std::string& name : scenes) measure(name, params, runs);
    return 0;
}
