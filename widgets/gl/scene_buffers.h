// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/draw_data.h"
#include "widgets/gl/gl_objects.h"
#include <map>

namespace lightloom {

/// A scene's triangles and textures on the GPU. Lives with the context current.
class SceneBuffers {
public:
    SceneBuffers(Gl& gl, std::shared_ptr<const DrawData> data);

    /// Draws every instance with `program` (scene.vert or shadow.vert), which is in use and has its view set.
    /// `surfaces`: materials with all textures and back faces culled where the material is single-sided; otherwise
    /// only what an alpha test needs, and both faces. Emission is divided by `emissionScale`. `environments`, by
    /// instance, as EnvironmentMaps has them, or empty; instance `without` (-1: none) is left out.
    void draw(const GlProgram& program, bool surfaces, float emissionScale, const std::vector<int>& environments = {},
              int without = -1) const;
    /// Where the whole of it stands, from now on: no mirroring. For what is not part of the scene that others know.
    void setPlace(const glm::mat4& place) { place_ = place; }
    /// Meshes of mostly clear materials, which `draw` leaves out with `surfaces`: both faces, for glass.frag.
    void drawGlass(const GlProgram& program) const;
    [[nodiscard]] bool hasGlass() const;

    [[nodiscard]] const DrawData& data() const { return *data_; }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }

private:
    void uploadTextures();
    GLuint textureOf(const Texture& texture, bool srgb);
    void setMaterial(const GlProgram& program, std::size_t index, bool surfaces, float emissionScale) const;
    void placeOne(const GlProgram& program, const Instance& instance) const; ///< with the normals' way to the world
    void drawMesh(std::size_t mesh) const;

    struct MaterialTextures {
        GLuint base = 0, material = 0, normal = 0, emission = 0;
    };
    Gl& gl_;
    std::shared_ptr<const DrawData> data_;
    GlVertexArray array_;
    GlBuffer vertices_, indices_;
    GlTexture white_;
    std::vector<GlTexture> textures_;
    std::map<std::string, GLuint> byUse_; ///< one texture per image, colour space and sampler
    std::vector<MaterialTextures> materials_;
    glm::mat4 place_{1.0f};
    std::size_t bytes_ = 0;
};

} // namespace lightloom
