// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/scene_buffers.h"
#include "widgets/gl/texture_upload.h"
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fmt/format.h>

namespace lightloom {

namespace {

const void* offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

void attribute(Gl& gl, GLuint location, GLint parts, std::size_t at)
{
    gl.glEnableVertexAttribArray(location);
    gl.glVertexAttribPointer(location, parts, GL_FLOAT, GL_FALSE, sizeof(DrawVertex), offset(at));
}

/// KHR_texture_transform as a matrix: scale, turn, shift (the same as core's sampleTexture).
glm::mat3 uvMatrix(const Texture& t)
{
    const float c = std::cos(t.rotation), s = std::sin(t.rotation);
    return {glm::vec3(c * t.scale.x, -s * t.scale.x, 0.0f), glm::vec3(s * t.scale.y, c * t.scale.y, 0.0f),
            glm::vec3(t.offset.x, t.offset.y, 1.0f)};
}

/// Seen through rather than seen; the rest of such a surface is not drawn.
bool isClear(const Material& m) { return (1.0f - m.metallic) * m.transmission > 0.5f; }

} // namespace

SceneBuffers::SceneBuffers(Gl& gl, std::shared_ptr<const DrawData> data)
    : gl_(gl), data_(std::move(data)), array_(gl), vertices_(gl), indices_(gl)
{
    gl_.glBindVertexArray(array_.id());
    gl_.glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
    const std::size_t vertexBytes = data_->vertices.size() * sizeof(DrawVertex);
    const std::size_t indexBytes = data_->indices.size() * sizeof(std::uint32_t);
    gl_.glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertexBytes), data_->vertices.all().data(),
                     GL_STATIC_DRAW);
    gl_.glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
    gl_.glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indexBytes), data_->indices.all().data(),
                     GL_STATIC_DRAW);
    attribute(gl_, 0, 3, offsetof(DrawVertex, position));
    attribute(gl_, 1, 3, offsetof(DrawVertex, normal));
    attribute(gl_, 2, 4, offsetof(DrawVertex, uv));
    attribute(gl_, 3, 4, offsetof(DrawVertex, colour));
    gl_.glBindVertexArray(0);
    bytes_ = vertexBytes + indexBytes;
    uploadTextures();
}

GLuint SceneBuffers::textureOf(const Texture& texture, bool srgb)
{
    if (!texture.isSet()) return white_.id();
    const std::string use = fmt::format("{} {} {} {} {}", texture.image, srgb, static_cast<int>(texture.wrapS),
                                        static_cast<int>(texture.wrapT), texture.smooth);
    if (const auto known = byUse_.find(use); known != byUse_.end()) return known->second;
    const Image& image = data_->scene->images[static_cast<std::size_t>(texture.image)];
    textures_.push_back(uploadImage(gl_, image, texture, srgb));
    bytes_ += image.rgba.size() * 4 / 3;
    return byUse_[use] = textures_.back().id();
}

void SceneBuffers::uploadTextures()
{
    white_ = uploadColour(gl_, glm::u8vec4(255));
    for (const Material& m : data_->scene->materials) {
        materials_.push_back({textureOf(m.baseColorTexture, true), textureOf(m.metallicRoughnessTexture, false),
                              textureOf(m.normalTexture, false), textureOf(m.emissionTexture, true)});
    }
}

void SceneBuffers::setMaterial(const GlProgram& program, std::size_t index, bool surfaces, float emissionScale) const
{
    const Material& m = data_->scene->materials[index];
    const MaterialTextures& textures = materials_[index];
    program.set("baseColour", m.baseColor);
    program.set("alphaCutoff", m.alpha == Material::Alpha::mask ? m.alphaCutoff : -1.0f);
    program.set("baseUv", uvMatrix(m.baseColorTexture));
    program.set("uvSets", glm::vec4(m.baseColorTexture.uvSet, m.metallicRoughnessTexture.uvSet, m.normalTexture.uvSet,
                                    m.emissionTexture.uvSet));
    program.setTexture("baseTexture", 0, GL_TEXTURE_2D, textures.base);
    if (!surfaces) return;
    program.set("metallicRoughness", glm::vec2(m.metallic, m.roughness));
    program.set("emission", m.emission / emissionScale);
    program.set("normalScale", m.normalTexture.isSet() ? m.normalScale : 0.0f);
    program.set("materialUv", uvMatrix(m.metallicRoughnessTexture));
    program.set("normalUv", uvMatrix(m.normalTexture));
    program.set("emissionUv", uvMatrix(m.emissionTexture));
    program.setTexture("materialTexture", 1, GL_TEXTURE_2D, textures.material);
    program.setTexture("normalTexture", 2, GL_TEXTURE_2D, textures.normal);
    program.setTexture("emissionTexture", 3, GL_TEXTURE_2D, textures.emission);
    if (m.doubleSided) {
        gl_.glDisable(GL_CULL_FACE);
    } else {
        gl_.glEnable(GL_CULL_FACE);
        gl_.glCullFace(GL_BACK);
    }
}

void SceneBuffers::placeOne(const GlProgram& program, const Instance& instance) const
{
    const glm::mat4 toWorld = place_ * instance.toWorld;
    program.set("toWorld", toWorld);
    // the inverse transpose up to scale, without dividing by a determinant that may be tiny
    const glm::mat3 m(toWorld);
    const glm::mat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    program.set("normalToWorld", instance.isMirrored() ? -cofactors : cofactors);
}

void SceneBuffers::drawMesh(std::size_t mesh) const
{
    const DrawData::Range& range = data_->meshes[mesh];
    gl_.glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(range.count), GL_UNSIGNED_INT,
                       offset(range.first * sizeof(std::uint32_t)));
}

void SceneBuffers::draw(const GlProgram& program, bool surfaces, float emissionScale,
                        const std::vector<int>& environments, int without) const
{
    gl_.glBindVertexArray(array_.id());
    gl_.glDisable(GL_CULL_FACE);
    const Scene& scene = *data_->scene;
    int bound = -1;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (static_cast<int>(i) == without) continue;
        const Instance& instance = scene.instances[i];
        const auto mesh = static_cast<std::size_t>(instance.mesh);
        const int material = scene.meshes[mesh].material;
        if (surfaces && isClear(scene.materials[static_cast<std::size_t>(material)])) continue;
        if (material != bound) {
            setMaterial(program, static_cast<std::size_t>(material), surfaces, emissionScale);
            bound = material;
        }
        gl_.glFrontFace(instance.isMirrored() ? GL_CW : GL_CCW);
        if (surfaces) {
            program.set("environment", environments.empty() ? 0.0f : static_cast<float>(environments[i]));
            placeOne(program, instance);
        } else {
            program.set("toWorld", place_ * instance.toWorld);
        }
        drawMesh(mesh);
    }
    gl_.glDisable(GL_CULL_FACE);
    gl_.glFrontFace(GL_CCW);
    gl_.glBindVertexArray(0);
}

void SceneBuffers::drawGlass(const GlProgram& program) const
{
    gl_.glBindVertexArray(array_.id());
    gl_.glDisable(GL_CULL_FACE);
    const Scene& scene = *data_->scene;
    for (const Instance& instance : scene.instances) {
        const auto mesh = static_cast<std::size_t>(instance.mesh);
        const auto material = static_cast<std::size_t>(scene.meshes[mesh].material);
        const Material& m = scene.materials[material];
        if (!isClear(m)) continue;
        setMaterial(program, material, false, 1.0f);
        program.set("glass", glm::vec3((1.0f - m.metallic) * m.transmission, m.ior, m.thickness > 0.0f ? 0.0f : 1.0f));
        placeOne(program, instance);
        drawMesh(mesh);
    }
    gl_.glBindVertexArray(0);
}

bool SceneBuffers::hasGlass() const
{
    return std::ranges::any_of(data_->scene->materials, [](const Material& m) { return isClear(m); });
}

} // namespace lightloom
