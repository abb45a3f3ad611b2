// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/shadow_maps.h"
#include "core/field/solver.h"
#include "shaders/common.h"
#include <QElapsedTimer>
#include <algorithm>
#include <cmath>
#include <limits>

namespace lightloom {

namespace {

constexpr GLuint kLampBlock = 0;    ///< uniform buffer binding
constexpr float kNearShare = 1e-4f; ///< near plane, of the lamp's reach

/// Clip coordinates (k s, k t, depth, m) of a point seen from `eye`, where s, t and m are its parts along three axes.
glm::mat4 perspective(glm::vec3 eye, glm::vec3 s, glm::vec3 t, glm::vec3 m, float k, float reach)
{
    const float low = kNearShare * reach, a = (reach + low) / (reach - low), b = -2.0f * reach * low / (reach - low);
    const glm::vec4 rows[4] = {k * glm::vec4(s, -glm::dot(s, eye)), k * glm::vec4(t, -glm::dot(t, eye)),
                               a * glm::vec4(m, -glm::dot(m, eye)) + glm::vec4(0.0f, 0.0f, 0.0f, b),
                               glm::vec4(m, -glm::dot(m, eye))};
    return glm::transpose(glm::mat4(rows[0], rows[1], rows[2], rows[3]));
}

void axesAround(glm::vec3 m, glm::vec3& s, glm::vec3& t)
{
    const glm::vec3 other = std::abs(m.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
    s = glm::normalize(glm::cross(other, m));
    t = glm::cross(m, s);
}

float cubeScaleOf(int side) { return (static_cast<float>(side) - 2.0f) / static_cast<float>(side); }

float farthest(const Bounds& bounds, glm::vec3 p)
{
    const glm::vec3 away = glm::max(glm::abs(bounds.low - p), glm::abs(bounds.high - p));
    return 1.01f * glm::length(away) + 1e-6f;
}

} // namespace

ShadowMaps::ShadowMaps(Gl& gl) : gl_(gl), block_(gl) {}

void ShadowMaps::addCube(const PreviewLight& light, float reach, SampleLight& out)
{
    // s, t, m of the faces +X -X +Y -Y +Z -Z, as cubePlace in mode_direct.frag has them
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const glm::vec3 faces[6][3] = {{-z, -y, x}, {z, -y, -x}, {x, z, y}, {x, -z, -y}, {x, -y, z}, {-x, -y, -z}};
    out.shadow = glm::vec4(static_cast<float>(cubeLayers_), 1.0f, 0.0f, 1.0f / reach);
    for (const auto& face : faces) {
        const int index = cubeLayers_++;
        // the half space behind a patch gets no light: a face wholly in it stays empty
        if (light.kind == shader::kLampSurface && glm::dot(face[2], light.travel) < -0.82f) continue;
        const float k = cubeScaleOf(cubeSide_);
        layers_.push_back({true, index, perspective(light.position, face[0], face[1], face[2], k, reach),
                           glm::vec4(light.position, 1.0f), glm::vec2(0.0f, 1.0f / reach), false});
    }
    out.texel.x = 2.0f / static_cast<float>(cubeSide_);
}

void ShadowMaps::addSpot(const PreviewLight& light, float reach, SampleLight& out)
{
    const float spread = std::tan(std::acos(light.cosOuter) + 0.02f);
    glm::vec3 s, t;
    axesAround(light.travel, s, t);
    const auto index = static_cast<int>(matrices_.size());
    matrices_.push_back(perspective(light.position, s, t, light.travel, 1.0f / spread, reach));
    out.shadow = glm::vec4(static_cast<float>(index), 0.0f, 0.0f, 1.0f / reach);
    out.texel = glm::vec4(2.0f * spread / static_cast<float>(flatSide_), static_cast<float>(index), 0.0f, 0.0f);
    layers_.push_back(
        {false, index, matrices_.back(), glm::vec4(light.position, 1.0f), glm::vec2(0.0f, 1.0f / reach), false});
}

void ShadowMaps::addSun(const PreviewLight& light, const Bounds& bounds, SampleLight& out)
{
    glm::vec3 s, t;
    axesAround(light.travel, s, t);
    glm::vec3 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 corner((i & 1) != 0 ? bounds.high.x : bounds.low.x, (i & 2) != 0 ? bounds.high.y : bounds.low.y,
                               (i & 4) != 0 ? bounds.high.z : bounds.low.z);
        const glm::vec3 seen(glm::dot(corner, s), glm::dot(corner, t), glm::dot(corner, light.travel));
        low = glm::min(low, seen);
        high = glm::max(high, seen);
    }
    const float margin = 0.01f * bounds.diagonal() + 1e-6f;
    low -= margin;
    high += margin;
    const glm::vec3 scale = 2.0f / (high - low), shift = -(high + low) / (high - low);
    const glm::mat4 matrix =
        glm::transpose(glm::mat4(glm::vec4(s * scale.x, shift.x), glm::vec4(t * scale.y, shift.y),
                                 glm::vec4(light.travel * scale.z, shift.z), glm::vec4(0.0f, 0.0f, 0.0f, 1.0f)));
    const auto index = static_cast<int>(matrices_.size());
    matrices_.push_back(matrix);
    const glm::vec2 range(low.z, 1.0f / (high.z - low.z));
    out.shadow = glm::vec4(static_cast<float>(index), 0.0f, range.x, range.y);
    const float texel = glm::max(high.x - low.x, high.y - low.y) / static_cast<float>(flatSide_);
    out.texel = glm::vec4(texel, static_cast<float>(index), 0.0f, 0.0f);
    layers_.push_back({false, index, matrix, glm::vec4(light.travel, 0.0f), range, false});
}

void ShadowMaps::plan(const DrawData& data)
{
    lights_ = data.lights;
    samples_.clear();
    matrices_.clear();
    layers_.clear();
    cubeLayers_ = 0;
    const auto cubes = 6 * std::ranges::count_if(lights_, &PreviewLight::inCube);
    cubeSide_ = cubes <= 64 ? 512 : 256;
    flatSide_ = 1024;
    for (const PreviewLight& light : lights_) {
        SampleLight out{glm::vec4(light.position, static_cast<float>(light.kind)),
                        glm::vec4(light.travel, light.cosInner),
                        glm::vec4(light.colour, light.kind == shader::kLampSurface ? light.area : light.cosOuter),
                        glm::vec4(-1.0f), glm::vec4(0.0f)};
        const float reach = farthest(data.scene->bounds, light.position);
        if (light.inCube) {
            addCube(light, reach, out);
        } else if (light.kind == shader::kLampSun) {
            addSun(light, data.scene->bounds, out);
        } else {
            addSpot(light, reach, out);
        }
        samples_.push_back(out);
    }
}

Result<Done> ShadowMaps::allocate()
{
    const auto make = [this](int side, int layers) {
        GlTexture texture(gl_);
        gl_.glActiveTexture(GL_TEXTURE0);
        gl_.glBindTexture(GL_TEXTURE_2D_ARRAY, texture.id());
        gl_.glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT24, side, side, std::max(layers, 1), 0,
                         GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
        gl_.glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        gl_.glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        gl_.glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        gl_.glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        gl_.glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
        gl_.glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
        return texture;
    };
    flat_ = make(flatSide_, static_cast<int>(matrices_.size()));
    cube_ = make(cubeSide_, cubeLayers_);
    target_ = GlFramebuffer(gl_);
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
    gl_.glDrawBuffer(GL_NONE);
    gl_.glReadBuffer(GL_NONE);
    gl_.glDepthMask(GL_TRUE);
    // undrawn layers shade nothing
    for (const auto& [texture, count] :
         {std::pair(flat_.id(), static_cast<int>(matrices_.size())), std::pair(cube_.id(), cubeLayers_)}) {
        for (int i = 0; i < count; ++i) {
            gl_.glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, texture, 0, i);
            if (gl_.glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
                return Error{Error::Kind::unsupported, "OpenGL refuses shadow maps; a newer graphics driver may help"};
            }
            gl_.glClearDepth(1.0);
            gl_.glClear(GL_DEPTH_BUFFER_BIT);
        }
    }
    return Done{};
}

Result<Done> ShadowMaps::setScene(const DrawData& data)
{
    plan(data);
    undrawn_ = layers_.size();
    const Result<Done> allocated = allocate();
    if (!allocated) return allocated.error();
    setMix({});
    return Done{};
}

Result<Done> ShadowMaps::setLamps(const DrawData& data)
{
    const std::vector<Layer> before = std::move(layers_);
    const std::size_t flat = matrices_.size();
    const int cubes = cubeLayers_, side = cubeSide_;
    plan(data);
    if (matrices_.size() != flat || cubeLayers_ != cubes || cubeSide_ != side) return setScene(data);
    undrawn_ = 0;
    for (Layer& layer : layers_) {
        const auto isSame = [&](const Layer& old) {
            return old.isDrawn && old.inCube == layer.inCube && old.index == layer.index && old.lamp == layer.lamp &&
                   old.range == layer.range && old.viewProjection == layer.viewProjection;
        };
        layer.isDrawn = std::ranges::any_of(before, isSame);
        undrawn_ += layer.isDrawn ? 0 : 1;
    }
    setMix({});
    return Done{};
}

bool ShadowMaps::draw(const SceneBuffers& scene, const GlProgram& shadow, double budgetMs)
{
    if (isComplete()) return true;
    QElapsedTimer clock;
    clock.start();
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
    gl_.glEnable(GL_DEPTH_TEST);
    gl_.glDepthFunc(GL_LESS);
    gl_.glDepthMask(GL_TRUE);
    gl_.glDisable(GL_BLEND);
    shadow.use();
    for (Layer& layer : layers_) {
        if (layer.isDrawn) continue;
        layer.isDrawn = true;
        --undrawn_;
        const int side = layer.inCube ? cubeSide_ : flatSide_;
        gl_.glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, layer.inCube ? cube_.id() : flat_.id(), 0,
                                      layer.index);
        gl_.glViewport(0, 0, side, side);
        gl_.glClear(GL_DEPTH_BUFFER_BIT);
        shadow.set("viewProjection", layer.viewProjection);
        shadow.set("lamp", layer.lamp);
        shadow.set("range", layer.range);
        scene.draw(shadow, false, 1.0f);
        ++layersDrawn_;
        gl_.glFinish(); // else the budget would measure how fast commands are queued
        if (static_cast<double>(clock.nsecsElapsed()) >= budgetMs * 1e6) break;
    }
    return isComplete();
}

void ShadowMaps::setMix(const Mix& mix)
{
    std::vector<glm::vec4> block;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        const SampleLight& s = samples_[i];
        const glm::vec4 colour(glm::vec3(s.colour.x, s.colour.y, s.colour.z) * gainOf(mix, lights_[i].group),
                               s.colour.w);
        block.insert(block.end(), {s.position, s.travel, colour, s.shadow, s.texel});
    }
    block.resize(5 * shader::kMostSampleLights, glm::vec4(0.0f));
    for (const glm::mat4& m : matrices_) block.insert(block.end(), {m[0], m[1], m[2], m[3]});
    block.resize(5 * shader::kMostSampleLights + 4 * shader::kMostLamps, glm::vec4(0.0f));
    gl_.glBindBuffer(GL_UNIFORM_BUFFER, block_.id());
    gl_.glBufferData(GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(block.size() * sizeof(glm::vec4)), block.data(),
                     GL_DYNAMIC_DRAW);
}

void ShadowMaps::bind(const GlProgram& direct, int unit) const
{
    direct.setTexture("flatShadows", unit, GL_TEXTURE_2D_ARRAY, flat_.id());
    direct.setTexture("cubeShadows", unit + 1, GL_TEXTURE_2D_ARRAY, cube_.id());
    direct.set("cubeScale", cubeScaleOf(cubeSide_));
    direct.bindBlock("Lamps", kLampBlock);
    gl_.glBindBufferBase(GL_UNIFORM_BUFFER, kLampBlock, block_.id());
}

} // namespace lightloom
