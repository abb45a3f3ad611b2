// SPDX-License-Identifier: Apache-2.0
// How soon the picture follows a lamp that is dragged: gallery's lamp over the bench is moved 50 times through a
// BakeSession as the window would. Time from the edit to the first snapshot with the moved lamp's light, and to the
// settled one, by the clock on the wall and by CPU time of all threads; and what the first picture's time goes into.
//   bench_lamp_drag [--moves N] [--threads N] [--method NAME] [--set NAME=VALUE ...] [SCENE [LAMP]]
// light-octree, or voxel-lightcuts.
#include "core/bake/bake_session.h"
#include "core/bake/gpu_layout.h"
#include "core/bake/solver_for.h"
#include "core/octree/light_octree.h"
#include "core/params/param_text.h"
#include "core/scene/sample_scenes.h"
#include "core/voxel/voxel_field.h"
#include "tests/bench_clock.h"
#include <charconv>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <future>
#include <map>

using namespace lightloom;

namespace {

/// The times of one edit, from posting it.
struct Followed {
    double firstMs = 0, firstCpuMs = 0, settledMs = 0, settledCpuMs = 0;
    double texturesMs = 0, texturesCpuMs = 0; ///< of it what the window makes of all snapshots
};

/// A session that is posted one edit after another and waits for each to settle.
class Desk {
public:
    Desk(Method method, int threads)
        : workers_(threads), session_(workers_, solverFor(method),
                                      {[this](const Snapshot& s) { show(s); },
                                       {},
                                       [this](std::uint64_t, const Result<Done>& outcome) {
                                           ended_.set_value(outcome ? std::string() : outcome.error().message);
                                       }})
    {
    }

    Followed follow(const BakeJob& job)
    {
        ended_ = {};
        seen_ = {};
        isFirst_ = true;
        firstStages_.clear();
        began_ = Clock::now();
        cpuBegan_ = 1000.0 * cpuSeconds(CpuOf::process);
        session_.post(job);
        if (const std::string error = ended_.get_future().get(); !error.empty()) fmt::print("{}\n", error);
        seen_.settledMs = msSince(began_);
        seen_.settledCpuMs = 1000.0 * cpuSeconds(CpuOf::process) - cpuBegan_;
        settledStages_ = session_.products().counters.stages;
        return seen_;
    }
    [[nodiscard]] WorkCounters counters() const { return session_.counters(); }
    [[nodiscard]] const std::vector<StageCost>& firstStages() const { return firstStages_; }
    /// Of the whole edit, the first picture's among them.
    [[nodiscard]] const std::vector<StageCost>& settledStages() const { return settledStages_; }

private:
    void show(const Snapshot& snapshot)
    {
        // what the window makes of it before it can draw
        const auto* voxels = dynamic_cast<const VoxelField*>(snapshot.field.get());
        const auto* octree = voxels ? &voxels->octree() : dynamic_cast<const LightOctree*>(snapshot.field.get());
        if (!octree) return;
        const auto began = Clock::now();
        const double cpuBegan = cpuSeconds(CpuOf::thread);
        const Result<GpuOctree> gpu = makeGpuOctree(*octree);
        if (!gpu) fmt::print("{}\n", gpu.error().message);
        seen_.texturesMs += msSince(began);
        seen_.texturesCpuMs += 1000.0 * (cpuSeconds(CpuOf::thread) - cpuBegan);
        if (!std::exchange(isFirst_, false)) return;
        firstStages_ = session_.products().counters.stages;
        firstStages_.push_back({"texture arrays", msSince(began), msSince(began), false});
        seen_.firstMs = msSince(began_);
        seen_.firstCpuMs = 1000.0 * cpuSeconds(CpuOf::process) - cpuBegan_;
    }

    std::promise<std::string> ended_;
    Followed seen_;
    bool isFirst_ = true;
    std::vector<StageCost> firstStages_, settledStages_;
    Clock::time_point began_;
    double cpuBegan_ = 0;
    Workers workers_;
    BakeSession session_;
};

double part(std::vector<double> values, double share)
{
    std::ranges::sort(values);
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

void print(const char* what, const std::vector<double>& wall, const std::vector<double>& cpu)
{
    fmt::print("| {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", what, part(wall, 0.5), part(wall, 0.95), part(cpu, 0.5),
               part(cpu, 0.95));
}

/// The scene with lamp `index` a little further along a small circle around where the file has it.
std::shared_ptr<const Scene> moved(const Scene& scene, std::size_t index, int step)
{
    auto edited = std::make_shared<Scene>(scene);
    const float angle = 0.35f * static_cast<float>(step);
    PunctualLight& lamp = edited->lights[index];
    const float wide = std::min(0.6f, 0.12f * scene.bounds.longestSide()), high = 0.25f * wide;
    const glm::vec3 shift(wide * std::cos(angle), high * std::sin(2.0f * angle), wide * std::sin(angle));
    if (lamp.kind == PunctualLight::Kind::directional)
        lamp.travel = glm::normalize(lamp.travel + 0.2f * shift);
    else
        lamp.position += shift;
    return edited;
}

/// A point lamp with a light group of its own, for scenes whose lamps are glowing surfaces.
void hangLamp(Scene& scene)
{
    PunctualLight lamp;
    lamp.node = "a lamp hung up";
    lamp.position = scene.bounds.centre() + glm::vec3(0.0f, 0.25f * scene.bounds.size().y, 0.0f);
    lamp.intensity = glm::vec3(100.0f);
    lamp.group = static_cast<int>(scene.groups.size());
    scene.groups.push_back({lamp.node, lamp.node});
    scene.lights.push_back(lamp);
}

void measure(const std::string& name, const std::string& wanted, Method method, const BakeParams& params, int moves,
             int threads)
{
    Result<Scene> scene = sampleScene(name);
    if (!scene) return fmt::print("{}: no such scene\n", name);
    if (scene->lights.empty()) hangLamp(*scene);
    std::size_t lamp = 0;
    for (std::size_t i = 0; i < scene->lights.size(); ++i) {
        if (scene->lights[i].node.find(wanted) != std::string::npos) lamp = i;
    }
    Desk desk(method, threads);
    BakeJob job;
    job.scene = std::make_shared<const Scene>(*scene);
    job.params = params;
    job.roughFirst = true;
    const Followed opened = desk.follow(job);
    std::vector<double> first, firstCpu, settled, settledCpu, field, fieldCpu;
    std::map<std::string, std::vector<double>> stages, allStages;
    std::uint64_t shot = 0, groupsShot = 0;
    for (int i = 1; i <= moves; ++i) {
        job.scene = moved(*scene, lamp, i);
        const Followed one = desk.follow(job);
        first.push_back(one.firstMs), firstCpu.push_back(one.firstCpuMs);
        settled.push_back(one.settledMs), settledCpu.push_back(one.settledCpuMs);
        field.push_back(one.settledMs - one.texturesMs), fieldCpu.push_back(one.settledCpuMs - one.texturesCpuMs);
        for (const StageCost& s : desk.firstStages()) {
            if (!s.isKept) stages[s.stage].push_back(s.wallMs);
        }
        for (const StageCost& s : desk.settledStages()) {
            if (!s.isKept) allStages[s.stage].push_back(s.cpuMs);
        }
        const WorkCounters done = desk.counters();
        shot = std::max(shot, done.photonsShot);
        groupsShot = std::max(groupsShot, done.groupsBaked - done.groupsReused);
    }
    fmt::print("{}, {} moved {} times; photons shot per edit at most {}, for {} of {} lamps\n\n", name,
               scene->lights[lamp].node, moves, shot, groupsShot, scene->groups.size());
    fmt::print("| from the edit to | median ms | p95 ms | median CPU ms | p95 CPU ms |\n|---|---|---|---|---|\n");
    print("first picture with the lamp's light", first, firstCpu);
    print("settled", settled, settledCpu);
    print("settled, without texture arrays", field, fieldCpu);
    print("first picture of the scene, for comparison", {opened.firstMs}, {opened.firstCpuMs});
    print("the whole scene settled", {opened.settledMs}, {opened.settledCpuMs});
    fmt::print("\nFirst picture, medians in ms:");
    double sum = 0;
    for (const auto& [stage, ms] : stages) {
        fmt::print(" {} {:.1f},", stage, part(ms, 0.5));
        sum += part(ms, 0.5);
    }
    fmt::print(" rest {:.1f}\n", part(first, 0.5) - sum);
    fmt::print("Until settled, medians in CPU ms:");
    for (const auto& [stage, ms] : allStages) fmt::print(" {} {:.1f},", stage, part(ms, 0.5));
    fmt::print("\n");
}

} // namespace

int main(int argc, char** argv)
{
    int moves = 50, threads = 0;
    Method method = Method::lightOctree;
    BakeParams params;
    std::vector<std::string> words;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const char* value = i + 1 < argc ? argv[i + 1] : "";
        if (word == "--moves" || word == "--threads") {
            std::from_chars(value, value + std::strlen(value), word == "--moves" ? moves : threads);
            ++i;
        } else if (word == "--method") {
            const Result<Method> named = methodNamed(value);
            if (!named || (*named != Method::lightOctree && *named != Method::voxelLightcuts))
                return fmt::print("--method wants light-octree or voxel-lightcuts\n"), 2;
            method = *named;
            params = paramsFor(params, Method::lightOctree, method);
            ++i;
        } else if (word == "--set") {
            const Result<BakeParams> set = withAssignment(params, value);
            if (!set) return fmt::print("{}\n", set.error().message), 2;
            params = *set;
            ++i;
        } else {
            words.push_back(word);
        }
    }
    words.resize(std::max<std::size_t>(words.size(), 2));
    measure(words[0].empty() ? "gallery" : words[0], words[1].empty() ? "bench" : words[1], method, params,
            std::max(moves, 1), threads);
    return 0;
}
