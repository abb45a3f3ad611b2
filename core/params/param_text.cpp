// SPDX-License-Identifier: Apache-2.0
#include "core/params/param_text.h"
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lightloom {
namespace {

std::string rangeText(const ParamSpec& spec)
{
    if (spec.isChoice()) return fmt::format("one of {}", fmt::join(spec.choices, ", "));
    return fmt::format("{} to {}{}{}", spec.least, spec.most, spec.unit.empty() ? "" : " ", spec.unit);
}

Error badValue(const ParamSpec& spec, std::string_view value)
{
    return {Error::Kind::badInput, fmt::format("{}={} is not possible; it takes {}", spec.key, value, rangeText(spec))};
}

bool isWhole(const ParamSpec& spec) { return !std::holds_alternative<float BakeParams::*>(spec.field); }

} // namespace

const ParamSpec* findParam(std::string_view key)
{
    const auto found = std::ranges::find(kParams, key, &ParamSpec::key);
    return found == kParams.end() ? nullptr : &*found;
}

double paramValue(const BakeParams& params, const ParamSpec& spec)
{
    return std::visit([&](auto member) { return static_cast<double>(params.*member); }, spec.field);
}

std::string paramText(const BakeParams& params, const ParamSpec& spec)
{
    if (spec.isChoice()) return std::string(spec.choices[static_cast<std::size_t>(paramValue(params, spec))]);
    if (const auto* member = std::get_if<float BakeParams::*>(&spec.field)) return fmt::format("{}", params.**member);
    return fmt::format("{:.0f}", paramValue(params, spec));
}

Result<BakeParams> with(BakeParams params, std::string_view key, double value)
{
    const ParamSpec* spec = findParam(key);
    if (!spec) {
        std::vector<std::string_view> keys;
        for (const ParamSpec& known : kParams) keys.push_back(known.key);
        return Error{Error::Kind::badInput,
                     fmt::format("there is no parameter {}; there are {}", key, fmt::join(keys, ", "))};
    }
    // NaN fails the comparison too
    const bool fits = value >= spec->least && value <= spec->most && (!isWhole(*spec) || value == std::floor(value));
    if (!fits) return badValue(*spec, fmt::format("{}", value));
    std::visit(
        [&](auto member) {
            using Value = std::remove_reference_t<decltype(params.*member)>;
            params.*member = static_cast<Value>(value);
        },
        spec->field);
    return params;
}

Result<BakeParams> withText(BakeParams params, std::string_view key, std::string_view value)
{
    const ParamSpec* spec = findParam(key);
    if (!spec) return with(params, key, 0.0);
    if (spec->isChoice()) {
        const auto found = std::ranges::find(spec->choices, value);
        if (found == spec->choices.end()) return badValue(*spec, value);
        return with(params, key, static_cast<double>(found - spec->choices.begin()));
    }
    double number = 0.0;
    const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (code != std::errc{} || end != value.data() + value.size()) return badValue(*spec, value);
    return with(params, key, number);
}

Result<BakeParams> withAssignment(BakeParams params, std::string_view assignment)
{
    const std::size_t equals = assignment.find('=');
    if (equals == std::string_view::npos) {
        return Error{Error::Kind::badInput, fmt::format("expected NAME=VALUE, got {}", assignment)};
    }
    return withText(params, assignment.substr(0, equals), assignment.substr(equals + 1));
}

Result<Done> checkTogether(const BakeParams& params)
{
    if (params.octreeFirstDepth > params.octreeDepth) {
        return Error{Error::Kind::badInput, fmt::format("octree.first-depth={} is beyond octree.depth={}",
                                                        params.octreeFirstDepth, params.octreeDepth)};
    }
    const bool isBox = params.gridNestLowX < params.gridNestHighX && params.gridNestLowY < params.gridNestHighY &&
                       params.gridNestLowZ < params.gridNestHighZ;
    if (params.gridNest == GridNest::box && !isBox) {
        return Error{Error::Kind::badInput, "grid.nest=box needs grid.nest.low below grid.nest.high along x, y and z"};
    }
    return Done{};
}

bool isOfUse(const BakeParams& params, const ParamSpec& spec)
{
    if (spec.key == "grid.nest.fine") return params.gridNest != GridNest::off;
    if (spec.key.starts_with("grid.nest.")) return params.gridNest == GridNest::box;
    return true;
}

std::optional<Stage> firstDifference(const BakeParams& a, const BakeParams& b, Method method)
{
    std::optional<Stage> first;
    for (const ParamSpec& spec : kParams) {
        const bool counts = (spec.methods & (1u << static_cast<unsigned>(method))) != 0;
        if (!counts || paramValue(a, spec) == paramValue(b, spec)) continue;
        if (!first || spec.redo < *first) first = spec.redo;
    }
    return first;
}

std::string stageKey(const BakeParams& params, Stage stage, Method method)
{
    std::string text;
    for (const ParamSpec& spec : kParams) {
        const bool counts = (spec.methods & (1u << static_cast<unsigned>(method))) != 0;
        if (counts && spec.redo <= stage) text += fmt::format("{}={}\n", spec.key, paramText(params, spec));
    }
    return text;
}

BakeParams defaultParams(Method method)
{
    BakeParams params;
    // a grid's noise is every photon's that crosses a cell's face; an octree has hundreds under each kernel
    if (method == Method::irradianceGrid) params.photonCount = 2'000'000;
    return params;
}

Result<BakeParams> preset(std::string_view name, Method method)
{
    BakeParams params = defaultParams(method);
    if (name == "draft") {
        const bool isGrid = method == Method::irradianceGrid;
        params.photonCount = isGrid ? 500'000 : 100'000;
        if (isGrid) params.gridSize = 24;
        params.gatherCount = 100;
        params.octreeDepth = 5;
        params.octreeFirstDepth = 4;
        params.voxelSize = 32;
        params.voxelDirections = 256;
        params.voxelRays = 0;
        params.voxelPhotons = 100'000;
        params.voxelThreshold = 0.05f;
        params.directSamples = 16;
        params.pixelSamples = 4;
        params.referenceSamples = 256;
        return params;
    }
    if (name == "preview") return params;
    if (name == "final") {
        params.photonCount = 4'000'000;
        params.gatherCount = 1600;
        params.gridSize = 48;
        params.gridNest = GridNest::automatic;
        params.voxelSize = 128;
        params.voxelDirections = 1024;
        params.voxelRays = 64;
        params.voxelPhotons = 4'000'000;
        params.voxelThreshold = 0.005f;
        params.voxelCut = 5000;
        params.voxelNear = 128;
        params.directSamples = 256;
        params.pixelSamples = 64;
        params.referenceSamples = 16384;
        return params;
    }
    return Error{Error::Kind::badInput,
                 fmt::format("there is no preset {}; there are {}", name, fmt::join(kPresetNames, ", "))};
}

BakeParams paramsFor(const BakeParams& params, Method from, Method to)
{
    const auto differences = [&params](const BakeParams& other) {
        return std::ranges::count_if(
            kParams, [&](const ParamSpec& spec) { return paramValue(params, spec) != paramValue(other, spec); });
    };
    const auto nearer = [&](std::string_view a, std::string_view b) {
        return differences(*preset(a, from)) < differences(*preset(b, from));
    };
    constexpr std::array<std::string_view, 3> kByRank{"preview", "draft",
                                                      "final"}; // the usual one where two are as near
    const std::string_view nearest = *std::ranges::min_element(kByRank, nearer);
    const BakeParams was = *preset(nearest, from), becomes = *preset(nearest, to);
    BakeParams result = params;
    for (const ParamSpec& spec : kParams) {
        if (paramValue(params, spec) != paramValue(was, spec)) continue;
        const Result<BakeParams> set = with(result, spec.key, paramValue(becomes, spec));
        if (set) result = *set;
    }
    return result;
}

Result<Method> methodNamed(std::string_view name)
{
    const auto found = std::ranges::find(kMethodNames, name);
    if (found == kMethodNames.end()) {
        return Error{Error::Kind::badInput,
                     fmt::format("there is no method {}; there are {}", name, fmt::join(kMethodNames, ", "))};
    }
    return static_cast<Method>(found - kMethodNames.begin());
}

} // namespace lightloom
