// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/octree/leaf_pick.h"
#include <QMetaType>
#include <cstdint>

namespace lightloom {

struct BakeView;

/// A leaf that was picked in the viewport, and where its light came from.
struct PickedLeaf {
    std::optional<LeafPick> leaf;               ///< nothing: the point lies in none
    std::vector<glm::vec3> photons;             ///< gathered for the entry that answers, all lamps that are on
    std::shared_ptr<const IndirectField> field; ///< that was asked
};

/// What `view` keeps at `p` facing `n`. Some milliseconds; any thread.
[[nodiscard]] PickedLeaf pickedLeaf(const BakeView& view, glm::vec3 p, glm::vec3 n);

} // namespace lightloom

Q_DECLARE_METATYPE(lightloom::PickedLeaf)
