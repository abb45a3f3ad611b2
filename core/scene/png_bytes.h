// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/scene/scene.h"

namespace lightloom {

/// A PNG file of `image`, three channels if it is opaque throughout, else four. No colour space is written: in glTF
/// the use of an image decides. Errors: libpng's, or an image whose pixels do not match its size.
[[nodiscard]] Result<std::vector<std::uint8_t>> pngBytes(const Image& image);

} // namespace lightloom
