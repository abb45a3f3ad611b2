// SPDX-License-Identifier: Apache-2.0
#include "core/scene/glb_buffer.h"

namespace lightloom {
namespace {
constexpr int kVertexTarget = 34962, kIndexTarget = 34963;               // GL_ARRAY_BUFFER, GL_ELEMENT_ARRAY_BUFFER
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126; // GL's numbers again
} // namespace

int GlbBuffer::addView(const void* data, std::size_t length, int target)
{
    const View view{bytes_.size(), length, target};
    const auto* first = static_cast<const std::uint8_t*>(data);
    bytes_.insert(bytes_.end(), first, first + length);
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    views_.push_back(view);
    return static_cast<int>(views_.size()) - 1;
}

int GlbBuffer::addAccessor(int view, int componentType, std::size_t count, const char* type)
{
    Accessor accessor;
    accessor.view = view;
    accessor.componentType = componentType;
    accessor.count = count;
    accessor.type = type;
    accessors_.push_back(accessor);
    return static_cast<int>(accessors_.size()) - 1;
}

int GlbBuffer::addPositions(const std::vector<glm::vec3>& values)
{
    const int index = addFloats(values);
    Accessor& accessor = accessors_.back();
    accessor.hasRange = true;
    accessor.low = accessor.high = values.front();
    for (const glm::vec3 v : values) {
        accessor.low = glm::min(accessor.low, v);
        accessor.high = glm::max(accessor.high, v);
    }
    return index;
}

int GlbBuffer::addFloats(const std::vector<glm::vec2>& values)
{
    const int view = addView(values.data(), values.size() * sizeof(glm::vec2), kVertexTarget);
    return addAccessor(view, kFloat, values.size(), "VEC2");
}

int GlbBuffer::addFloats(const std::vector<glm::vec3>& values)
{
    const int view = addView(values.data(), values.size() * sizeof(glm::vec3), kVertexTarget);
    return addAccessor(view, kFloat, values.size(), "VEC3");
}

int GlbBuffer::addFloats(const std::vector<glm::vec4>& values)
{
    const int view = addView(values.data(), values.size() * sizeof(glm::vec4), kVertexTarget);
    return addAccessor(view, kFloat, values.size(), "VEC4");
}

int GlbBuffer::addTriangles(const std::vector<glm::uvec3>& triangles, std::size_t vertexCount)
{
    const std::size_t count = 3 * triangles.size();
    if (vertexCount > 65535) { // index 65535 itself is reserved
        const int view = addView(triangles.data(), triangles.size() * sizeof(glm::uvec3), kIndexTarget);
        return addAccessor(view, kUnsignedInt, count, "SCALAR");
    }
    std::vector<std::uint16_t> narrow;
    narrow.reserve(count);
    for (const glm::uvec3 t : triangles) {
        for (const unsigned v : {t.x, t.y, t.z}) narrow.push_back(static_cast<std::uint16_t>(v));
    }
    return addAccessor(addView(narrow.data(), 2 * count, kIndexTarget), kUnsignedShort, count, "SCALAR");
}

int GlbBuffer::addBlob(const std::vector<std::uint8_t>& bytes) { return addView(bytes.data(), bytes.size(), 0); }

} // namespace lightloom
