// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The outer shells of a glTF file, opened with care: the binary container, the JSON text, and typed looks into it.
namespace lightloom {

using Json = nlohmann::json;

/// Parts of a glb file, or the whole of a .gltf file as `json`. Spans into the bytes it was made from.
struct GltfContainer {
    std::span<const std::uint8_t> json, binary;
    bool hasBinary = false;
};

/// Error: not glTF at all, glTF 1, lengths that disagree with the file, chunks missing or out of order.
[[nodiscard]] Result<GltfContainer> openContainer(std::span<const std::uint8_t> file);

struct JsonLimits {
    std::uint64_t bytes = std::uint64_t{512} << 20;
    std::uint64_t values = 4'000'000; ///< objects, arrays, strings, numbers
    int depth = 64;                   ///< deeper nesting overflows the stack of recursive readers
};

/// `text` as JSON. A first pass without memory counts depth and values and refuses numbers that do not fit a float;
/// then the tree is built. Of keys that occur twice the last counts.
[[nodiscard]] Result<Json> parseJson(std::span<const std::uint8_t> text, const JsonLimits& limits = {});

/// Keeps the first fault found while a file is looked over; later ones are consequences as often as not.
class Faults {
public:
    void add(Error error)
    {
        if (!first_) first_ = std::move(error);
    }
    [[nodiscard]] bool any() const { return first_.has_value(); }
    [[nodiscard]] const Error& first() const { return *first_; }

private:
    std::optional<Error> first_;
};

/// One JSON object and the place it has in the file, for looks that report what is wrong. A getter gives nothing both
/// for a missing key (fine) and for a wrong value (a fault); the caller sees to it that the faults are asked in the
/// end.
class JsonObject {
public:
    /// `list` and `number` name the place: "nodes[3]"; number -1: the list's name alone.
    JsonObject(const Json& value, std::string_view list, std::int64_t number, Faults& faults);

    [[nodiscard]] bool has(const char* key) const;
    /// The object at `key`; an empty one where there is none.
    [[nodiscard]] JsonObject object(const char* key) const;
    /// The array at `key`; an empty one where there is none. At most `most` long.
    [[nodiscard]] const Json& array(const char* key, std::uint64_t most) const;
    /// A whole number in [0, most]; 3.0 counts as 3.
    [[nodiscard]] std::optional<std::uint64_t> whole(const char* key, std::uint64_t most) const;
    /// As `whole`, and a fault where it is missing.
    [[nodiscard]] std::optional<std::uint64_t> needWhole(const char* key, std::uint64_t most) const;
    /// An index into `list` of `size` entries.
    [[nodiscard]] std::optional<std::uint64_t> index(const char* key, std::string_view list, std::uint64_t size) const;
    /// `count` numbers in [low, high] at `key`, or one number if `count` is 0.
    std::vector<double> numbers(const char* key, std::size_t count, double low, double high) const;
    [[nodiscard]] std::string text(const char* key) const; ///< "" where missing
    void flag(const char* key) const;                      ///< must be true or false where present
    void fault(const std::string& what, Error::Kind kind = Error::Kind::badInput) const;
    [[nodiscard]] std::string place() const;
    [[nodiscard]] const Json& value() const { return *value_; }

private:
    const Json* value_;
    std::string list_;
    std::int64_t number_;
    Faults* faults_;
};

/// `name` fit for one line of text: control characters become '?', at most 200 bytes.
[[nodiscard]] std::string plainName(std::string_view name);

} // namespace lightloom
