// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/atlas_draw.h"

namespace lightloom {

namespace {

/// A side's corners and their places; sides without a place show the other side's, or the black corner.
void addSide(const RayScene& rays, const Atlas& atlas, std::uint32_t side, AtlasDraw& out)
{
    const SceneTriangle& t = rays.triangle(side / 2);
    std::optional<std::size_t> place = atlas.find(side);
    if (!place) place = atlas.find(side ^ 1u);
    const std::array<glm::vec2, 3> nowhere{atlas.voidUv, atlas.voidUv, atlas.voidUv};
    const std::array<glm::vec2, 3>& uv = place ? atlas.uv[*place] : nowhere;
    const glm::vec3 normal = rays.triangleNormal(side / 2);
    // in mirrored instances a, b, c run clockwise as seen from the front
    const bool isClockwise = glm::dot(glm::cross(t.b - t.a, t.c - t.a), normal) < 0.0f;
    const bool isTurned = isClockwise != (side % 2 != 0);
    out.vertices.push_back({t.a, uv[0]});
    out.vertices.push_back(isTurned ? AtlasVertex{t.c, uv[2]} : AtlasVertex{t.b, uv[1]});
    out.vertices.push_back(isTurned ? AtlasVertex{t.b, uv[1]} : AtlasVertex{t.c, uv[2]});
}

} // namespace

std::shared_ptr<const AtlasDraw> makeAtlasDraw(const RayScene& rays, const Atlas& atlas)
{
    auto draw = std::make_shared<AtlasDraw>();
    draw->size = atlas.size;
    draw->owners = atlas.owners;
    draw->report = atlas.report;
    draw->positions.assign(atlas.texelCount(), glm::vec4(0.0f));
    draw->normals.assign(atlas.texelCount(), glm::vec4(0.0f));
    for (const SurfaceTexel& t : atlas.texels) {
        draw->positions[t.texel] = glm::vec4(t.position, 1.0f);
        draw->normals[t.texel] = glm::vec4(t.normal, 1.0f);
    }
    for (std::uint32_t t = 0; t < rays.triangleCount(); ++t) {
        addSide(rays, atlas, 2 * t, *draw);
        if (rays.material(t).doubleSided) addSide(rays, atlas, 2 * t + 1, *draw);
    }
    return draw;
}

} // namespace lightloom
