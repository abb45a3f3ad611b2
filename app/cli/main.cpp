// SPDX-License-Identifier: Apache-2.0
// The command line: what may be said, in CLI11's words. The work is in the other files of this folder; CLI11 takes
// seconds to compile, so it stays in this one.
#include "app/cli/commands.h"
#include "app/cli/interrupt.h"
#include "app/cli/progress.h"
#include "app/cli/words.h"
#include "core/scene/sample_scenes.h"
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <tuple>
#include <variant>

using namespace lightloom;
using cli::named;
using cli::sizeOf;
using cli::texts;
using cli::wholeNumber;

namespace {

constexpr std::array<std::string_view, 4> kProgressNames{"auto", "bar", "json", "none"};
constexpr std::array<std::string_view, 4> kLevelNames{"debug", "info", "warning", "error"};
constexpr std::array<std::string_view, 3> kErrorMapNames{"relative", "absolute", "signed"};

/// Everything a command line can hold.
struct Spoken {
    cli::Context context;
    std::string progress = "auto", level = "info";
    cli::BakeOptions bakeOptions; ///< one command runs, so all share these
    std::string isa = "auto", size = "800x600", errorMap = "relative";
    std::string scene, output;
    std::uint64_t count = 0;
    std::string sampleName;
    std::optional<std::uint64_t> triangles;
    cli::BakeCommand bake;
    cli::ProbeCommand probe;
    cli::RenderCommand render;
    cli::CompareCommand compare;
    cli::SweepCommand sweep;
    cli::ExportCommand exported;
};

class CommandLine {
public:
    explicit CommandLine(Spoken& spoken) : spoken_(spoken)
    {
        app_.set_version_flag("--version", LIGHTLOOM_VERSION);
        app_.require_subcommand(0, 1); // none is told apart below, where an unknown one has been named
        app_.footer("lightloom-cli COMMAND --help tells more. Exit codes: 0 done, 1 failed, 2 usage, 3 bad input, "
                    "4 would not fit in memory, 130 interrupted.");
        addGlobals();
        addInfo();
        addPoints();
        addBakeCommand();
        addProbe();
        addRender();
        addCompare();
        addSweep();
        addExport();
        addParams();
        addMakeScene();
    }

    /// The chosen command, or an exit code when there is nothing to run (help, version, wrong usage).
    std::variant<std::function<int()>, int> parse(int argc, char** argv)
    {
        try {
            app_.parse(argc, argv);
        } catch (const CLI::ExtrasError&) {
            const std::vector<std::string> extras = app_.remaining(true);
            cli::logLine(LogLevel::error, extras.front() + " was not expected here; see lightloom-cli --help");
            return cli::kUsage;
        } catch (const CLI::ParseError& e) {
            if (e.get_exit_code() == 0) return app_.exit(e); // help and version, on stdout
            cli::logLine(LogLevel::error, std::string(e.what()) + "; see lightloom-cli --help");
            return cli::kUsage;
        }
        if (app_.get_subcommands().empty()) {
            cli::logLine(LogLevel::error, "no command was given; see lightloom-cli --help");
            return cli::kUsage;
        }
        return commands_.at(app_.get_subcommands().front());
    }

private:
    void addGlobals()
    {
        cli::Context& context = spoken_.context;
        app_.add_option("--threads", context.threads, "Threads to work on; 0: one per core")
            ->check(CLI::Range(0, 1024))
            ->option_text("N");
        app_.add_option("--seed", context.seed, "Seed of all random numbers")->check(wholeNumber)->option_text("N");
        app_.add_flag("--quiet", context.quiet, "No progress, no log but errors");
        addChoice(app_, "--progress", spoken_.progress, texts(kProgressNames), "How progress is told on stderr");
        addChoice(app_, "--log-level", spoken_.level, texts(kLevelNames), "Least important line that is logged");
        app_.add_flag("--json", context.json, "Results for programs, on stdout");
    }

    static CLI::Option* addChoice(CLI::App& to, const std::string& name, std::string& value,
                                  const std::vector<std::string>& choices, const std::string& help)
    {
        std::string all;
        for (const std::string& choice : choices) all += (all.empty() ? "" : "|") + choice;
        return to.add_option(name, value, help)->option_text(all)->check([choices, all](const std::string& text) {
            return std::ranges::find(choices, text) == choices.end() ? text + " is none of " + all : std::string();
        });
    }

    CLI::App* addCommand(const std::string& name, const std::string& help, std::function<int()> run)
    {
        CLI::App* command = app_.add_subcommand(name, help);
        command->fallthrough(); // the options above are taken on both sides of the command
        commands_[command] = std::move(run);
        return command;
    }

    /// A command that takes a scene, and what it is to write.
    CLI::App* addSceneCommand(const std::string& name, const std::string& help, std::function<int()> run)
    {
        CLI::App* command = addCommand(name, help, std::move(run));
        command->add_option("SCENE", spoken_.scene, "A .gltf or .glb file")->required();
        return command;
    }
    CLI::Option* addOutput(CLI::App& to, const std::string& what)
    {
        return to.add_option("-o,--output", spoken_.output, what)->option_text("FILE");
    }

    void addMethod(CLI::App& to, std::string& method) { addChoice(to, "--method", method, texts(kMethodNames), "How"); }

    static void addBake(CLI::App& to, std::string& file)
    {
        to.add_option("--bake", file, "A finished bake of the scene, instead of a new one; --method may be left out")
            ->option_text("BAKE.vdb");
    }

    void addSet(CLI::App& to)
    {
        to.add_option("--set", spoken_.bakeOptions.set, "One parameter; see lightloom-cli params. May be repeated")
            ->allow_extra_args(false)
            ->option_text("NAME=VALUE");
    }

    static void addCache(CLI::App& to, cli::CacheUse& cache)
    {
        to.add_flag("!--no-cache", cache.isUsed, "Trace the reference anew, and keep nothing of it");
        to.add_flag("--resume", cache.resume, "Go on with the reference that an interrupted run left");
    }

    void addBakeOptions(CLI::App& to)
    {
        cli::BakeOptions& o = spoken_.bakeOptions;
        addChoice(to, "--preset", o.preset, texts(kPresetNames), "All parameters at once, by purpose")
            ->each([&o](const std::string&) { o.isPresetGiven = true; });
        addSet(to);
        to.add_option("--target-stderr", o.targetStderr, "Trace the reference to this error, a fraction of the mean")
            ->option_text("FRACTION");
        addChoice(to, "--isa", spoken_.isa, texts(kIsaNames), "Instruction set for rays; part of the result's bits");
    }

    void addBudgets(CLI::App& to)
    {
        cli::BakeOptions& o = spoken_.bakeOptions;
        to.add_option("--time-budget", o.timeBudget, "Pick octree.depth, gather.count and photons for so much time")
            ->option_text("CPU_SECONDS");
        to.add_option("--error-budget", o.errorBudget, "Pick them for this error (relRMSE), as cheaply as can be")
            ->option_text("FRACTION");
    }

    [[nodiscard]] cli::BakeOptions bakeOptions() const
    {
        cli::BakeOptions options = spoken_.bakeOptions;
        options.seed = spoken_.context.seed;
        options.isa = named<Isa>(kIsaNames, spoken_.isa);
        return options;
    }

    void addInfo()
    {
        addSceneCommand("info", "What a scene holds, and what follows from it for a bake",
                        [this] { return cli::info(spoken_.context, spoken_.scene); });
    }

    void addPoints()
    {
        CLI::App* command =
            addSceneCommand("points", "Probe points, even over the surfaces that light can reach", [this] {
                return cli::points(spoken_.context, spoken_.scene, spoken_.count, spoken_.context.seed.value_or(1),
                                   spoken_.output);
            });
        command->add_option("--count", spoken_.count, "How many")->required()->check(wholeNumber)->option_text("N");
        addOutput(*command, "POINTS.csv; standard output without");
    }

    void addBakeCommand()
    {
        CLI::App* command = addSceneCommand("bake", "Bake a scene's indirect light into a file", [this] {
            spoken_.bake.scene = spoken_.scene;
            spoken_.bake.output = spoken_.output;
            spoken_.bake.options = bakeOptions();
            return cli::bake(spoken_.context, spoken_.bake);
        });
        addMethod(*command, spoken_.bake.method);
        addBakeOptions(*command);
        addBudgets(*command);
        addOutput(*command, "BAKE.vdb")->required();
    }

    void addProbe()
    {
        CLI::App* command = addSceneCommand("probe", "Direct and indirect light at points, in lux", [this] {
            spoken_.probe.scene = spoken_.scene;
            spoken_.probe.output = spoken_.output;
            spoken_.probe.options = bakeOptions();
            return cli::probe(spoken_.context, spoken_.probe);
        });
        addMethod(*command, spoken_.probe.method);
        addBake(*command, spoken_.probe.bakeFile);
        command->add_option("--points", spoken_.probe.points, "Where: x,y,z,nx,ny,nz")->required()->option_text("FILE");
        addCache(*command, spoken_.probe.cache);
        addBakeOptions(*command);
        addBudgets(*command);
        addOutput(*command, "RESULT.csv; standard output without");
    }

    void addRender()
    {
        cli::RenderCommand& r = spoken_.render;
        CLI::App* command = addSceneCommand("render", "A picture from one of the scene's cameras", [this] {
            spoken_.render.scene = spoken_.scene;
            spoken_.render.output = spoken_.output;
            spoken_.render.options = bakeOptions();
            std::tie(spoken_.render.width, spoken_.render.height) = *sizeOf(spoken_.size);
            return cli::render(spoken_.context, spoken_.render);
        });
        addMethod(*command, r.method);
        addBake(*command, r.bakeFile);
        command->add_option("--camera", r.camera, "Name or number from 0; the first without")
            ->option_text("NAME|INDEX");
        command->add_option("--size", spoken_.size, "Pixels, 800x600 without")
            ->option_text("WxH")
            ->check([](const std::string& text) {
                return sizeOf(text)
                           ? std::string()
                           : text + " is not WIDTHxHEIGHT with sides from 1 to 16384, 64 million pixels in all";
            });
        command->add_option("--spp", r.samplesPerPixel, "Camera rays per pixel")->option_text("N");
        command->add_option("--ev", r.ev, "Exposure value of a .png; the scene's own without")
            ->check(CLI::Range(-100.0f, 100.0f))
            ->option_text("EV");
        command->add_flag("--final-gather", r.finalGather,
                          "Gather indirect light with probe.rays rays a pixel; the bake answers where they end");
        command->add_option("--noise-map", r.noiseMap, "Where to write the noise that the bake states, in false colour")
            ->option_text("OUT.png");
        command->add_option("--cut-map", r.cutMap, "Where to write the sizes of lightcuts, in false colour")
            ->option_text("OUT.png");
        addCache(*command, r.cache);
        addBakeOptions(*command);
        addBudgets(*command);
        addOutput(*command, "IMAGE.exr (cd/m2; layers direct and indirect) or IMAGE.png")->required();
    }

    void addSweep()
    {
        cli::SweepCommand& c = spoken_.sweep;
        CLI::App* command = addSceneCommand("sweep", "Cost and error of a method over parameters", [this] {
            spoken_.sweep.scene = spoken_.scene;
            spoken_.sweep.output = spoken_.output;
            spoken_.sweep.options = bakeOptions();
            return cli::sweep(spoken_.context, spoken_.sweep);
        });
        addMethod(*command, c.method);
        command
            ->add_option("--vary", c.vary, "A parameter and its values: V1,V2, a..b:step, a..b*factor. May be repeated")
            ->allow_extra_args(false)
            ->option_text("NAME=VALUES");
        command->add_option("--reference", c.reference, "A table with points, or auto: traced and kept with the scene")
            ->option_text("REF.csv|auto");
        command->add_option("--probes", c.probes, "Points of --reference auto, 2000 without")
            ->check(wholeNumber)
            ->option_text("N");
        command->add_option("--plot", c.plot, "Error over cost as a picture")->option_text("OUT.svg");
        addBakeOptions(*command);
        addOutput(*command, "SWEEP.csv; rows it holds already are not made again")->required();
    }

    void addParams()
    {
        addCommand("params", "List every bake parameter: name, default, range, meaning",
                   [this] { return cli::params(spoken_.context); });
    }

    void addMakeScene()
    {
        CLI::App* command = addCommand("make-scene", "Write one of the sample scenes as glTF", [this] {
            return cli::makeScene(spoken_.context, spoken_.sampleName, spoken_.triangles, spoken_.output);
        });
        addChoice(*command, "NAME", spoken_.sampleName, texts(kSampleSceneNames), "Which")->required();
        command->add_option("--triangles", spoken_.triangles, "Size of figure; others have one size")
            ->check(CLI::Range(kLeastFigureTriangles, kMostFigureTriangles))
            ->option_text("N");
        addOutput(*command, "OUT.glb")->required();
    }

    void addCompare()
    {
        cli::CompareCommand& c = spoken_.compare;
        CLI::App* command =
            addCommand("compare", "Errors of A against the reference B: two tables, two pictures, or a bake", [this] {
                spoken_.compare.options = bakeOptions();
                spoken_.compare.map = named<ErrorKind>(kErrorMapNames, spoken_.errorMap);
                return cli::compare(spoken_.context, spoken_.compare);
            });
        command->add_option("A", c.a, "RESULT.csv, .exr, .png, or BAKE.vdb")->required();
        command->add_option("B", c.b, "The reference, of the same kind; .csv or .exr for a bake")->required();
        addChoice(*command, "--metric", c.metric, {"relrmse", "bias", "mae", "p95", "max", "perpoint", "flip"},
                  "Print this figure alone, as a fraction");
        command->add_option("--heatmap", c.heatmap, "Where to write the error in false colour")->option_text("OUT.png");
        addChoice(
            *command, "--map", spoken_.errorMap, texts(kErrorMapNames),
            "What the heatmap shows: error over the mean, error in the picture's unit, or too dark and too bright");
        command->add_option("--scene", c.scene, "The bake's scene")->option_text("SCENE");
        command->add_option("--camera", c.camera, "Camera of a picture that does not tell its own")
            ->option_text("NAME|INDEX");
        addSet(*command);
    }

    void addExport()
    {
        cli::ExportCommand& c = spoken_.exported;
        CLI::App* command = addCommand("export", "A finished bake for other programs", [this] {
            spoken_.exported.options = bakeOptions();
            return cli::exportBake(spoken_.context, spoken_.exported);
        });
        command->add_option("BAKE", c.bakeFile, "A finished bake")->required();
        command->add_option("--scene", c.scene, "The scene it was baked for")->required()->option_text("SCENE");
        command->add_option("--lightmap", c.lightmap, "Lux on every surface, unfolded")->option_text("OUT.exr");
        command->add_option("--gltf", c.gltf, "The scene with its lightmap; an .exr goes beside it")
            ->option_text("OUT.glb");
        command->add_option("--volume", c.volume, "Leaves of an octree, vertices of a grid or voxels, as OpenVDB grids")
            ->option_text("OUT.vdb");
        auto* size = command->add_option("--atlas-size", c.size, "Texels a side of the lightmap, 1024 without")
                         ->option_text("N");
        auto* density =
            command->add_option("--texels-per-metre", c.texelsPerMetre, "Detail, instead of a size")->option_text("N");
        size->excludes(density);
        command->add_flag("--with-direct", c.withDirect, "Direct light in the lightmap too; no lamps in OUT.glb");
        command->add_flag("--scene-uv", c.sceneUv, "The scene's own second UV set instead of new charts");
        addSet(*command);
    }

    Spoken& spoken_;
    CLI::App app_{"Lightloom: indirect light, baked, measured and exported without a window", "lightloom-cli"};
    std::map<const CLI::App*, std::function<int()>> commands_;
};

/// A result that did not reach its reader is no result.
int flushed(int code)
{
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
    cli::logLine(LogLevel::error, "cannot write to standard output");
    return code == cli::kDone ? cli::kFailed : code;
}

int run(int argc, char** argv)
{
    Spoken spoken;
    CommandLine commandLine(spoken);
    const auto parsed = commandLine.parse(argc, argv);
    if (const int* code = std::get_if<int>(&parsed)) return flushed(*code);

    cli::Context& context = spoken.context;
    context.progress = named<cli::ProgressStyle>(kProgressNames, spoken.progress);
    cli::Reporter reporter({context.progress, named<LogLevel>(kLevelNames, spoken.level), context.quiet});
    const cli::Interrupt interrupt;
    Workers workers(context.threads);
    context.report = &reporter;
    context.log = [&](LogLevel level, const std::string& line) { reporter.log(level, line); };
    context.stop = interrupt.token();
    context.workers = &workers;
    return flushed(std::get<std::function<int()>>(parsed)());
}

} // namespace

int main(int argc, char** argv)
{
    try {
        return run(argc, argv);
    } catch (const std::bad_alloc&) {
        cli::logLine(LogLevel::error, "there is not enough memory; lower photons, octree.depth or the picture's size");
        return cli::kWouldNotFit;
    } catch (const std::exception& e) {
        if (std::ferror(stdout)) return flushed(cli::kDone); // long output fails before its end
        cli::logLine(LogLevel::error, std::string("unexpected: ") + e.what());
        return cli::kFailed;
    }
}
