// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Before a function: it is compiled for several widths of vectors, and the machine's own is picked when the program is
/// loaded. Not under ThreadSanitizer, which is not ready yet when the pick is made.
#ifdef __SANITIZE_THREAD__
#define LIGHTLOOM_WIDE_VECTORS
#else
#define LIGHTLOOM_WIDE_VECTORS __attribute__((target_clones("avx512f", "avx2", "default")))
#endif
