// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"

namespace lightloom {

/// The binary part of a glb as it grows: one view per array or image, each starting on 4 bytes.
class GlbBuffer {
public:
    struct View {
        std::size_t offset = 0, length = 0;
        int target = 0; ///< GL_ARRAY_BUFFER, GL_ELEMENT_ARRAY_BUFFER, or 0 for an image
    };
    struct Accessor {
        int view = 0, componentType = 0;
        std::size_t count = 0;
        const char* type = "";
        bool hasRange = false; ///< positions must tell their bounds
        glm::vec3 low{0.0f}, high{0.0f};
    };

    /// Each gives the number of the accessor, or of the view for `addBlob`.
    int addPositions(const std::vector<glm::vec3>& values);
    int addFloats(const std::vector<glm::vec2>& values);
    int addFloats(const std::vector<glm::vec3>& values);
    int addFloats(const std::vector<glm::vec4>& values);
    int addTriangles(const std::vector<glm::uvec3>& triangles, std::size_t vertexCount);
    int addBlob(const std::vector<std::uint8_t>& bytes);

    [[nodiscard]] const std::vector<View>& views() const { return views_; }
    [[nodiscard]] const std::vector<Accessor>& accessors() const { return accessors_; }
    [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

private:
    int addView(const void* data, std::size_t length, int target);
    int addAccessor(int view, int componentType, std::size_t count, const char* type);

    std::vector<std::uint8_t> bytes_;
    std::vector<View> views_;
    std::vector<Accessor> accessors_;
};

} // namespace lightloom
