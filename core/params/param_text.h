// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/params/bake_params.h"
#include <optional>
#include <string>
#include <vector>

/// Parameters as text: parse, print, check, compare. All loop over `kParams`; nothing else knows the keys.
namespace lightloom {

[[nodiscard]] const ParamSpec* findParam(std::string_view key); ///< null if there is none

/// Value as a number; the index of a choice.
[[nodiscard]] double paramValue(const BakeParams& params, const ParamSpec& spec);
/// Value as `--set` takes it: shortest text that parses back to the same bits, or the choice's name.
[[nodiscard]] std::string paramText(const BakeParams& params, const ParamSpec& spec);

/// `params` with `key` set to `value` (a choice's index for choices), or an Error that names key, value and range.
[[nodiscard]] Result<BakeParams> with(BakeParams params, std::string_view key, double value);
/// The same from text: a number or a choice's name.
[[nodiscard]] Result<BakeParams> withText(BakeParams params, std::string_view key, std::string_view value);
/// `NAME=VALUE`, as on the command line.
[[nodiscard]] Result<BakeParams> withAssignment(BakeParams params, std::string_view assignment);

/// What parameters ask for together, where single ranges cannot say: an Error that names both, or Done.
[[nodiscard]] Result<Done> checkTogether(const BakeParams& params);

/// Whether a parameter has a part in a bake while the others are as they are: the box of a grid without a finer one
/// has none.
[[nodiscard]] bool isOfUse(const BakeParams& params, const ParamSpec& spec);

/// The earliest stage at which two bakes with `method` part; nothing if they give the same result.
[[nodiscard]] std::optional<Stage> firstDifference(const BakeParams& a, const BakeParams& b, Method method);

/// Text of every parameter up to and including `stage` that `method` reads: equal texts, equal products.
[[nodiscard]] std::string stageKey(const BakeParams& params, Stage stage, Method method);

/// "draft", "preview" (the method's defaults) or "final"; Error lists them.
[[nodiscard]] Result<BakeParams> preset(std::string_view name, Method method);
inline constexpr std::array<std::string_view, 3> kPresetNames{"draft", "preview", "final"};
[[nodiscard]] BakeParams defaultParams(Method method);
/// `params`, of the method `from`, for `to`: what stands as in the preset that they are nearest to becomes what that
/// preset has for `to`; what was set by hand stays.
[[nodiscard]] BakeParams paramsFor(const BakeParams& params, Method from, Method to);

inline constexpr std::array<std::string_view, 6> kMethodNames{"light-octree", "irradiance-grid", "voxel-lightcuts",
                                                              "photon-map",   "direct",          "reference"};
[[nodiscard]] Result<Method> methodNamed(std::string_view name);
[[nodiscard]] inline std::string_view methodName(Method method)
{
    return kMethodNames[static_cast<std::size_t>(method)];
}
inline constexpr std::array<std::string_view, 4> kStageNames{"shoot", "build", "fit", "show"};
[[nodiscard]] inline std::string_view stageName(Stage stage) { return kStageNames[static_cast<std::size_t>(stage)]; }

} // namespace lightloom
