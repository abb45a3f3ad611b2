// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "app/cli/budget.h"
#include "core/bake/bake_file.h"
#include "core/field/bake_products.h"
#include "core/field/indirect_field.h"

/// What bake, probe and render share: from a scene's file and a method's name to something that lights points.
namespace lightloom::cli {

/// A scene, ready for rays, with its lamps.
struct LitScene {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const RayScene> rays;
    std::shared_ptr<const LightSampler> lights;
    std::shared_ptr<const LightReach> reach; ///< null unless a bake was run
};
[[nodiscard]] Result<LitScene> readLitScene(const Context& context, const std::string& path, Isa isa);

/// How points are to be lit: the command line's method and options, or what a bake file says.
struct Lighting {
    LitScene lit;
    Method method = Method::lightOctree;
    BakeParams params;
    std::shared_ptr<const IndirectField> field; ///< null for `direct` and `reference`
    std::shared_ptr<const IndirectField> shown; ///< `field` as parameters of stage `show` want it looked up
    WorkCounters counters;                      ///< of the bake, if one was run
    double bakeSeconds = 0;
    std::optional<BudgetReport> budget; ///< what was picked for it, where a budget was given
};

/// What `prepareLighting` wants to know.
struct LightingRequest {
    std::string scene, method, bakeFile;
    BakeOptions options;
    CacheUse cache{};
};

/// Options that no method could follow, told apart from bad input because their exit code is another (usage).
[[nodiscard]] Result<Done> checkRequest(const LightingRequest& request);

/// Reads the scene and, for a cached method, bakes (progress 0 to `bakeShare` of the command) or reads the bake file.
/// With a bake file its parameters count; options may change only what shows a bake (direct.samples, probe.rays,
/// render.samples). Errors: also a bake of another scene or method.
[[nodiscard]] Result<Lighting> prepareLighting(const Context& context, const LightingRequest& request,
                                               double bakeShare);

/// What a file says about the bake.
[[nodiscard]] BakeInfo bakeInfo(const Lighting& lighting);

/// References of the scene's file, as the command line wants them used.
[[nodiscard]] ReferenceStore storeOf(const Context& context, const std::string& scene, const CacheUse& cache);

/// Prints `error` and gives the exit code of wrong usage.
int failUsage(const Error& error);

/// Error of kind outOfMemory if `bytes` are more than nine tenths of this machine's memory; `what` says for what.
[[nodiscard]] Result<Done> checkFits(double bytes, const std::string& what, const std::string& wayOut);

} // namespace lightloom::cli
