// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf_data.h"
#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <tiny_gltf.h>

namespace lightloom {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian and copied as they are");

template<class T>
T load(const std::uint8_t* at)
{
    T value; // accessors need not be aligned
    std::memcpy(&value, at, sizeof value);
    return value;
}

float loadComponent(const std::uint8_t* at, int type, bool isNormalized)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
        const auto v = static_cast<float>(load<std::int8_t>(at));
        return isNormalized ? std::max(v / 127.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
        const auto v = static_cast<float>(load<std::uint8_t>(at));
        return isNormalized ? v / 255.0f : v;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
        const auto v = static_cast<float>(load<std::int16_t>(at));
        return isNormalized ? std::max(v / 32767.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
        const auto v = static_cast<float>(load<std::uint16_t>(at));
        return isNormalized ? v / 65535.0f : v;
    }
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return load<float>(at);
    default: // checkGltf lets no other type through
        return std::numeric_limits<float>::quiet_NaN();
    }
}

std::uint32_t loadIndex(const std::uint8_t* at, int type)
{
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return load<std::uint8_t>(at);
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return load<std::uint16_t>(at);
    return load<std::uint32_t>(at);
}

std::size_t sizeOf(int componentType)
{
    return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(componentType)));
}

/// Calls `take(i, element)` with the number and the bytes of each sparse element.
template<class Take>
void forSparse(const tinygltf::Model& model, std::span<const std::span<const std::uint8_t>> buffers,
               const tinygltf::Accessor& accessor, std::size_t elementBytes, Take take)
{
    if (!accessor.sparse.isSparse) return;
    const auto bytesOf = [&](int view, int offset) {
        const tinygltf::BufferView& v = model.bufferViews[static_cast<std::size_t>(view)];
        return buffers[static_cast<std::size_t>(v.buffer)].data() + v.byteOffset + offset;
    };
    const auto& sparse = accessor.sparse;
    const std::uint8_t* index = bytesOf(sparse.indices.bufferView, sparse.indices.byteOffset);
    const std::uint8_t* value = bytesOf(sparse.values.bufferView, sparse.values.byteOffset);
    for (int i = 0; i < sparse.count; ++i) {
        take(loadIndex(index, sparse.indices.componentType), value);
        index += sizeOf(sparse.indices.componentType);
        value += elementBytes;
    }
}

const tinygltf::Value* lightloomValue(const tinygltf::Value& extras, const std::string& key)
{
    if (!extras.IsObject()) return nullptr;
    if (extras.Has("lightloom") && extras.Get("lightloom").Has(key)) return &extras.Get("lightloom").Get(key);
    const std::string flat = "lightloom." + key;
    return extras.Has(flat) ? &extras.Get(flat) : nullptr;
}

} // namespace

std::size_t GltfData::count(int accessor) const { return model_.accessors[static_cast<std::size_t>(accessor)].count; }

int GltfData::components(int accessor) const
{
    const int type = model_.accessors[static_cast<std::size_t>(accessor)].type;
    return tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type));
}

std::vector<float> GltfData::floats(int index) const
{
    const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
    const auto width = static_cast<std::size_t>(components(index));
    const std::size_t bytes = sizeOf(accessor.componentType);
    std::vector<float> out(accessor.count * width, 0.0f); // without a view: zeros, as glTF says
    const auto copy = [&](const std::uint8_t* from, std::size_t element) {
        for (std::size_t c = 0; c < width; ++c) {
            out[element * width + c] = loadComponent(from + c * bytes, accessor.componentType, accessor.normalized);
        }
    };
    if (accessor.bufferView >= 0) {
        const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
        const std::size_t stride = view.byteStride != 0 ? view.byteStride : width * bytes;
        const std::uint8_t* from =
            buffers_[static_cast<std::size_t>(view.buffer)].data() + view.byteOffset + accessor.byteOffset;
        for (std::size_t i = 0; i < accessor.count; ++i) copy(from + i * stride, i);
    }
    forSparse(model_, buffers_, accessor, width * bytes,
              [&](std::uint32_t element, const std::uint8_t* from) { copy(from, element); });
    return out;
}

std::vector<std::uint32_t> GltfData::indices(int index) const
{
    const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    const std::size_t bytes = sizeOf(accessor.componentType);
    const std::size_t stride = view.byteStride != 0 ? view.byteStride : bytes;
    const std::uint8_t* from =
        buffers_[static_cast<std::size_t>(view.buffer)].data() + view.byteOffset + accessor.byteOffset;
    std::vector<std::uint32_t> out(accessor.count);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = loadIndex(from + i * stride, accessor.componentType);
    forSparse(model_, buffers_, accessor, bytes, [&](std::uint32_t element, const std::uint8_t* value) {
        out[element] = loadIndex(value, accessor.componentType);
    });
    return out;
}

double gltfNumber(const tinygltf::Value& value, const char* key, double otherwise)
{
    if (!value.IsObject() || !value.Has(key) || !value.Get(key).IsNumber()) return otherwise;
    return value.Get(key).GetNumberAsDouble();
}

std::string lightloomText(const tinygltf::Value& extras, const std::string& key)
{
    const tinygltf::Value* value = lightloomValue(extras, key);
    return value != nullptr && value->IsString() ? value->Get<std::string>() : std::string();
}

double lightloomNumber(const tinygltf::Value& extras, const std::string& key)
{
    const tinygltf::Value* value = lightloomValue(extras, key);
    return value != nullptr && value->IsNumber() ? value->GetNumberAsDouble()
                                                 : std::numeric_limits<double>::quiet_NaN();
}

} // namespace lightloom
