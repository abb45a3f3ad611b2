// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace lightloom {

/// SHA-256, fed piece by piece.
class Sha256 {
public:
    using Digest = std::array<std::uint8_t, 32>;
    Sha256();
    ~Sha256();
    Sha256(const Sha256&) = delete;
    Sha256& operator=(const Sha256&) = delete;

    Sha256& add(const void* bytes, std::size_t count);
    /// A value without padding, as its bytes.
    template<class T>
    Sha256& add(const T& value)
    {
        static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
        return add(&value, sizeof value);
    }
    /// Length first, so that ("ab","c") and ("a","bc") differ.
    Sha256& add(const std::string& text);
    template<class T>
    Sha256& add(const std::vector<T>& values)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        add(static_cast<std::uint64_t>(values.size()));
        return add(values.data(), values.size() * sizeof(T));
    }
    /// Ends the sum; nothing can be added afterwards.
    [[nodiscard]] Digest finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

[[nodiscard]] std::string toHex(std::span<const std::uint8_t> bytes);

} // namespace lightloom
