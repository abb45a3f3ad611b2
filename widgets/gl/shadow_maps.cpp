// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/shadow_maps.h"
#include "core/base/units.h"
#include "shaders/common.h"
#include <QElapsedTimer>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
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

void axesAround(glm::vec3 m, const glm::mat3& turn, glm::vec3& s, glm::vec3& t)
{
    glm::vec3 other = glm::vec3(0.0f, 1.0f, 0.0f) * turn;
    if (std::abs(glm::dot(m, other)) >= 0.9f) other = glm::vec3(1.0f, 0.0f, 0.0f) * turn;
    s = glm::normalize(glm::cross(other, m));
    t = glm::cross(m, s);
}

/// Turn number `i` of a sequence that covers all of them evenly (the R3 sequence through Shoemake's quaternions).
glm::mat3 turnOf(int i)
{
    const auto part = [i](double step) { return static_cast<float>(std::fmod(0.5 + i * step, 1.0)); };
    const float u = part(0.8191725134), v = 2.0f * kPi * part(0.6710436067), w = 2.0f * kPi * part(0.5497004779);
    const float a = std::sqrt(1.0f - u), b = std::sqrt(u);
    return glm::mat3_cast(glm::quat(b * std::cos(w), a * std::sin(v), a * std::cos(v), b * std::sin(w)));
}

float cubeScaleOf(int side) { return (static_cast<float>(side) - 2.0f) / static_cast<float>(side); }

float farthest(const Bounds& bounds, glm::vec3 p)
{
    const glm::vec3 away = glm::max(glm::abs(bounds.low - p), glm::abs(bounds.high - p));
    return 1.01f * glm::length(away) + 1e-6f;
}

std::array<glm::vec3, 8> cornersOf(const Bounds& box)
{
    std::array<glm::vec3, 8> corners;
    for (std::size_t i = 0; i < corners.size(); ++i)
        corners[i] = {(i & 1) != 0 ? box.high.x : box.low.x, (i & 2) != 0 ? box.high.y : box.low.y,
                      (i & 4) != 0 ? box.high.z : box.low.z};
    return corners;
}

/// False: all of the box lies beyond one side of what is seen.
bool maySee(const glm::mat4& viewProjection, const Bounds& box)
{
    std::array<int, 6> beyond{};
    for (const glm::vec3& corner : cornersOf(box)) {
        const glm::vec4 at = viewProjection * glm::vec4(corner, 1.0f);
        for (int axis = 0; axis < 3; ++axis) {
            beyond[static_cast<std::size_t>(2 * axis)] += at[axis] < -at.w ? 1 : 0;
            beyond[static_cast<std::size_t>(2 * axis + 1)] += at[axis] > at.w ? 1 : 0;
        }
    }
    return std::ranges::find(beyond, 8) == beyond.end();
}

} // namespace

ShadowMaps::ShadowMaps(Gl& gl) : gl_(gl), block_(gl), blockOfOne_(gl) {}

void ShadowMaps::addCube(const PreviewLight& light, float reach, int first, const glm::mat3& turn, Maps& out) const
{
    // s, t, m of the faces +X -X +Y -Y +Z -Z, as cubePlace in mode_direct.frag has them
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const glm::vec3 faces[6][3] = {{-z, -y, x}, {z, -y, -x}, {x, z, y}, {x, -z, -y}, {x, -y, z}, {-x, -y, -z}};
    out.sample.shadow = glm::vec4(static_cast<float>(first), 1.0f, 0.0f, 1.0f / reach);
    out.sample.texel.x = 2.0f / static_cast<float>(cubeSide_);
    const float k = cubeScaleOf(cubeSide_);
    for (int i = 0; i < 6; ++i) {
        const glm::vec3 s = faces[i][0] * turn, t = faces[i][1] * turn, m = faces[i][2] * turn; // back by its transpose
        // the half space behind a patch gets no light: a face wholly in it stays empty
        if (light.kind == shader::kLampSurface && glm::dot(m, light.travel) < -0.82f) continue;
        out.layers.push_back({true, first + i, perspective(light.position, s, t, m, k, reach),
                              glm::vec4(light.position, 1.0f), glm::vec2(0.0f, 1.0f / reach)});
    }
}

void ShadowMaps::addSpot(const PreviewLight& light, float reach, int index, int matrix, const glm::mat3& turn,
                         Maps& out) const
{
    const float spread = std::tan(std::acos(light.cosOuter) + 0.02f);
    glm::vec3 s, t;
    axesAround(light.travel, turn, s, t);
    out.matrix = perspective(light.position, s, t, light.travel, 1.0f / spread, reach);
    out.sample.shadow = glm::vec4(static_cast<float>(index), 0.0f, 0.0f, 1.0f / reach);
    out.sample.texel = glm::vec4(2.0f * spread / static_cast<float>(flatSide_), static_cast<float>(matrix), 0.0f, 0.0f);
    out.layers.push_back({false, index, *out.matrix, glm::vec4(light.position, 1.0f), glm::vec2(0.0f, 1.0f / reach)});
}

void ShadowMaps::addSun(const PreviewLight& light, int index, int matrix, const glm::mat3& turn, Maps& out) const
{
    glm::vec3 s, t;
    axesAround(light.travel, turn, s, t);
    glm::vec3 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
    for (const glm::vec3& corner : cornersOf(bounds_)) {
        const glm::vec3 seen(glm::dot(corner, s), glm::dot(corner, t), glm::dot(corner, light.travel));
        low = glm::min(low, seen);
        high = glm::max(high, seen);
    }
    const float margin = 0.01f * bounds_.diagonal() + 1e-6f;
    low -= margin;
    high += margin;
    const glm::vec3 scale = 2.0f / (high - low), shift = -(high + low) / (high - low);
    out.matrix =
        glm::transpose(glm::mat4(glm::vec4(s * scale.x, shift.x), glm::vec4(t * scale.y, shift.y),
                                 glm::vec4(light.travel * scale.z, shift.z), glm::vec4(0.0f, 0.0f, 0.0f, 1.0f)));
    const glm::vec2 range(low.z, 1.0f / (high.z - low.z));
    out.sample.shadow = glm::vec4(static_cast<float>(index), 0.0f, range.x, range.y);
    const float texel = glm::max(high.x - low.x, high.y - low.y) / static_cast<float>(flatSide_);
    out.sample.texel = glm::vec4(texel, static_cast<float>(matrix), 0.0f, 0.0f);
    out.layers.push_back({false, index, *out.matrix, glm::vec4(light.travel, 0.0f), range});
}

ShadowMaps::Maps ShadowMaps::mapsOf(const PreviewLight& light, int first, int matrix, const glm::mat3& turn) const
{
    Maps out;
    out.sample = {glm::vec4(light.position, static_cast<float>(light.kind)), glm::vec4(light.travel, light.cosInner),
                  glm::vec4(light.colour, light.kind == shader::kLampSurface ? light.area : light.cosOuter),
                  glm::vec4(-1.0f), glm::vec4(0.0f)};
    const float reach = farthest(bounds_, light.position);
    if (light.inCube) {
        addCube(light, reach, first, turn, out);
    } else if (light.kind == shader::kLampSun) {
        addSun(light, first, matrix, turn, out);
    } else {
        addSpot(light, reach, first, matrix, turn, out);
    }
    return out;
}

void ShadowMaps::plan(const DrawData& data)
{
    lights_ = data.lights;
    bounds_ = data.scene->bounds;
    samples_.clear();
    matrices_.clear();
    layers_.clear();
    cubeLayers_ = 0;
    const auto cubes = 6 * std::ranges::count_if(lights_, &PreviewLight::inCube);
    cubeSide_ = cubes <= 64 ? 512 : 256;
    flatSide_ = 1024;
    for (const PreviewLight& light : lights_) {
        const auto flat = static_cast<int>(matrices_.size());
        const Maps maps = mapsOf(light, light.inCube ? cubeLayers_ : flat, flat, glm::mat3(1.0f));
        if (light.inCube) cubeLayers_ += 6;
        if (maps.matrix) matrices_.push_back(*maps.matrix);
        layers_.insert(layers_.end(), maps.layers.begin(), maps.layers.end());
        samples_.push_back(maps.sample);
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
    flat_ = make(flatSide_, static_cast<int>(matrices_.size()) + 1); // the last ones are drawOne's
    cube_ = make(cubeSide_, cubeLayers_ + 6);
    target_ = GlFramebuffer(gl_);
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
    gl_.glDrawBuffer(GL_NONE);
    gl_.glReadBuffer(GL_NONE);
    gl_.glDepthMask(GL_TRUE);
    // undrawn layers shade nothing
    for (const auto& [texture, count] :
         {std::pair(flat_.id(), static_cast<int>(matrices_.size()) + 1), std::pair(cube_.id(), cubeLayers_ + 6)}) {
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
            return (old.isDrawn || old.isOld) && old.inCube == layer.inCube && old.index == layer.index &&
                   old.lamp == layer.lamp && old.range == layer.range && old.viewProjection == layer.viewProjection;
        };
        if (const auto kept = std::ranges::find_if(before, isSame); kept != before.end())
            layer.isDrawn = kept->isDrawn, layer.isOld = kept->isOld;
        undrawn_ += layer.isDrawn ? 0 : 1;
    }
    setMix({});
    return Done{};
}

void ShadowMaps::drawLayer(const SceneBuffers& scene, const GlProgram& shadow, const Layer& layer)
{
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
    gl_.glEnable(GL_DEPTH_TEST);
    gl_.glDepthFunc(GL_LESS);
    gl_.glDepthMask(GL_TRUE);
    gl_.glDisable(GL_BLEND);
    shadow.use();
    const int side = layer.inCube ? cubeSide_ : flatSide_;
    gl_.glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, layer.inCube ? cube_.id() : flat_.id(), 0,
                                  layer.index);
    gl_.glViewport(0, 0, side, side);
    gl_.glClearDepth(1.0);
    gl_.glClear(GL_DEPTH_BUFFER_BIT);
    shadow.set("viewProjection", layer.viewProjection);
    shadow.set("lamp", layer.lamp);
    shadow.set("range", layer.range);
    scene.draw(shadow, false, 1.0f);
    if (guest_ != nullptr) guest_->draw(shadow, false, 1.0f);
}

void ShadowMaps::setGuest(const SceneBuffers* guest, const Bounds& box)
{
    for (Layer& layer : layers_) {
        const bool isTouched = (guest_ != nullptr && maySee(layer.viewProjection, guestBox_)) ||
                               (guest != nullptr && maySee(layer.viewProjection, box));
        if (!isTouched || !layer.isDrawn) continue;
        layer.isDrawn = false;
        layer.isOld = true;
        ++undrawn_;
    }
    guest_ = guest;
    guestBox_ = box;
}

bool ShadowMaps::lacksScene() const
{
    return std::ranges::any_of(layers_, [](const Layer& l) { return !l.isDrawn && !l.isOld; });
}

bool ShadowMaps::draw(const SceneBuffers& scene, const GlProgram& shadow, double budgetMs)
{
    if (isComplete()) return true;
    QElapsedTimer clock;
    clock.start();
    // in turn, so that none waits for ever behind those that a moving guest asks for again and again
    for (std::size_t i = 0; i < layers_.size(); ++i) {
        Layer& layer = layers_[next_++ % layers_.size()];
        if (layer.isDrawn) continue;
        layer.isDrawn = true;
        layer.isOld = false;
        --undrawn_;
        drawLayer(scene, shadow, layer);
        ++layersDrawn_;
        gl_.glFinish(); // else the budget would measure how fast commands are queued
        if (static_cast<double>(clock.nsecsElapsed()) >= budgetMs * 1e6) break;
    }
    return isComplete();
}

int ShadowMaps::refineRounds() const
{
    const bool hasExtent = std::ranges::any_of(lights_, [](const PreviewLight& l) { return l.points != nullptr; });
    return hasExtent ? 32 : 8;
}

bool ShadowMaps::drawOne(const SceneBuffers& scene, const GlProgram& shadow, int light, int round)
{
    PreviewLight one = lights_[static_cast<std::size_t>(light)];
    one.colour *= gainOf(mix_, one.group);
    if (one.colour == glm::vec3(0.0f)) {
        fill(blockOfOne_, {}, {}); // what is drawn without it reads it all the same
        return false;
    }
    if (one.points && !one.points->empty()) {
        const PreviewLight::Point& at = (*one.points)[static_cast<std::size_t>(round) % one.points->size()];
        one.position = at.position;
        one.travel = at.travel;
    }
    turnOfOne_ = turnOf(1 + round * lightCount() + light);
    const int spare = one.inCube ? cubeLayers_ : static_cast<int>(matrices_.size());
    const Maps maps = mapsOf(one, spare, 0, turnOfOne_);
    for (const Layer& layer : maps.layers) drawLayer(scene, shadow, layer);
    fill(blockOfOne_, {maps.sample}, {maps.matrix.value_or(glm::mat4(1.0f))});
    return true;
}

void ShadowMaps::setMix(const Mix& mix)
{
    mix_ = mix;
    std::vector<SampleLight> dimmed = samples_;
    for (std::size_t i = 0; i < dimmed.size(); ++i) {
        const glm::vec4 c = dimmed[i].colour;
        dimmed[i].colour = glm::vec4(glm::vec3(c.x, c.y, c.z) * gainOf(mix, lights_[i].group), c.w);
    }
    fill(block_, dimmed, matrices_);
}

void ShadowMaps::fill(const GlBuffer& block, const std::vector<SampleLight>& lights,
                      const std::vector<glm::mat4>& matrices)
{
    std::vector<glm::vec4> data;
    for (const SampleLight& s : lights) data.insert(data.end(), {s.position, s.travel, s.colour, s.shadow, s.texel});
    data.resize(5 * shader::kMostSampleLights, glm::vec4(0.0f));
    for (const glm::mat4& m : matrices) data.insert(data.end(), {m[0], m[1], m[2], m[3]});
    data.resize(5 * shader::kMostSampleLights + 4 * shader::kMostLamps, glm::vec4(0.0f));
    gl_.glBindBuffer(GL_UNIFORM_BUFFER, block.id());
    gl_.glBufferData(GL_UNIFORM_BUFFER, static_cast<GLsizeiptr>(data.size() * sizeof(glm::vec4)), data.data(),
                     GL_DYNAMIC_DRAW);
}

void ShadowMaps::bindMaps(const GlProgram& direct, int unit, const glm::mat3& turn, const GlBuffer& block) const
{
    direct.setTexture("flatShadows", unit, GL_TEXTURE_2D_ARRAY, flat_.id());
    direct.setTexture("cubeShadows", unit + 1, GL_TEXTURE_2D_ARRAY, cube_.id());
    direct.set("cubeScale", cubeScaleOf(cubeSide_));
    direct.set("cubeTurn", turn);
    direct.bindBlock("Lamps", kLampBlock);
    gl_.glBindBufferBase(GL_UNIFORM_BUFFER, kLampBlock, block.id());
}

void ShadowMaps::bind(const GlProgram& direct, int unit) const { bindMaps(direct, unit, glm::mat3(1.0f), block_); }
void ShadowMaps::bindOne(const GlProgram& direct, int unit) const { bindMaps(direct, unit, turnOfOne_, blockOfOne_); }

} // namespace lightloom
