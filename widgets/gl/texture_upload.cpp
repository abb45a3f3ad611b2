// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/texture_upload.h"
#include <algorithm>
#include <fmt/format.h>

namespace lightloom {

namespace {

/// Integer textures are incomplete under any other filter.
void readByFetch(Gl& gl, GLenum target)
{
    gl.glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.glTexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
}

GLint wrapOf(Texture::Wrap wrap)
{
    switch (wrap) {
    case Texture::Wrap::clamp:
        return GL_CLAMP_TO_EDGE;
    case Texture::Wrap::mirror:
        return GL_MIRRORED_REPEAT;
    case Texture::Wrap::repeat:
        break;
    }
    return GL_REPEAT;
}

Result<Done> fits(Gl& gl, GLenum limit, int size, const char* what, const char* remedy)
{
    GLint most = 0;
    gl.glGetIntegerv(limit, &most);
    if (size <= most) return Done{};
    return Error{
        Error::Kind::unsupported,
        fmt::format("{} need a texture {} wide and this graphics driver takes {}; lower {}", what, size, most, remedy)};
}

} // namespace

Result<OctreeTextures> uploadOctree(Gl& gl, const GpuOctree& octree)
{
    const glm::ivec3 size = 2 * octree.side;
    const char* remedy = "octree.depth or vdl.count";
    for (const Result<Done>& fit :
         {fits(gl, GL_MAX_3D_TEXTURE_SIZE, std::max({size.x, size.y, size.z}), "the octree's bricks", remedy),
          fits(gl, GL_MAX_TEXTURE_SIZE, std::max(octree.vdlWidth, octree.vdlHeight), "the octree's lights", remedy),
          fits(gl, GL_MAX_TEXTURE_SIZE, std::max(octree.normalWidth, octree.normalHeight), "the octree's normals",
               remedy)}) {
        if (!fit) return fit.error();
    }
    OctreeTextures textures;
    gl.glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    textures.bricks = GlTexture(gl);
    gl.glActiveTexture(GL_TEXTURE0);
    gl.glBindTexture(GL_TEXTURE_3D, textures.bricks.id());
    gl.glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8UI, size.x, size.y, size.z, 0, GL_RGBA_INTEGER, GL_UNSIGNED_BYTE,
                    octree.bricks.data());
    readByFetch(gl, GL_TEXTURE_3D);
    textures.vdls = makeTexture2D(gl, GL_RGBA16UI, {octree.vdlWidth, octree.vdlHeight}, GL_RGBA_INTEGER,
                                  GL_UNSIGNED_SHORT, octree.vdls.data());
    readByFetch(gl, GL_TEXTURE_2D);
    textures.normals = makeTexture2D(gl, GL_RGBA8UI, {octree.normalWidth, octree.normalHeight}, GL_RGBA_INTEGER,
                                     GL_UNSIGNED_BYTE, octree.normals.data());
    readByFetch(gl, GL_TEXTURE_2D);
    return textures;
}

Result<GridTextures> uploadGrid(Gl& gl, const GpuGrid& grid)
{
    const glm::ivec3 size = grid.size(), vertices = grid.lattice.vertices();
    if (const Result<Done> fit =
            fits(gl, GL_MAX_3D_TEXTURE_SIZE, std::max({size.x, size.y, size.z}), "the grid's vertices", "grid.size");
        !fit) {
        return fit.error();
    }
    GridTextures textures;
    gl.glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl.glActiveTexture(GL_TEXTURE0);
    const auto upload = [&](GLint internal, glm::ivec3 box, GLenum format, GLenum type, const void* texels) {
        GlTexture texture(gl);
        gl.glBindTexture(GL_TEXTURE_3D, texture.id());
        gl.glTexImage3D(GL_TEXTURE_3D, 0, internal, box.x, box.y, box.z, 0, format, type, texels);
        readByFetch(gl, GL_TEXTURE_3D);
        return texture;
    };
    const auto filter = [&] {
        for (const GLenum way : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
            gl.glTexParameteri(GL_TEXTURE_3D, way, GL_LINEAR);
        for (const GLenum way : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
            gl.glTexParameteri(GL_TEXTURE_3D, way, GL_CLAMP_TO_EDGE);
    };
    textures.sight = upload(GL_RGBA16UI, vertices, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT, grid.sight.data());
    textures.light = upload(GL_RGBA16F, size, GL_RGBA, GL_HALF_FLOAT, grid.light.data());
    filter();
    if (!grid.places.empty()) {
        textures.places = upload(GL_RGBA32F, vertices, GL_RGBA, GL_FLOAT, grid.places.data());
        filter();
    }
    if (gl.glGetError() == GL_OUT_OF_MEMORY) {
        return Error{
            Error::Kind::outOfMemory,
            fmt::format("the graphics driver has no room for the grid's {:.0f} MB of textures; lower grid.size",
                        static_cast<double>(grid.memoryBytes()) / 1e6)};
    }
    return textures;
}

GlTexture uploadImage(Gl& gl, const Image& image, const Texture& texture, bool srgb)
{
    GlTexture out = makeTexture2D(gl, srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8, {image.width, image.height}, GL_RGBA,
                                  GL_UNSIGNED_BYTE, image.rgba.data());
    gl.glGenerateMipmap(GL_TEXTURE_2D);
    gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER,
                       texture.smooth ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_NEAREST);
    gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, texture.smooth ? GL_LINEAR : GL_NEAREST);
    gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrapOf(texture.wrapS));
    gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrapOf(texture.wrapT));
    return out;
}

GlTexture uploadColour(Gl& gl, glm::u8vec4 rgba)
{
    return makeTexture2D(gl, GL_RGBA8, {1, 1}, GL_RGBA, GL_UNSIGNED_BYTE, &rgba);
}

} // namespace lightloom
