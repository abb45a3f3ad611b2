// SPDX-License-Identifier: Apache-2.0
#include "app/cli/commands.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {

Result<BakeParams> bakeParams(const BakeOptions& options)
{
    const Result<BakeParams> params = preset(options.preset);
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

nlohmann::json asJson(const ParamSpec& spec)
{
    nlohmann::json json{
        {"key", spec.key},   {"label", spec.label},          {"unit", spec.unit}, {"least", spec.least},
        {"most", spec.most}, {"redo", stageName(spec.redo)}, {"help", spec.help}, {"default", paramText({}, spec)}};
    for (const std::string_view name : spec.choices) json["choices"].push_back(name);
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
        fmt::print("{:<20} {:<10} {:<22} {}{}\n{:20} {}\n", spec.key, paramText({}, spec), range,
                   spec.unit.empty() ? "" : fmt::format("{}; ", spec.unit),
                   fmt::format("redoes {}", stageName(spec.redo)), "", spec.help);
    }
    return kDone;
}

} // namespace lightloom::cli
