// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/hash.h"
#include <algorithm>
#include <cstring>
#include <optional>
#include <string_view>

namespace lightloom {

/// Plain values as bytes, one after another, in this machine's order: for files that only the program itself reads.
/// `sealed` ends them with a SHA-256, which `openSealed` checks.
class ByteWriter {
public:
    template<class T>
    void put(const T& value)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        append(&value, sizeof value);
    }
    /// Count, then the values.
    template<class T>
    void put(const std::vector<T>& values)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        put(static_cast<std::uint64_t>(values.size()));
        append(values.data(), values.size() * sizeof(T));
    }
    void put(std::string_view text) { append(text.data(), text.size()); }

    [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
    [[nodiscard]] std::vector<std::uint8_t> sealed() &&
    {
        const Sha256::Digest sum = Sha256().add(bytes_.data(), bytes_.size()).finish();
        append(sum.data(), sum.size());
        return std::move(bytes_);
    }

private:
    void append(const void* from, std::size_t count)
    {
        const auto* first = static_cast<const std::uint8_t*>(from);
        bytes_.resize(bytes_.size() + count); // at -O3 g++ 12 sees `insert` write past the end
        std::copy_n(first, count, bytes_.end() - static_cast<std::ptrdiff_t>(count));
    }
    std::vector<std::uint8_t> bytes_;
};

/// The bytes before a matching SHA-256; nothing if it does not match.
[[nodiscard]] inline std::optional<std::span<const std::uint8_t>> openSealed(std::span<const std::uint8_t> file)
{
    if (file.size() < sizeof(Sha256::Digest)) return {};
    const auto content = file.first(file.size() - sizeof(Sha256::Digest));
    const Sha256::Digest sum = Sha256().add(content.data(), content.size()).finish();
    if (!std::ranges::equal(sum, file.last(sum.size()))) return {};
    return content;
}

/// Reads what a ByteWriter wrote. Past the end everything is refused, and stays refused.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}
    template<class T>
    [[nodiscard]] bool get(T& value)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        return take(&value, sizeof value);
    }
    template<class T>
    [[nodiscard]] bool get(std::vector<T>& values)
    {
        std::uint64_t count = 0;
        if (!get(count) || count > rest_.size() / sizeof(T)) return fail();
        values.resize(static_cast<std::size_t>(count));
        return take(values.data(), values.size() * sizeof(T));
    }
    /// True if the next bytes are `text`.
    [[nodiscard]] bool expect(std::string_view text)
    {
        std::string found(text.size(), '\0');
        return take(found.data(), found.size()) && found == text;
    }
    [[nodiscard]] bool isAtEnd() const { return rest_.empty(); }

private:
    bool fail()
    {
        rest_ = {};
        return false;
    }
    bool take(void* into, std::size_t count)
    {
        if (count > rest_.size()) return fail();
        if (count > 0) std::memcpy(into, rest_.data(), count);
        rest_ = rest_.subspan(count);
        return true;
    }
    std::span<const std::uint8_t> rest_;
};

} // namespace lightloom
