// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lightloom::test {

/// How much slower a sanitizer may make our code. Limits on time are multiplied by it, other limits never.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr double kSanitizerSlowdown = 8.0;
#else
inline constexpr double kSanitizerSlowdown = 1.0;
#endif

} // namespace lightloom::test
