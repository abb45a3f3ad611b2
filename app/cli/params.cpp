// SPDX-License-Identifier: Apache-2.0
#include "app/cli/commands.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {

Result<BakeParams> bakeParams(const BakeOptions& options, Method method)
{
    const Result<BakeParams> params = preset(options.preset, method);
    return params ? withOptions(*params, options) : params;
}

void makeRoomForTarget(BakeParams& params, const BakeOptions& options)
{
    constexpr int kMostPaths = 1 << 20, kMostSamples = 1 << 14;
    if (params.referenceStderr <= 0.0f || !options.targetStderr) return;
    if (!isSet(options, "reference.samples")) params.referenceSamples = std::max(params.referenceSamples, kMostPaths);
    if (!isSet(options, "render.samples")) params.pixelSamples = std::max(params.pixelSamples, kMostSamples);
}

bool isSet(const BakeOptions& options, std::string_view key)
{
    return std::ranges::any_of(options.set, [key](const std::string& text) {
        return text.starts_with(key) && text.substr(key.size()).starts_with('=');
    });
}

Result<BakeParams> withOptions(BakeParams from, const BakeOptions& options)
{
    Result<BakeParams> params = from;
    for (const std::string& assignment : options.set) {
        if (params) params = withAssignment(*params, assignment);
    }
    if (params && options.seed) params = with(*params, "seed", static_cast<double>(*options.seed));
    if (params && options.targetStderr) params = with(*params, "reference.stderr", *options.targetStderr);
    if (!params) return params;
    if (const Result<Done> checked = checkTogether(*params); !checked) return checked.error();
    return params;
}

namespace {

/// What the parameter is by default for methods for which that is not the usual value.
std::vector<std::pair<std::string_view, std::string>> otherDefaults(const ParamSpec& spec)
{
    std::vector<std::pair<std::string_view, std::string>> others;
    for (std::size_t m = 0; m < kMethodNames.size(); ++m) {
        const BakeParams defaults = defaultParams(static_cast<Method>(m));
        const bool isOther = paramValue(defaults, spec) != paramValue({}, spec);
        if (isOther && (spec.methods & (1u << m)) != 0) others.emplace_back(kMethodNames[m], paramText(defaults, spec));
    }
    return others;
}

nlohmann::json asJson(const ParamSpec& spec)
{
    nlohmann::json json{
        {"key", spec.key},   {"label", spec.label},          {"unit", spec.unit}, {"least", spec.least},
        {"most", spec.most}, {"redo", stageName(spec.redo)}, {"help", spec.help}, {"default", paramText({}, spec)}};
    for (const std::string_view name : spec.choices) json["choices"].push_back(name);
    for (const auto& [method, value] : otherDefaults(spec)) json["defaults"][std::string(method)] = value;
    for (std::size_t m = 0; m < kMethodNames.size(); ++m) {
        if (spec.methods & (1u << m)) json["methods"].push_back(kMethodNames[m]);
    }
    return json;
}

} // namespace

int params(const Context& context)
{
    if (context.json) {
        nlohmann::json all = nlohmann::json::array();
        for (const ParamSpec& spec : kParams) all.push_back(asJson(spec));
        fmt::print("{}\n", all.dump(2));
        return kDone;
    }
    for (const ParamSpec& spec : kParams) {
        const std::string range = spec.isChoice() ? fmt::format("{}", fmt::join(spec.choices, "|"))
                                                  : fmt::format("{:.10g} .. {:.10g}", spec.least, spec.most);
        std::string notes = spec.unit.empty() ? "" : fmt::format("{}; ", spec.unit);
        for (const auto& [method, value] : otherDefaults(spec)) notes += fmt::format("{} for {}; ", value, method);
        fmt::print("{:<20} {:<10} {:<22} {}redoes {}\n{:20} {}\n", spec.key, paramText({}, spec), range, notes,
                   stageName(spec.redo), "", spec.help);
    }
    return kDone;
}

} // namespace lightloom::cli
