// SPDX-License-Identifier: Apache-2.0
#include "core/field/bake_products.h"

namespace lightloom {

void BakeProducts::beginRound(int rounds)
{
    std::lock_guard lock(mutex_);
    ++round_;
    std::erase_if(kept_,
                  [&](const auto& item) { return item.second.lastUse + static_cast<std::uint64_t>(rounds) < round_; });
    counters = {};
}

void BakeProducts::clear()
{
    std::lock_guard lock(mutex_);
    kept_.clear();
}

} // namespace lightloom
