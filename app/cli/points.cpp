// SPDX-License-Identifier: Apache-2.0
#include "app/cli/methods.h"
#include "app/cli/progress.h"
#include "core/base/atomic_file.h"
#include "core/compare/judge.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {

int points(const Context& context, const std::string& scene, std::uint64_t count, std::uint64_t seed,
           const std::string& output)
{
    if (!output.empty()) {
        if (const Result<Done> fine = checkOutput(output); !fine) return failWriting(fine.error());
    }
    // a point is some 30 bytes in memory and up to 130 as text, which exists twice while it is written
    const Result<Done> fits =
        checkFits(400.0 * static_cast<double>(count), fmt::format("a table of {} points", count), "ask for fewer");
    if (!fits) return fail(fits.error());
    const Result<LitScene> lit = readLitScene(context, scene, Isa::automatic);
    if (!lit) return fail(lit.error());
    const auto reach = LightReach::find(*lit->rays, *lit->lights, *context.workers, context.stop);
    if (!reach) return fail({Error::Kind::cancelled, "interrupted; no points were written"});

    const std::vector<ProbeRow> rows = probeRows({lit->rays, lit->lights, reach, {}, {}, {}}, count, seed);
    if (rows.size() < count) {
        return fail({Error::Kind::badInput, fmt::format("{}: no surface has an area that light can reach", scene)});
    }
    const std::string text = pointsText(rows);
    if (output.empty()) {
        fmt::print("{}", text);
        return kDone;
    }
    if (const Result<Done> written = writeFile(output, text); !written) return failWriting(written.error());
    if (context.json) {
        const nlohmann::json json{{"points", count}, {"seed", seed}, {"output", output}};
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    }
    return kDone;
}

} // namespace lightloom::cli
