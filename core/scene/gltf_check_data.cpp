// SPDX-License-Identifier: Apache-2.0
// Byte ranges: buffer views, accessors, sparse accessors, and the primitives that read through them.
#include "core/scene/gltf_check_parts.h"
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::detail {
namespace {

/// Longest offset or length: whole files are shorter.
constexpr std::uint64_t kMostOffset = (std::uint64_t{1} << 31) - 1;

struct ElementType {
    std::uint64_t columns = 0, rows = 0; ///< scalars and vectors have one column
};

ElementType elementType(const std::string& name)
{
    if (name == "SCALAR") return {1, 1};
    for (std::uint64_t n = 2; n <= 4; ++n) {
        if (name == fmt::format("VEC{}", n)) return {1, n};
        if (name == fmt::format("MAT{}", n)) return {n, n};
    }
    return {};
}

/// Bytes of one element; columns of matrices begin at multiples of 4.
std::uint64_t elementBytes(ElementType type, std::uint64_t component)
{
    const std::uint64_t column = type.rows * component;
    return type.columns == 1 ? column : type.columns * ((column + 3) / 4 * 4);
}

/// The view at `object[key]` must hold `count` elements of `size` bytes from `object.byteOffset` on.
void checkRange(const GltfFile& file, const JsonObject& object, std::uint64_t count, std::uint64_t size, bool mayStride)
{
    const auto viewIndex = object.index("bufferView", "bufferViews", file.size("bufferViews"));
    const std::uint64_t offset = object.whole("byteOffset", kMostOffset).value_or(0);
    if (!viewIndex || file.faults.any()) return;
    const JsonObject view = file.entry("bufferViews", *viewIndex);
    const std::uint64_t length = view.whole("byteLength", kMostOffset).value_or(0);
    std::uint64_t stride = size;
    if (const auto asked = view.whole("byteStride", 252); asked && mayStride) stride = *asked;
    if (stride < size) {
        object.fault(fmt::format("elements of {} bytes do not fit a byteStride of {}", size, stride));
    }
    const std::uint64_t needed = offset + (count - 1) * stride + size; // below 2^31 + 1e8 * 252 + 64
    if (needed > length) {
        object.fault(fmt::format("{} elements reach to byte {} of bufferViews[{}], which has {}", count, needed,
                                 *viewIndex, length));
    }
}

void checkSparseIndices(const GltfFile& file, const JsonObject& indices, std::uint64_t sparseCount,
                        std::uint64_t elements, std::uint64_t bytesEach)
{
    const auto view = indices.index("bufferView", "bufferViews", file.size("bufferViews"));
    if (!view || file.faults.any()) return;
    const std::uint8_t* at = viewBytes(file, *view).data() + indices.whole("byteOffset", kMostOffset).value_or(0);
    for (std::uint64_t i = 0; i < sparseCount; ++i, at += bytesEach) {
        std::uint32_t index = 0; // little-endian, as the machine is
        std::memcpy(&index, at, bytesEach);
        if (index >= elements) {
            indices.fault(fmt::format("entry {} names element {} of {}", i, index, elements));
            return;
        }
    }
}

void checkSparse(const GltfFile& file, const JsonObject& accessor, std::uint64_t elements, std::uint64_t size)
{
    const JsonObject sparse = accessor.object("sparse");
    const auto count = sparse.needWhole("count", elements);
    const JsonObject indices = sparse.object("indices"), values = sparse.object("values");
    const auto type = indices.needWhole("componentType", 6000);
    if (type && *type != 5121 && *type != 5123 && *type != 5125) {
        indices.fault(fmt::format("componentType {} is not one of 5121, 5123, 5125", *type));
    }
    for (const JsonObject& part : {indices, values}) {
        if (!part.has("bufferView")) part.fault("bufferView is missing");
    }
    if (file.faults.any()) return;
    if (*count == 0) {
        sparse.fault("count is 0");
        return;
    }
    checkRange(file, indices, *count, componentBytes(*type), false);
    checkRange(file, values, *count, size, false);
    if (!file.faults.any()) checkSparseIndices(file, indices, *count, elements, componentBytes(*type));
}

void checkAccessor(const GltfFile& file, const JsonObject& accessor)
{
    const auto componentType = accessor.needWhole("componentType", 6000);
    const auto count = accessor.needWhole("count", file.limits.elements);
    const std::string typeName = accessor.text("type");
    const ElementType type = elementType(typeName);
    accessor.flag("normalized");
    if (type.rows == 0) accessor.fault(fmt::format("type \"{}\" is unknown", plainName(typeName)));
    if (componentType && componentBytes(*componentType) == 0) {
        accessor.fault(fmt::format("componentType {} is unknown", *componentType));
    }
    if (count && *count == 0) accessor.fault("count is 0");
    if (file.faults.any()) return;
    const std::uint64_t size = elementBytes(type, componentBytes(*componentType));
    checkRange(file, accessor, *count, size, true);
    if (accessor.has("sparse")) checkSparse(file, accessor, *count, size);
}

bool isOneOf(const std::string& type, std::initializer_list<const char*> names)
{
    for (const char* name : names) {
        if (type == name) return true;
    }
    return false;
}

/// What we read of an attribute; others ("_TEMPERATURE", "JOINTS_0") are not looked at.
void checkAttributeType(const JsonObject& primitive, const std::string& name, const Json& accessor)
{
    const std::string type = accessor.value("type", "");
    const auto component = accessor.value("componentType", 0);
    const bool fits = name == "POSITION" || name == "NORMAL"         ? type == "VEC3"
                      : name == "TANGENT"                            ? type == "VEC4"
                      : name == "TEXCOORD_0" || name == "TEXCOORD_1" ? type == "VEC2"
                      : name == "COLOR_0"                            ? isOneOf(type, {"VEC3", "VEC4"})
                                                                     : true;
    if (!fits) primitive.fault(fmt::format("{} is of type {}", name, plainName(type)));
    if (component == 5125) primitive.fault(fmt::format("{} is of 32-bit whole numbers", plainName(name)));
}

void checkPrimitive(const GltfFile& file, const JsonObject& primitive)
{
    const std::uint64_t accessors = file.size("accessors");
    static_cast<void>(primitive.whole("mode", 6));
    static_cast<void>(primitive.index("material", "materials", file.size("materials")));
    const JsonObject attributes = primitive.object("attributes");
    std::uint64_t vertices = 0;
    for (const auto& [name, unused] : attributes.value().items()) {
        const auto at = attributes.index(name.c_str(), "accessors", accessors);
        if (!at || file.faults.any()) return;
        const Json& accessor = file.root["accessors"][*at];
        const auto count = static_cast<std::uint64_t>(accessor.value("count", 0.0));
        if (vertices != 0 && count != vertices) {
            primitive.fault(fmt::format("{} has {} entries, other attributes {}", plainName(name), count, vertices));
        }
        vertices = count;
        checkAttributeType(primitive, name, accessor);
    }
    const auto indices = primitive.index("indices", "accessors", accessors);
    if (!indices || file.faults.any()) return;
    const JsonObject accessor = file.entry("accessors", *indices);
    const auto component = accessor.whole("componentType", 6000).value_or(0);
    if (accessor.text("type") != "SCALAR" || (component != 5121 && component != 5123 && component != 5125)) {
        primitive.fault("its indices are not unsigned whole numbers");
    }
    if (!accessor.has("bufferView")) primitive.fault("its indices have no bufferView");
}

} // namespace

std::uint64_t componentBytes(std::uint64_t componentType)
{
    switch (componentType) {
    case 5120: // BYTE
    case 5121: // UNSIGNED_BYTE
        return 1;
    case 5122: // SHORT
    case 5123: // UNSIGNED_SHORT
        return 2;
    case 5125: // UNSIGNED_INT
    case 5126: // FLOAT
        return 4;
    default:
        return 0;
    }
}

std::span<const std::uint8_t> viewBytes(const GltfFile& file, std::uint64_t index)
{
    const JsonObject view = file.entry("bufferViews", index);
    const auto buffer = view.whole("buffer", kMostOffset).value_or(0);
    return file.buffers.at(buffer).subspan(view.whole("byteOffset", kMostOffset).value_or(0),
                                           view.whole("byteLength", kMostOffset).value_or(0));
}

void checkBufferViews(const GltfFile& file)
{
    for (std::uint64_t i = 0; i < file.size("bufferViews"); ++i) {
        const JsonObject view = file.entry("bufferViews", i);
        if (!view.has("buffer")) view.fault("buffer is missing");
        const auto buffer = view.index("buffer", "buffers", file.buffers.size());
        const auto length = view.needWhole("byteLength", kMostOffset);
        const std::uint64_t offset = view.whole("byteOffset", kMostOffset).value_or(0);
        const auto stride = view.whole("byteStride", 252);
        if (file.faults.any()) return;
        if (*length == 0) view.fault("byteLength is 0");
        if (stride && (*stride < 4 || *stride % 4 != 0)) {
            view.fault(fmt::format("byteStride is {}; it must be a multiple of 4 in 4 .. 252", *stride));
        }
        const std::uint64_t size = file.buffers[*buffer].size();
        if (offset + *length > size) {
            view.fault(
                fmt::format("it reaches to byte {} of buffers[{}], which has {}", offset + *length, *buffer, size));
        }
    }
}

void checkAccessors(const GltfFile& file)
{
    for (std::uint64_t i = 0; i < file.size("accessors") && !file.faults.any(); ++i) {
        checkAccessor(file, file.entry("accessors", i));
    }
}

void checkMeshes(const GltfFile& file)
{
    for (std::uint64_t m = 0; m < file.size("meshes"); ++m) {
        const JsonObject mesh = file.entry("meshes", m);
        static_cast<void>(mesh.text("name"));
        std::int64_t number = 0;
        for (const Json& primitive : mesh.array("primitives", file.limits.entries)) {
            checkPrimitive(file, JsonObject(primitive, mesh.place() + ".primitives", number++, file.faults));
            if (file.faults.any()) return;
        }
    }
}

} // namespace lightloom::detail
