// SPDX-License-Identifier: Apache-2.0
#include "core/field/bake_products.h"

namespace lightloom {

void BakeProducts::beginRound(int rounds)
{
    std::lock_guard lock(mutex_);
    ++round_;
    const auto lasting = static_cast<std::uint64_t>(rounds);
    std::erase_if(kept_, [&](const auto& item) {
        const Kept& kept = item.second;
        const bool isOfWhole = kept.lastWholeUse > 0 && kept.lastWholeUse + lasting > wholeRounds_;
        return kept.lastUse + lasting < round_ && !isOfWhole;
    });
    counters = {};
}

void BakeProducts::endRound()
{
    std::lock_guard lock(mutex_);
    ++wholeRounds_;
    for (auto& [key, kept] : kept_) {
        if (kept.lastUse == round_) kept.lastWholeUse = wholeRounds_;
    }
}

void BakeProducts::clear()
{
    std::lock_guard lock(mutex_);
    kept_.clear();
}

std::size_t BakeProducts::count()
{
    std::lock_guard lock(mutex_);
    return kept_.size();
}

} // namespace lightloom
