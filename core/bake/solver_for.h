// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"

namespace lightloom {

/// A solver of the method, ready to bake; null for `direct` and `reference`, which keep nothing to bake.
[[nodiscard]] std::unique_ptr<Solver> solverFor(Method method);

} // namespace lightloom
