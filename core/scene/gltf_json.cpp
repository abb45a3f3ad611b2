// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf_json.h"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace lightloom {
namespace {

constexpr std::uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

Error bad(std::string message) { return {Error::Kind::badInput, std::move(message)}; }

std::uint32_t littleEndian(std::span<const std::uint8_t> bytes, std::size_t at)
{
    return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
           static_cast<std::uint32_t>(bytes[at + 2]) << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

Result<GltfContainer> openGlb(std::span<const std::uint8_t> file)
{
    if (file.size() < 20) return bad("the glb file is cut off in its header");
    const std::uint32_t version = littleEndian(file, 4);
    if (version != 2) return bad(fmt::format("this is glb version {}; only version 2 is read", version));
    const std::uint64_t length = littleEndian(file, 8);
    if (length > file.size()) {
        return bad(fmt::format("the glb file says it has {} bytes but ends after {}", length, file.size()));
    }
    GltfContainer parts;
    bool hasJson = false;
    for (std::uint64_t at = 12; at < length;) {
        if (length - at < 8) return bad("the glb file is cut off in a chunk header");
        const std::uint64_t size = littleEndian(file, at);
        const std::uint32_t kind = littleEndian(file, at + 4);
        at += 8;
        if (size > length - at) {
            return bad(fmt::format("a glb chunk of {} bytes reaches past the end of the file", size));
        }
        const auto chunk = file.subspan(at, size);
        if (!hasJson) {
            if (kind != kJsonChunk) return bad("the first chunk of the glb file is not JSON");
            parts.json = chunk;
            hasJson = true;
        } else if (kind == kBinaryChunk && !parts.hasBinary) {
            parts.binary = chunk;
            parts.hasBinary = true;
        }
        at += size;
    }
    if (!hasJson) return bad("the glb file holds no JSON chunk");
    return parts;
}

/// First pass over the text: nothing is kept, so nothing hostile can grow.
class Guard : public nlohmann::json_sax<Json> {
public:
    explicit Guard(const JsonLimits& limits) : limits_(limits) {}
    std::string fault;

    bool null() override { return count(); }
    bool boolean(bool) override { return count(); }
    bool number_integer(std::int64_t) override { return count(); }
    bool number_unsigned(std::uint64_t) override { return count(); }
    bool number_float(double v, const std::string& text) override
    {
        if (std::abs(v) <= static_cast<double>(std::numeric_limits<float>::max())) return count();
        return refuse(fmt::format("the number {} is too large", plainName(text)));
    }
    bool string(std::string&) override { return count(); }
    bool binary(nlohmann::json::binary_t&) override { return count(); }
    bool start_object(std::size_t) override { return enter(); }
    bool start_array(std::size_t) override { return enter(); }
    bool end_object() override { return --depth_, true; }
    bool end_array() override { return --depth_, true; }
    bool key(std::string&) override { return count(); }
    bool parse_error(std::size_t at, const std::string&, const nlohmann::detail::exception& e) override
    {
        const bool tooLarge = e.id == 406;
        return refuse(fmt::format("the JSON text is damaged at byte {}{}", at, tooLarge ? " (number too large)" : ""));
    }

private:
    bool refuse(std::string what)
    {
        fault = std::move(what);
        return false;
    }
    bool count()
    {
        return ++values_ <= limits_.values ||
               refuse(fmt::format("the JSON text holds more than {} values", limits_.values));
    }
    bool enter()
    {
        if (++depth_ > limits_.depth) {
            return refuse(fmt::format("the JSON text nests deeper than {} levels", limits_.depth));
        }
        return count();
    }

    const JsonLimits& limits_;
    std::uint64_t values_ = 0;
    int depth_ = 0;
};

const Json& emptyObject()
{
    static const Json empty = Json::object();
    return empty;
}
const Json& emptyArray()
{
    static const Json empty = Json::array();
    return empty;
}

} // namespace

Result<GltfContainer> openContainer(std::span<const std::uint8_t> file)
{
    if (file.size() >= 4 && littleEndian(file, 0) == kGlbMagic) return openGlb(file);
    std::size_t at = 0;
    if (file.size() >= 3 && file[0] == 0xEF && file[1] == 0xBB && file[2] == 0xBF) at = 3; // byte order mark
    while (at < file.size() && std::strchr(" \t\r\n", file[at]) != nullptr && file[at] != 0) ++at;
    if (at == file.size()) return bad(file.empty() ? "the file is empty" : "the file holds no text");
    if (file[at] != '{') return bad("this is not a glTF file: it begins neither with \"glTF\" nor with \"{\"");
    GltfContainer parts;
    parts.json = file.subspan(at);
    return parts;
}

Result<Json> parseJson(std::span<const std::uint8_t> text, const JsonLimits& limits)
{
    if (text.size() > limits.bytes) {
        return bad(fmt::format("the JSON text has {} bytes; at most {} are read", text.size(), limits.bytes));
    }
    const auto* begin = reinterpret_cast<const char*>(text.data());
    const auto* end = begin + text.size();
    Guard guard(limits);
    if (!Json::sax_parse(begin, end, &guard)) return bad(guard.fault);
    Json tree = Json::parse(begin, end, nullptr, false);
    if (tree.is_discarded() || !tree.is_object()) return bad("the JSON text is damaged");
    return tree;
}

JsonObject::JsonObject(const Json& value, std::string_view list, std::int64_t number, Faults& faults)
    : value_(&value), list_(list), number_(number), faults_(&faults)
{
    if (value.is_object()) return;
    fault("it is not a JSON object");
    value_ = &emptyObject();
}

std::string JsonObject::place() const { return number_ < 0 ? list_ : fmt::format("{}[{}]", list_, number_); }

void JsonObject::fault(const std::string& what, Error::Kind kind) const
{
    if (!faults_->any()) faults_->add(Error{kind, what}.in(place()));
}

bool JsonObject::has(const char* key) const { return value_->contains(key); }

JsonObject JsonObject::object(const char* key) const
{
    const auto found = value_->find(key);
    return {found == value_->end() ? emptyObject() : *found, fmt::format("{}.{}", place(), key), -1, *faults_};
}

const Json& JsonObject::array(const char* key, std::uint64_t most) const
{
    const auto found = value_->find(key);
    if (found == value_->end()) return emptyArray();
    if (!found->is_array()) {
        fault(fmt::format("{} is not an array", key));
        return emptyArray();
    }
    if (found->size() > most) {
        fault(fmt::format("{} has {} entries; at most {} are read", key, found->size(), most));
        return emptyArray();
    }
    return *found;
}

std::optional<std::uint64_t> JsonObject::whole(const char* key, std::uint64_t most) const
{
    const auto found = value_->find(key);
    if (found == value_->end()) return std::nullopt;
    const double v = found->is_number() ? found->get<double>() : -1.0;
    if (!(v >= 0.0 && v <= static_cast<double>(most) && v == std::floor(v))) {
        fault(found->is_number() ? fmt::format("{} is {}, which is not a whole number in 0 .. {}", key, v, most)
                                 : fmt::format("{} is not a number", key));
        return std::nullopt;
    }
    return static_cast<std::uint64_t>(v);
}

std::optional<std::uint64_t> JsonObject::needWhole(const char* key, std::uint64_t most) const
{
    if (!has(key)) fault(fmt::format("{} is missing", key));
    return whole(key, most);
}

std::optional<std::uint64_t> JsonObject::index(const char* key, std::string_view list, std::uint64_t size) const
{
    const auto at = whole(key, std::numeric_limits<std::int32_t>::max());
    if (!at || *at < size) return at;
    fault(fmt::format("{} is {}, but the file has {} {}", key, *at, size, list));
    return std::nullopt;
}

std::vector<double> JsonObject::numbers(const char* key, std::size_t count, double low, double high) const
{
    const auto found = value_->find(key);
    if (found == value_->end()) return {};
    std::vector<double> values;
    const auto take = [&](const Json& v) {
        const double number = v.is_number() ? v.get<double>() : std::numeric_limits<double>::quiet_NaN();
        if (!(number >= low && number <= high)) fault(fmt::format("{} is not in {} .. {}", key, low, high));
        values.push_back(number);
    };
    if (count == 0) {
        take(*found);
    } else if (!found->is_array() || found->size() != count) {
        fault(fmt::format("{} is not an array of {} numbers", key, count));
    } else {
        for (const Json& v : *found) take(v);
    }
    return values;
}

std::string JsonObject::text(const char* key) const
{
    const auto found = value_->find(key);
    if (found == value_->end()) return {};
    if (!found->is_string()) {
        fault(fmt::format("{} is not a text", key));
        return {};
    }
    return found->get<std::string>();
}

void JsonObject::flag(const char* key) const
{
    const auto found = value_->find(key);
    if (found != value_->end() && !found->is_boolean()) fault(fmt::format("{} is neither true nor false", key));
}

std::string plainName(std::string_view name)
{
    constexpr std::size_t kMost = 200;
    std::string plain(name.substr(0, kMost));
    if (name.size() > kMost) { // do not cut through a UTF-8 sequence
        while (!plain.empty() && (static_cast<unsigned char>(name[plain.size()]) & 0xC0) == 0x80) plain.pop_back();
    }
    for (char& c : plain) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
    }
    return plain;
}

} // namespace lightloom
