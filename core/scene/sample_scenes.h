// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/scene/scene.h"
#include <array>
#include <optional>
#include <string_view>

/// The scenes in sample_scenes/ as functions: each shows one thing (sample_scenes/README.md says which), with named
/// cameras, named lamps and an exposure that suits it. Deterministic: the same bytes every time.
namespace lightloom {

/// The Cornell box with its published measured geometry in metres (0.556 wide), front open to black; x grows to the
/// left as seen from the camera, the lamp is flush in the ceiling, faces down and reflects nothing.
[[nodiscard]] Scene cornellBox();

/// Two rooms of 4 x 2.8 x 4 m behind a wall 0.2 m thick with a door opening; lamps in room A only. One watertight
/// shell.
[[nodiscard]] Scene twoRooms();

/// A hall of 20 x 10 x 12 m inside with two storeys of galleries on 24 columns and a sun through the roof opening. The
/// building is solid: walls 0.4 m thick with an outside.
[[nodiscard]] Scene atrium();

/// Exhibition room, 14 x 4 x 8 m, watertight: 11 lamps of three kinds (6 spots, 2 points, 3 panels), pictures, a
/// wooden floor (textures), mirrors (a golden ring, a steel ball) and brushed frames.
[[nodiscard]] Scene gallery();

/// A table of 1.2 m before a wall, a lamp of 16 x 16 cm above: a brass ring that throws a cardioid of light inside, and
/// a ball of faintly green glass (index 1.5) that throws a focus beside it. Open to black.
[[nodiscard]] Scene causticRing();

/// The Cornell box without its blocks, and a carved figure in it: a closed surface displaced at five scales. The whole
/// scene has `triangles` triangles, one fewer where that is odd. Range 40 .. 20,000,000, else an Error.
inline constexpr std::uint64_t kFigureTriangles = 24000, kLeastFigureTriangles = 40, kMostFigureTriangles = 20'000'000;
[[nodiscard]] Result<Scene> figureScene(std::uint64_t triangles = kFigureTriangles);

inline constexpr std::array<std::string_view, 6> kSampleSceneNames{"cornell", "two_rooms",    "atrium",
                                                                   "gallery", "caustic_ring", "figure"};
/// The scene of that name. Errors: an unknown name (lists the known ones), `triangles` for a scene of fixed size, or
/// out of range.
[[nodiscard]] Result<Scene> sampleScene(std::string_view name, std::optional<std::uint64_t> triangles = std::nullopt);

} // namespace lightloom
