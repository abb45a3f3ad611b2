// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/picked_leaf.h"
#include <QStringList>

namespace lightloom {

/// Lux of a light on its entry's own surface, "0.42", "12.3", "231".
[[nodiscard]] QString luxOfText(const PickedEntry& entry, const Vdl& vdl);

/// What was picked, line by line; the first is a title.
[[nodiscard]] QStringList pickText(const PickedLeaf& picked);

} // namespace lightloom
