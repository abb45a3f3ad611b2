// SPDX-License-Identifier: Apache-2.0
#include "core/trace/material.h"
#include "core/base/image.h"
#include "core/base/sampling.h"
#include <array>
#include <cmath>

namespace lightloom {
namespace {

/// Where a texture coordinate of any size falls in [0, period) texture widths; NaN and infinity count as 0.
double wrapped(float u, double period)
{
    const double v = static_cast<double>(u);
    return std::isfinite(v) ? v - period * std::floor(v / period) : 0.0;
}

/// The one or two texels a coordinate falls on along one axis, and the weight of the second.
struct Taps {
    int first = 0, second = 0;
    float weight = 0.0f;
};

int texelIndex(int i, int size, Texture::Wrap wrap)
{
    if (wrap == Texture::Wrap::clamp) return glm::clamp(i, 0, size - 1);
    if (wrap == Texture::Wrap::repeat) return (i % size + size) % size;
    const int m = (i % (2 * size) + 2 * size) % (2 * size);
    return m < size ? m : 2 * size - 1 - m;
}

Taps tapsFor(float u, int size, Texture::Wrap wrap, bool smooth)
{
    double at = 0.0;
    switch (wrap) {
    case Texture::Wrap::clamp:
        at = std::isfinite(u) ? glm::clamp(static_cast<double>(u), 0.0, 1.0) : 0.0;
        break;
    case Texture::Wrap::repeat:
        at = wrapped(u, 1.0);
        break;
    case Texture::Wrap::mirror:
        at = wrapped(u, 2.0);
        break;
    }
    at *= size;
    if (!smooth) {
        const int i = texelIndex(static_cast<int>(at), size, wrap);
        return {i, i, 0.0f};
    }
    const double low = std::floor(at - 0.5); // texel centres lie at halves
    const int i = static_cast<int>(low);
    return {texelIndex(i, size, wrap), texelIndex(i + 1, size, wrap), static_cast<float>(at - 0.5 - low)};
}

glm::vec4 texel(const Image& image, int x, int y, bool srgb)
{
    const std::size_t at =
        (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)) * 4;
    const std::uint8_t* p = image.rgba.data() + at;
    constexpr float kStep = 1.0f / 255.0f;
    if (!srgb) return glm::vec4(p[0], p[1], p[2], p[3]) * kStep;
    const std::array<float, 256>& table = decodedSrgbBytes();
    return {table[p[0]], table[p[1]], table[p[2]], static_cast<float>(p[3]) * kStep};
}

/// KHR_texture_transform: scale, then turn counter-clockwise as seen with v downwards, then shift.
glm::vec2 transformed(const Texture& t, glm::vec2 uv)
{
    uv *= t.scale;
    if (t.rotation != 0.0f) {
        const float c = std::cos(t.rotation), s = std::sin(t.rotation);
        uv = {c * uv.x + s * uv.y, c * uv.y - s * uv.x};
    }
    return uv + t.offset;
}

/// A triangle with its mesh, for looking up what is stored per vertex.
struct Corner {
    const Scene& scene;
    const Mesh& mesh;
    const Material& material;
    glm::uvec3 vertices;
    glm::vec3 weights;

    Corner(const RayScene& rays, std::uint32_t triangle, glm::vec2 b)
        : scene(rays.scene()), mesh(meshOf(rays, triangle)), material(rays.material(triangle)),
          vertices(mesh.triangles[rays.triangle(triangle).indexInMesh]), weights(1.0f - b.x - b.y, b.x, b.y)
    {
    }

    template<class T>
    [[nodiscard]] T at(const std::vector<T>& values) const
    {
        return weights.x * values[vertices.x] + weights.y * values[vertices.y] + weights.z * values[vertices.z];
    }

    /// White where there is no texture or no coordinates for it: the factor alone counts.
    [[nodiscard]] glm::vec4 look(const Texture& texture, bool srgb) const
    {
        if (!texture.isSet()) return glm::vec4(1.0f);
        const auto& uv = mesh.uv[texture.uvSet == 1 ? 1 : 0];
        return uv.empty() ? glm::vec4(1.0f) : sampleTexture(scene, texture, at(uv), srgb);
    }

    [[nodiscard]] glm::vec3 emission() const
    {
        return material.isEmissive() ? material.emission * glm::vec3(look(material.emissionTexture, true))
                                     : glm::vec3(0.0f);
    }

private:
    static const Mesh& meshOf(const RayScene& rays, std::uint32_t triangle)
    {
        const Scene& s = rays.scene();
        return s.meshes[static_cast<std::size_t>(s.instances[rays.triangle(triangle).instance].mesh)];
    }
};

/// Isotropic GGX in the local frame of a surface (z along the normal), with height-correlated Smith shadowing
/// (Heitz 2014). Written with the sines of angles: 1 - cos^2 of a float has lost the narrow lobes of smooth metals.
struct Ggx {
    float alpha;

    [[nodiscard]] float density(glm::vec3 h) const
    {
        const float a2 = alpha * alpha, slope = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
        return 1.0f / (kPi * a2 * slope * slope);
    }
    [[nodiscard]] float lambda(glm::vec3 v) const
    {
        const float tan2 = (v.x * v.x + v.y * v.y) / (v.z * v.z);
        return 0.5f * (std::sqrt(1.0f + alpha * alpha * tan2) - 1.0f);
    }
    /// D G2 / (4 cos cos): the brdf without Fresnel.
    [[nodiscard]] float brdf(glm::vec3 toLight, glm::vec3 toEye, glm::vec3 h) const
    {
        return density(h) / ((1.0f + lambda(toLight) + lambda(toEye)) * 4.0f * toLight.z * toEye.z);
    }
    /// Density per solid angle of directions mirrored at visible normals.
    [[nodiscard]] float pdf(glm::vec3 toEye, glm::vec3 h) const
    {
        return density(h) / ((1.0f + lambda(toEye)) * 4.0f * toEye.z);
    }
    /// A normal seen from `toEye`, in proportion to its visible area (Heitz 2018): the sphere's half that is seen from
    /// the stretched direction, projected on a disc.
    [[nodiscard]] glm::vec3 visibleNormal(glm::vec3 toEye, float u1, float u2) const
    {
        const glm::vec3 stretched = glm::normalize(glm::vec3(alpha * toEye.x, alpha * toEye.y, toEye.z));
        const Frame frame(stretched);
        glm::vec2 d = sampleDisc(u1, u2);
        // the lower half of the disc shrinks where the eye sees the flat cut of the hemisphere; the frame's tangents
        // are turned so that this half is the one nearest the horizon
        glm::vec3 side(-stretched.y, stretched.x, 0.0f);
        const float length = glm::length(side);
        const glm::vec3 t1 = length > 0.0f ? side / length : frame.tangent;
        const glm::vec3 t2 = glm::cross(stretched, t1);
        const float share = 0.5f * (1.0f + stretched.z);
        d.y = (1.0f - share) * std::sqrt(glm::max(0.0f, 1.0f - d.x * d.x)) + share * d.y;
        const float up = std::sqrt(glm::max(0.0f, 1.0f - d.x * d.x - d.y * d.y));
        const glm::vec3 n = d.x * t1 + d.y * t2 + up * stretched;
        return glm::normalize(glm::vec3(alpha * n.x, alpha * n.y, glm::max(0.0f, n.z)));
    }
};

/// Schlick's Fresnel term of the metallic part.
glm::vec3 fresnel(const Surface& s, float cosine)
{
    const float m = glm::clamp(1.0f - cosine, 0.0f, 1.0f), m2 = m * m;
    return s.specular + glm::max(glm::vec3(0.0f), glm::vec3(s.grazing) - s.specular) * (m2 * m2 * m);
}

/// Chance of the specular lobe: its share of what is reflected towards the eye.
float specularChance(const Surface& s, float cosEye)
{
    if (!s.hasSpecular()) return 0.0f;
    const glm::vec3 f = fresnel(s, cosEye);
    const float specular = f.x + f.y + f.z, diffuse = s.diffuse.x + s.diffuse.y + s.diffuse.z;
    return specular / (specular + diffuse);
}

float sum(glm::vec3 v) { return v.x + v.y + v.z; }

/// Chance of the glass: its share of what is sent on of light from the eye.
float glassChance(const Surface& s, float cosEye)
{
    if (!(s.glass.share > 0.0f)) return 0.0f;
    const GlassShares shares = glassShares(s.glass, cosEye);
    const float clear = sum(shares.reflected) + sum(shares.through);
    const float rest = sum(s.diffuse) + (s.hasSpecular() ? sum(fresnel(s, cosEye)) : 0.0f);
    return clear > 0.0f ? clear / (clear + rest) : 0.0f;
}

/// Reflects at glass or goes through, by Fresnel's share; the glass was picked with `chance`.
Scatter scatterAtGlass(const Surface& s, const Frame& frame, glm::vec3 eye, float u, float chance)
{
    const GlassShares shares = glassShares(s.glass, eye.z);
    const float reflected = sum(shares.reflected), back = reflected / (reflected + sum(shares.through));
    Scatter out;
    out.isMirror = out.isSpecular = true;
    if (u < back) {
        out.away = frame.toWorld({-eye.x, -eye.y, eye.z});
        out.weight = shares.reflected / (chance * back);
        return out;
    }
    out.isThrough = true;
    out.weight = shares.through / (chance * (1.0f - back));
    if (s.glass.isThin) {
        out.away = frame.toWorld(-eye);
        return out;
    }
    out.away = frame.toWorld(refracted(eye, s.glass.eta));
    out.radianceScale = 1.0f / (s.glass.eta * s.glass.eta);
    return out;
}

Ggx lobeOf(const Surface& s) { return {s.roughness * s.roughness}; }

glm::vec3 localBrdf(const Surface& s, glm::vec3 toLight, glm::vec3 toEye)
{
    if (toLight.z <= 0.0f || toEye.z <= 0.0f) return glm::vec3(0.0f);
    glm::vec3 f = s.diffuse / kPi;
    if (s.hasSpecular() && !s.isMirror()) {
        const glm::vec3 h = glm::normalize(toLight + toEye);
        f += fresnel(s, glm::dot(h, toEye)) * lobeOf(s).brdf(toLight, toEye, h);
    }
    return f;
}

/// Of the lobes that reflect, as if there were no glass.
float localPdf(const Surface& s, glm::vec3 away, glm::vec3 toEye)
{
    if (away.z <= 0.0f || toEye.z <= 0.0f) return 0.0f;
    const float chance = specularChance(s, toEye.z);
    float pdf = (1.0f - chance) * away.z / kPi;
    if (chance > 0.0f && !s.isMirror()) pdf += chance * lobeOf(s).pdf(toEye, glm::normalize(away + toEye));
    return pdf;
}

void addGlass(const Material& m, bool isFront, glm::vec3 tint, float share, Surface& s)
{
    s.diffuse *= 1.0f - glm::min(1.0f, m.transmission);
    s.glass.share = glm::min(1.0f, share);
    s.glass.isThin = !(m.thickness > 0.0f);
    s.glass.tint = tint;
    const bool isEntered = isFront || s.glass.isThin;
    s.glass.eta = isEntered || !(m.ior > 0.0f) ? m.ior : 1.0f / m.ior;
    if (!s.glass.isThin) s.glass.absorption = absorptionOf(m);
}

/// What the textures and colours of a material give at one point, with its factors.
struct MaterialValues {
    glm::vec3 base{1.0f};
    float metallic = 0.0f, roughness = 1.0f;
    glm::vec3 emission{0.0f};
};

Surface surfaceOf(const Material& m, const MaterialValues& values, bool isFront)
{
    const glm::vec3 tint = glm::clamp(values.base, 0.0f, 1.0f), base = glm::min(tint, kLargestAlbedo);
    const float metallic = glm::clamp(values.metallic, 0.0f, 1.0f);
    Surface s;
    s.diffuse = (1.0f - metallic) * base;
    s.specular = metallic * base;
    s.grazing = metallic * kLargestAlbedo;
    s.roughness = glm::clamp(values.roughness, 0.0f, 1.0f);
    if (isFront || m.doubleSided) s.emission = values.emission;
    if (m.transmission > 0.0f) addGlass(m, isFront, tint, (1.0f - metallic) * m.transmission, s);
    return s;
}

} // namespace

glm::vec4 sampleTexture(const Scene& scene, const Texture& texture, glm::vec2 uv, bool srgb)
{
    if (!texture.isSet()) return glm::vec4(1.0f);
    const Image& image = scene.images[static_cast<std::size_t>(texture.image)];
    if (image.width < 1 || image.height < 1) return glm::vec4(1.0f);
    const glm::vec2 at = transformed(texture, uv);
    const Taps x = tapsFor(at.x, image.width, texture.wrapS, texture.smooth);
    const Taps y = tapsFor(at.y, image.height, texture.wrapT, texture.smooth);
    if (!texture.smooth) return texel(image, x.first, y.first, srgb);
    const auto row = [&](int line) {
        return glm::mix(texel(image, x.first, line, srgb), texel(image, x.second, line, srgb), x.weight);
    };
    return glm::mix(row(y.first), row(y.second), y.weight);
}

Surface surfaceAt(const RayScene& rays, const Hit& hit)
{
    const InstanceLook& look = rays.look(hit.instance);
    if (look.isPlain) return hit.isFront ? look.front : look.back;
    const Corner corner(rays, hit.triangle, hit.barycentric);
    const Material& m = corner.material;
    MaterialValues values{glm::vec3(m.baseColor), m.metallic, m.roughness, corner.emission()};
    values.base *= glm::vec3(corner.look(m.baseColorTexture, true));
    if (!corner.mesh.colors.empty()) values.base *= glm::vec3(corner.at(corner.mesh.colors));
    if (m.metallicRoughnessTexture.isSet()) {
        const glm::vec4 t = corner.look(m.metallicRoughnessTexture, false);
        values.metallic *= t.z;
        values.roughness *= t.y;
    }
    return surfaceOf(m, values, hit.isFront);
}

std::vector<InstanceLook> instanceLooks(const Scene& scene)
{
    std::vector<InstanceLook> looks(scene.instances.size());
    for (std::size_t i = 0; i < looks.size(); ++i) {
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(scene.instances[i].mesh)];
        const Material& m = scene.materials[static_cast<std::size_t>(mesh.material)];
        const bool isTextured =
            m.baseColorTexture.isSet() || m.metallicRoughnessTexture.isSet() || m.emissionTexture.isSet();
        if (isTextured || !mesh.colors.empty()) continue;
        const MaterialValues values{glm::vec3(m.baseColor), m.metallic, m.roughness, m.emission};
        const Surface front = surfaceOf(m, values, true);
        const float survival = glm::min(1.0f, Surface::maxChannel3(front.diffuse));
        const glm::vec3 kept = survival > 0.0f ? front.diffuse / survival : glm::vec3(0.0f);
        looks[i] = {true, !front.isSeenInto(), front, surfaceOf(m, values, false), survival, kept};
    }
    return looks;
}

glm::vec3 emissionAt(const RayScene& rays, std::uint32_t triangle, glm::vec2 barycentric)
{
    const InstanceLook& look = rays.look(rays.triangle(triangle).instance);
    return look.isPlain ? look.front.emission : Corner(rays, triangle, barycentric).emission();
}

glm::vec3 brdf(const Surface& surface, glm::vec3 n, glm::vec3 toLight, glm::vec3 toEye)
{
    if (!surface.hasSpecular() || surface.isMirror()) {
        const bool lit = glm::dot(n, toLight) > 0.0f && glm::dot(n, toEye) > 0.0f;
        return lit ? surface.diffuse / kPi : glm::vec3(0.0f);
    }
    const Frame frame(n);
    return localBrdf(surface, frame.toLocal(toLight), frame.toLocal(toEye));
}

float scatterPdf(const Surface& surface, glm::vec3 n, glm::vec3 away, glm::vec3 toEye)
{
    const Frame frame(n);
    const glm::vec3 eye = frame.toLocal(toEye);
    return (1.0f - glassChance(surface, eye.z)) * localPdf(surface, frame.toLocal(away), eye);
}

namespace {

/// What reflects, as if there were no glass.
bool scatterBack(const Surface& surface, const Frame& frame, glm::vec3 eye, glm::vec3 u, Scatter& out)
{
    const float chance = specularChance(surface, eye.z);
    if (chance == 0.0f && Surface::maxChannel3(surface.diffuse) <= 0.0f) return false;

    out = Scatter{};
    out.isSpecular = u.z < chance;
    if (out.isSpecular && surface.isMirror()) {
        out.isMirror = true;
        out.away = frame.toWorld({-eye.x, -eye.y, eye.z});
        out.weight = fresnel(surface, eye.z) / chance;
        return true;
    }
    glm::vec3 away;
    if (out.isSpecular) {
        const glm::vec3 h = lobeOf(surface).visibleNormal(eye, u.x, u.y);
        away = 2.0f * glm::dot(eye, h) * h - eye;
        if (away.z <= 0.0f) return false; // mirrored into the surface: shadowed light, part of Smith's loss
        away = glm::normalize(away);
    } else {
        away = sampleCosineHemisphere(u.x, u.y);
    }
    out.away = frame.toWorld(away);
    out.pdf = localPdf(surface, away, eye);
    if (!(out.pdf > 0.0f)) return false;
    if (chance == 0.0f) {
        out.weight = surface.diffuse; // exact, without rounding through cos / pi
    } else if (surface.isMirror()) {
        out.weight = surface.diffuse / (1.0f - chance);
    } else {
        out.weight = localBrdf(surface, away, eye) * (away.z / out.pdf);
    }
    return true;
}

} // namespace

bool scatter(const Surface& surface, glm::vec3 n, glm::vec3 toEye, glm::vec3 u, Scatter& out)
{
    const Frame frame(n);
    const glm::vec3 eye = frame.toLocal(toEye);
    if (eye.z <= 0.0f) return false;
    float rest = 1.0f;
    if (surface.glass.share > 0.0f) {
        const float clear = glassChance(surface, eye.z);
        if (u.z < clear) {
            out = scatterAtGlass(surface, frame, eye, u.x, clear);
            return true;
        }
        rest = 1.0f - clear;
        u.z = (u.z - clear) / rest;
    }
    if (!scatterBack(surface, frame, eye, u, out)) return false;
    if (rest < 1.0f) {
        out.weight /= rest;
        out.pdf *= rest;
    }
    return true;
}

} // namespace lightloom
