// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lightloom {

/// The bytes of an OpenVDB stream with its random UUID replaced by one made from the content.
[[nodiscard]] std::string withContentUuid(std::string stream);

/// Makes the bytes of an OpenVDB stream reproducible and checkable: its random UUID is replaced by one made from the
/// content, and a trailer follows: "LLSUM1" and the SHA-256 of all before it. Other programs read the file as before:
/// OpenVDB stops at the end of its last grid.
[[nodiscard]] std::vector<std::uint8_t> sealVdb(std::string stream);

/// The OpenVDB part of a sealed file, or why it is none. Checked before OpenVDB sees a byte: flipped bytes make it hang
/// or load wrong values silently.
[[nodiscard]] Result<std::span<const std::uint8_t>> openSeal(std::span<const std::uint8_t> file);

} // namespace lightloom
