// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/log.h"
#include "core/base/parallel.h"
#include "core/compare/false_colour.h"
#include "core/params/param_text.h"
#include "core/scene/scene.h"
#include "core/trace/ray_scene.h"
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

/// The commands of lightloom-cli as plain functions; main.cpp parses the command line into these structs. Results go to
/// stdout or the output file, progress and log to stderr. Each returns the exit code.
namespace lightloom::cli {

enum ExitCode { kDone = 0, kFailed = 1, kUsage = 2, kBadInput = 3, kWouldNotFit = 4, kInterrupted = 130 };

enum class ProgressStyle { automatic, bar, json, none };

class Reporter; // app/cli/progress.h

/// Options every command takes, and the services they configure.
struct Context {
    int threads = 0;
    bool quiet = false, json = false;
    std::optional<std::uint64_t> seed; ///< --seed
    ProgressStyle progress = ProgressStyle::automatic;
    LogSink log;          ///< writes to stderr at the asked level
    std::stop_token stop; ///< SIGINT
    Workers* workers = nullptr;
    Reporter* report = nullptr; ///< progress; set like `workers` before a command runs
};

/// Bake options as given, turned into parameters by `bakeParams`.
struct BakeOptions {
    std::string preset = "preview";
    bool isPresetGiven = false;   ///< asked for, not just the usual one
    std::vector<std::string> set; ///< NAME=VALUE
    std::optional<std::uint64_t> seed;
    std::optional<double> targetStderr;
    std::optional<double> timeBudget, errorBudget; ///< CPU-seconds; fraction
    Isa isa = Isa::automatic;
};
[[nodiscard]] Result<BakeParams> bakeParams(const BakeOptions& options, Method method);
/// With --target-stderr the most paths and samples of a reference rise out of its way, unless they were set by hand.
void makeRoomForTarget(BakeParams& params, const BakeOptions& options);
/// Whether `key` was given a value by hand.
[[nodiscard]] bool isSet(const BakeOptions& options, std::string_view key);
/// The options other than the preset, on top of `from`.
[[nodiscard]] Result<BakeParams> withOptions(BakeParams from, const BakeOptions& options);

/// Prints `error` as one line on stderr and gives its exit code: bad, missing or unsupported input 3, not enough memory
/// 4, cancelled 130, anything else 1.
int fail(const Error& error);
/// The same for a file that could not be written: 1, whatever the reason.
int failWriting(const Error& error);

/// Found out before the work, not after it: the folder of `output` exists and `output` is not a folder itself.
[[nodiscard]] Result<Done> checkOutput(const std::string& output);

int info(const Context& context, const std::string& scene);
int makeScene(const Context& context, const std::string& name, std::optional<std::uint64_t> triangles,
              const std::string& output);
int params(const Context& context);
int points(const Context& context, const std::string& scene, std::uint64_t count, std::uint64_t seed,
           const std::string& output);

struct BakeCommand {
    std::string scene, method, output;
    BakeOptions options;
};
int bake(const Context& context, const BakeCommand& command);

/// What may be done with references on disk.
struct CacheUse {
    bool isUsed = true;  ///< take them from there, and keep them there
    bool resume = false; ///< go on with what an interrupted run left
};

struct ProbeCommand {
    std::string scene, method, points, bakeFile, output;
    CacheUse cache{};
    BakeOptions options;
};
int probe(const Context& context, const ProbeCommand& command);

struct RenderCommand {
    std::string scene, method, bakeFile, camera, output;
    std::string noiseMap, cutMap; ///< empty: none is written
    int width = 800, height = 600;
    std::optional<int> samplesPerPixel;
    std::optional<float> ev;  ///< exposure of a .png; else the scene's, else one that suits the picture
    bool finalGather = false; ///< 256 rays (probe.rays) at each pixel's surface, the field at their ends
    CacheUse cache{};
    BakeOptions options;
};
int render(const Context& context, const RenderCommand& command);

struct CompareCommand {
    std::string a, b, metric, heatmap;
    ErrorKind map = ErrorKind::relative; ///< what the heatmap shows
    std::string scene, camera;           ///< of a bake; the camera else as in the reference's header
    BakeOptions options;                 ///< how a bake is shown
};
int compare(const Context& context, const CompareCommand& command);

struct SweepCommand {
    std::string scene, method, output, plot;
    std::vector<std::string> vary;  ///< NAME=VALUES
    std::string reference = "auto"; ///< or a table
    std::uint64_t probes = 2000;    ///< points of the reference that is traced
    BakeOptions options;
};
int sweep(const Context& context, const SweepCommand& command);

struct ExportCommand {
    std::string bakeFile, scene, lightmap, gltf, volume; ///< empty: not wanted
    int size = 1024;
    std::optional<double> texelsPerMetre;
    bool withDirect = false, sceneUv = false;
    BakeOptions options; ///< how the bake is shown
};
int exportBake(const Context& context, const ExportCommand& command);

} // namespace lightloom::cli
