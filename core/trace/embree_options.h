// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace lightloom {

/// What an Embree device is made with. `isa`: one of Embree's names of instruction sets. Under ThreadSanitizer Embree
/// builds on the calling thread alone: how its threads wait for each other cannot be seen, and would look like races.
[[nodiscard]] inline std::string embreeOptions(std::string_view isa)
{
    std::string options = "isa=" + std::string(isa);
#ifdef __SANITIZE_THREAD__
    options += ",threads=1";
#endif
    return options;
}

} // namespace lightloom
