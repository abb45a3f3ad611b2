// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string_view>
#include <utility>

namespace lightloom {

/// Finaliser of SplitMix64: a bijection of 64-bit words in which every input bit reaches every output bit.
[[nodiscard]] constexpr std::uint64_t mixBits(std::uint64_t x)
{
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    return x ^ (x >> 31);
}

/// FNV-1a with a final mix: turns a name (a light group's id, say) into a stream key. Stable for ever: files hold it.
[[nodiscard]] constexpr std::uint64_t hashName(std::string_view name)
{
    std::uint64_t h = 0xCBF29CE484222325ull;
    for (const char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001B3ull;
    return mixBits(h);
}

/// Counter-based random numbers: number d of a stream depends on (seed, stream, item, d) alone, so that photon `item`
/// of a light group is the same photon on any thread, in any order, on any machine.
class Rng {
public:
    Rng(std::uint64_t seed, std::uint64_t stream, std::uint64_t item) : Rng(streamKey(seed, stream), item) {}

    /// What all items of a stream share: worth keeping where many are made.
    static std::uint64_t streamKey(std::uint64_t seed, std::uint64_t stream)
    {
        return mixBits(mixBits(seed + kStep) ^ stream);
    }
    Rng(std::uint64_t streamKey, std::uint64_t item) : state_(mixBits(streamKey + kStep * (item + 1))) {}

    std::uint64_t bits() { return mixBits(state_ += kStep); }

    /// Uniform in [0, 1): 24 bits, so that 1 never comes out of the conversion.
    float uniform() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }

    /// Two independent ones from one step.
    std::pair<float, float> uniformPair()
    {
        const std::uint64_t word = bits();
        return {static_cast<float>(word >> 40) * 0x1p-24f, static_cast<float>(word >> 16 & 0xFFFFFFu) * 0x1p-24f};
    }

    /// Uniform in [0, 1) with 53 bits, for places where 2^-24 steps would show.
    double uniformDouble() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

private:
    static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15ull; // 2^64 / golden ratio, odd
    std::uint64_t state_;
};

} // namespace lightloom
