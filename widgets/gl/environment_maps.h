// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/gbuffer.h"
#include "widgets/gl/scene_buffers.h"
#include "widgets/gl/shader_library.h"
#include <functional>

namespace lightloom {

/// Cube maps of what smooth metals see around them, one for each of the few largest (the 2007 paper's figure 12: an
/// environment-mapped metal in an octree-lit scene). A map is rendered from the middle of its object, without it, by
/// whatever lights the frame; a few faces a frame, so that no frame waits for them. An old map is shown until the new
/// one is whole. The context is current in all calls.
class EnvironmentMaps {
public:
    static constexpr int kMost = 4;   ///< objects with a map; further ones show their virtual lights alone
    static constexpr int kSide = 128; ///< pixels of a face

    /// Draws one face: surfaces of all instances but `without`, lit, as radiance (cd/m2) into `buffers.light`.
    using DrawFace = std::function<void(const GBuffer& buffers, const glm::mat4& view, const glm::mat4& projection,
                                        glm::vec3 eye, int without)>;

    /// Error: the driver refuses the buffers, or a shader does not compile here.
    [[nodiscard]] static Result<EnvironmentMaps> make(Gl& gl, const ShaderLibrary& shaders);

    void setScene(const DrawData& data); ///< picks the objects; earlier maps are gone
    /// Light is other: all faces are to be drawn again.
    void forget() { next_ = 0; }
    /// Faces that are to be drawn, for about `budgetMs`, at least one. True when none is left.
    bool draw(double budgetMs, const DrawFace& drawFace);
    [[nodiscard]] bool isComplete() const { return next_ == 6 * static_cast<int>(maps_.size()); }

    /// By instance: 1 + the number of its map where that is whole, else 0. Empty: no object has one.
    [[nodiscard]] const std::vector<int>& ofInstances() const { return ofInstances_; }
    /// Adds what metals mirror of their maps to the bound target (blending adds, an empty vertex array is bound).
    void add(const GBuffer& buffers, glm::vec3 eye) const;
    [[nodiscard]] int count() const { return static_cast<int>(maps_.size()); }

private:
    struct Map {
        int instance = 0;
        glm::vec3 centre{0.0f};
        GlTexture drawn, shown; ///< cube maps: the one that faces go into, and the last whole one
        bool isWhole = false;
    };
    EnvironmentMaps(Gl& gl, GlProgram program, GBuffer buffers)
        : gl_(&gl), program_(std::move(program)), buffers_(std::move(buffers)), target_(gl)
    {
    }
    [[nodiscard]] GlTexture makeCube() const;
    void keepFace(const Map& map, int face);
    void finish(Map& map);

    Gl* gl_;
    GlProgram program_;
    GBuffer buffers_;
    GlFramebuffer target_;
    std::vector<Map> maps_;
    std::vector<int> ofInstances_;
    float diagonal_ = 1.0f; ///< of the scene
    int next_ = 0;          ///< face that is drawn next, 6 a map
};

} // namespace lightloom
