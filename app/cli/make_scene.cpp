// SPDX-License-Identifier: Apache-2.0
#include "app/cli/commands.h"
#include "core/scene/gltf_writer.h"
#include "core/scene/sample_scenes.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {

int makeScene(const Context& context, const std::string& name, std::optional<std::uint64_t> triangles,
              const std::string& output)
{
    const Result<Scene> scene = sampleScene(name, triangles);
    if (!scene) return fail(scene.error());
    const Result<Done> written = writeGltf(*scene, output);
    if (!written) return failWriting(written.error());
    std::uint64_t count = 0;
    for (const Instance& instance : scene->instances) {
        count += scene->meshes[static_cast<std::size_t>(instance.mesh)].triangles.size();
    }
    log(context.log, LogLevel::info,
        fmt::format("make-scene {} triangles={} lamps={} cameras={} file={}", name, count, scene->groups.size(),
                    scene->cameras.size(), output));
    if (context.json) {
        const nlohmann::json report{{"scene", name}, {"triangles", count}, {"file", output}};
        fmt::print("{}\n", report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    }
    return kDone;
}

} // namespace lightloom::cli
