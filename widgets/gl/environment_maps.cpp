// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/environment_maps.h"
#include "shaders/common.h"
#include <QElapsedTimer>
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

namespace lightloom {

namespace {

/// Axis and up of each face, as OpenGL lays cube maps out.
struct Face {
    glm::vec3 axis, up;
};
const Face kFaces[] = {{{1, 0, 0}, {0, -1, 0}},  {{-1, 0, 0}, {0, -1, 0}}, {{0, 1, 0}, {0, 0, 1}},
                       {{0, -1, 0}, {0, 0, -1}}, {{0, 0, 1}, {0, -1, 0}},  {{0, 0, -1}, {0, -1, 0}}};

/// A metal smooth enough that a map shows more than a few virtual lights do.
bool mirrors(const Material& m) { return m.metallic >= 0.5f && m.roughness <= shader::kMirrorsBelow; }

Bounds boundsOf(const Scene& scene, const Instance& instance)
{
    const float far = std::numeric_limits<float>::max();
    Bounds bounds{glm::vec3(far), glm::vec3(-far)};
    for (const glm::vec3 p : scene.meshes[static_cast<std::size_t>(instance.mesh)].positions) {
        const glm::vec3 at(instance.toWorld * glm::vec4(p, 1.0f));
        bounds.low = glm::min(bounds.low, at);
        bounds.high = glm::max(bounds.high, at);
    }
    return bounds;
}

} // namespace

Result<EnvironmentMaps> EnvironmentMaps::make(Gl& gl, const ShaderLibrary& shaders)
{
    Result<GlProgram> program = shaders.link(gl, "fullscreen.vert", "pass_environment.frag");
    if (!program) return program.error();
    Result<GBuffer> buffers = GBuffer::make(gl, glm::ivec2(kSide));
    if (!buffers) return buffers.error();
    return EnvironmentMaps(gl, std::move(*program), std::move(*buffers));
}

GlTexture EnvironmentMaps::makeCube() const
{
    GlTexture cube(*gl_);
    gl_->glActiveTexture(GL_TEXTURE0);
    gl_->glBindTexture(GL_TEXTURE_CUBE_MAP, cube.id());
    for (GLenum face = 0; face < 6; ++face) {
        gl_->glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, 0, GL_RGBA32F, kSide, kSide, 0, GL_RGBA, GL_FLOAT,
                          nullptr);
    }
    gl_->glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl_->glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
        gl_->glTexParameteri(GL_TEXTURE_CUBE_MAP, wrap, GL_CLAMP_TO_EDGE);
    }
    gl_->glGenerateMipmap(GL_TEXTURE_CUBE_MAP);
    return cube;
}

void EnvironmentMaps::setScene(const DrawData& data)
{
    const Scene& scene = *data.scene;
    diagonal_ = scene.bounds.diagonal();
    maps_.clear();
    next_ = 0;
    ofInstances_.clear();
    std::vector<std::pair<float, int>> found; // size, instance
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const int material = scene.meshes[static_cast<std::size_t>(scene.instances[i].mesh)].material;
        if (!mirrors(scene.materials[static_cast<std::size_t>(material)])) continue;
        found.emplace_back(-boundsOf(scene, scene.instances[i]).diagonal(), static_cast<int>(i));
    }
    std::ranges::sort(found);
    if (found.size() > static_cast<std::size_t>(kMost)) found.resize(kMost);
    for (const auto& [size, instance] : found) {
        Map map;
        map.instance = instance;
        map.centre = boundsOf(scene, scene.instances[static_cast<std::size_t>(instance)]).centre();
        map.drawn = makeCube();
        map.shown = makeCube();
        maps_.push_back(std::move(map));
    }
    if (!maps_.empty()) ofInstances_.assign(scene.instances.size(), 0);
}

bool EnvironmentMaps::draw(double budgetMs, const DrawFace& drawFace)
{
    if (isComplete()) return true;
    QElapsedTimer clock;
    clock.start();
    const glm::mat4 projection = glm::perspective(glm::radians(90.0f), 1.0f, 1e-4f * diagonal_, 2.0f * diagonal_);
    do {
        Map& map = maps_[static_cast<std::size_t>(next_ / 6)];
        const Face& face = kFaces[next_ % 6];
        drawFace(buffers_, glm::lookAt(map.centre, map.centre + face.axis, face.up), projection, map.centre,
                 map.instance);
        keepFace(map, next_ % 6);
        if (++next_ % 6 == 0) finish(map);
        gl_->glFinish(); // else the clock would measure nothing
    } while (!isComplete() && static_cast<double>(clock.nsecsElapsed()) * 1e-6 < budgetMs);
    return isComplete();
}

void EnvironmentMaps::keepFace(const Map& map, int face)
{
    gl_->glBindFramebuffer(GL_READ_FRAMEBUFFER, buffers_.lighting.id());
    gl_->glReadBuffer(GL_COLOR_ATTACHMENT0);
    gl_->glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target_.id());
    gl_->glFramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0,
                                GL_TEXTURE_CUBE_MAP_POSITIVE_X + static_cast<GLenum>(face), map.drawn.id(), 0);
    gl_->glBlitFramebuffer(0, 0, kSide, kSide, 0, 0, kSide, kSide, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void EnvironmentMaps::finish(Map& map)
{
    gl_->glActiveTexture(GL_TEXTURE0);
    gl_->glBindTexture(GL_TEXTURE_CUBE_MAP, map.drawn.id());
    gl_->glGenerateMipmap(GL_TEXTURE_CUBE_MAP);
    std::swap(map.drawn, map.shown);
    map.isWhole = true;
    ofInstances_[static_cast<std::size_t>(map.instance)] = 1 + static_cast<int>(&map - maps_.data());
}

void EnvironmentMaps::add(const GBuffer& buffers, glm::vec3 eye) const
{
    for (std::size_t i = 0; i < maps_.size(); ++i) {
        if (!maps_[i].isWhole) continue;
        program_.use();
        buffers.bind(program_);
        program_.setTexture("gEmission", 3, GL_TEXTURE_2D, buffers.emission.id());
        program_.setTexture("environment", 4, GL_TEXTURE_CUBE_MAP, maps_[i].shown.id());
        program_.set("which", static_cast<float>(i + 1));
        program_.set("side", static_cast<float>(kSide));
        program_.set("eye", eye);
        drawFullscreen(*gl_);
    }
}

} // namespace lightloom
