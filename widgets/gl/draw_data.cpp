// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/draw_data.h"
#include "widgets/gl/preview_lights.h"

namespace lightloom {

namespace {

DrawVertex vertexOf(const Mesh& mesh, std::uint32_t i)
{
    DrawVertex v{};
    v.position = mesh.positions[i];
    if (!mesh.normals.empty()) v.normal = mesh.normals[i];
    const glm::vec2 uv0 = mesh.uv[0].empty() ? glm::vec2(0.0f) : mesh.uv[0][i];
    const glm::vec2 uv1 = mesh.uv[1].empty() ? glm::vec2(0.0f) : mesh.uv[1][i];
    v.uv = glm::vec4(uv0, uv1);
    v.colour = mesh.colors.empty() ? glm::vec4(1.0f) : mesh.colors[i];
    return v;
}

/// What is drawn of a scene while it grows.
struct Lists {
    std::vector<DrawVertex> vertices;
    std::vector<std::uint32_t> indices;
};

/// Three vertices of their own per triangle, so that each has its face's normal.
void addFlat(const Mesh& mesh, Lists& out)
{
    for (const glm::uvec3& triangle : mesh.triangles) {
        DrawVertex corners[3] = {vertexOf(mesh, triangle.x), vertexOf(mesh, triangle.y), vertexOf(mesh, triangle.z)};
        const glm::vec3 across =
            glm::cross(corners[1].position - corners[0].position, corners[2].position - corners[0].position);
        const float length = glm::length(across);
        for (DrawVertex& corner : corners) {
            corner.normal = length > 0.0f ? across / length : glm::vec3(0.0f, 1.0f, 0.0f);
            out.indices.push_back(static_cast<std::uint32_t>(out.vertices.size()));
            out.vertices.push_back(corner);
        }
    }
}

void addSmooth(const Mesh& mesh, Lists& out)
{
    const auto base = static_cast<std::uint32_t>(out.vertices.size());
    for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) out.vertices.push_back(vertexOf(mesh, i));
    for (const glm::uvec3& triangle : mesh.triangles) {
        for (const std::uint32_t corner : {triangle.x, triangle.y, triangle.z}) out.indices.push_back(base + corner);
    }
}

} // namespace

std::shared_ptr<const DrawData> makeDrawData(std::shared_ptr<const Scene> scene)
{
    auto data = std::make_shared<DrawData>();
    data->scene = std::move(scene);
    Lists lists;
    for (const Mesh& mesh : data->scene->meshes) {
        DrawData::Range range;
        range.first = static_cast<std::uint32_t>(lists.indices.size());
        if (mesh.normals.empty()) {
            addFlat(mesh, lists);
        } else {
            addSmooth(mesh, lists);
        }
        range.count = static_cast<std::uint32_t>(lists.indices.size()) - range.first;
        data->meshes.push_back(range);
    }
    data->vertices = std::move(lists.vertices);
    data->indices = std::move(lists.indices);
    addPreviewLights(*data);
    return data;
}

std::shared_ptr<const DrawData> withLamps(const DrawData& data, std::shared_ptr<const Scene> scene)
{
    auto edited = std::make_shared<DrawData>(data);
    edited->scene = std::move(scene);
    movePreviewLights(*edited);
    return edited;
}

} // namespace lightloom
