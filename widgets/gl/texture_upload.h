// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/bake/gpu_layout.h"
#include "core/ivg/grid_gpu.h"
#include "core/scene/scene.h"
#include "widgets/gl/gl_objects.h"

namespace lightloom {

/// A light octree in textures, read by texelFetch only.
struct OctreeTextures {
    GlTexture bricks;  ///< 3D, RGBA8UI
    GlTexture vdls;    ///< 2D, RGBA16UI
    GlTexture normals; ///< 2D, RGBA8UI
};

/// Errors: a texture is larger than the driver takes (says both sizes).
[[nodiscard]] Result<OctreeTextures> uploadOctree(Gl& gl, const GpuOctree& octree);

/// An irradiance grid in textures. Its light may be read by texelFetch and with linear filter.
struct GridTextures {
    GlTexture light;  ///< 3D, RGBA16F
    GlTexture sight;  ///< 3D, RGBA16UI
    GlTexture places; ///< 3D, RGBA32F; none where GpuGrid has none
};

/// Errors: as above.
[[nodiscard]] Result<GridTextures> uploadGrid(Gl& gl, const GpuGrid& grid);

/// Image with mip maps, sRGB decoded on reading if `srgb`; wrap and filter as `texture` asks.
[[nodiscard]] GlTexture uploadImage(Gl& gl, const Image& image, const Texture& texture, bool srgb);
/// One texel.
[[nodiscard]] GlTexture uploadColour(Gl& gl, glm::u8vec4 rgba);

} // namespace lightloom
