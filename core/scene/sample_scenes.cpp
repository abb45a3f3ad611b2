// SPDX-License-Identifier: Apache-2.0
#include "core/scene/sample_scenes.h"
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lightloom {

Result<Scene> sampleScene(std::string_view name, std::optional<std::uint64_t> triangles)
{
    if (name == "figure") return figureScene(triangles.value_or(kFigureTriangles));
    using Maker = Scene (*)();
    static constexpr std::array<std::pair<std::string_view, Maker>, 5> kMakers{{{"cornell", cornellBox},
                                                                                {"two_rooms", twoRooms},
                                                                                {"atrium", atrium},
                                                                                {"gallery", gallery},
                                                                                {"caustic_ring", causticRing}}};
    for (const auto& [known, make] : kMakers) {
        if (name != known) continue;
        if (!triangles) return make();
        return Error{Error::Kind::badInput,
                     fmt::format("scene \"{}\" has a fixed number of triangles; only figure takes a number", name)};
    }
    return Error{Error::Kind::notFound,
                 fmt::format("no scene \"{}\"; there are {}", name, fmt::join(kSampleSceneNames, ", "))};
}

} // namespace lightloom
