// SPDX-License-Identifier: Apache-2.0
#include "core/octree/layer_fit.h"
#include "core/base/units.h"

namespace lightloom {

std::shared_ptr<VdlLayer> emptyLayer(const OctreeGeometry& geometry, int group, const BakeParams& params)
{
    auto layer = std::make_shared<VdlLayer>();
    layer->group = group;
    layer->count = params.vdlCount;
    layer->tolerance = params.vdlTolerance;
    layer->vdls.resize(geometry.entries.size() * static_cast<std::size_t>(layer->count));
    layer->scalar.resize(geometry.entries.size());
    layer->noise.resize(geometry.entries.size());
    return layer;
}

void dropUnused(VdlLayer& layer)
{
    if (!(layer.tolerance > 0.0f)) return;
    std::vector<Vdl> used;
    std::vector<std::uint32_t> first{0};
    for (std::size_t e = 0; e < layer.scalar.size(); ++e) {
        for (const Vdl& vdl : layer.of(e)) {
            if (vdl.colour != glm::vec3(0.0f)) used.push_back(vdl);
        }
        first.push_back(static_cast<std::uint32_t>(used.size()));
    }
    used.shrink_to_fit();
    layer.vdls = std::move(used), layer.first = std::move(first);
}

LeafKernels LeafKernels::of(const OctreeGeometry& geometry, const PhotonMap& map, const SurfaceArea& area,
                            const BakeParams& params)
{
    LeafKernels kernels;
    if (geometry.depth <= params.octreeDepth) {
        kernels.usual = DensityKernel::of(params, map, area, geometry.cellSize());
        return kernels;
    }
    const float baseSize = geometry.rootSize / static_cast<float>(1u << params.octreeDepth);
    kernels.isDetail = true;
    kernels.usual = kernels.sparse = DensityKernel::of(params, map, area, baseSize);
    kernels.usual.cap = glm::min(kernels.usual.cap, kDetailRadius * geometry.cellSize());
    kernels.sparse.count = glm::min(kernels.sparse.count, kDetailPhotons);
    return kernels;
}

LayerFit::LayerFit(const OctreeGeometry& geometry, const PhotonMap& map, const SurfaceArea& area,
                   const BakeParams& params, VdlLayer& layer)
    : geometry_(geometry), map_(map), area_(area), form_(params.vdlForm), layer_(layer),
      kernels_(LeafKernels::of(geometry, map, area, params))
{
}

bool LayerFit::fit(std::uint32_t e, FitScratch& s) const
{
    const OctreeEntry& entry = geometry_.entries[e];
    const auto estimate = [&](const DensityKernel& kernel) {
        return estimateDensity(map_, area_, kernel, entry.centroid, entry.normal, s.gathered, geometry_.screensOf(e));
    };
    s.density = estimate(kernels_.usual);
    s.isFew = kernels_.isDetail && s.gathered.photons.size() < kernels_.sparse.count;
    if (s.isFew) {
        s.near = s.density;
        s.density = estimate(kernels_.sparse);
    }
    const Density& density = s.density;
    s.lights.resize(s.gathered.photons.size());
    const auto perFlux = static_cast<float>(density.perFlux);
    for (std::size_t i = 0; i < s.lights.size(); ++i) {
        const Photon& photon = map_.photon(s.gathered.photons[i]);
        // a photon's density already holds the cosine at its own surface (METHODS section 3): divide it out, except
        // in the form as printed
        const float cosine =
            form_ == VdlForm::corrected ? glm::max(glm::dot(photon.normal, photon.toLight), kLeastCosine) : 1.0f;
        s.lights[i] = {photon.toLight, photon.flux * (perFlux / cosine), luminance(photon.flux)};
    }
    const auto count = static_cast<std::size_t>(layer_.count);
    const std::span<Vdl> vdls = std::span(layer_.vdls).subspan(e * count, count);
    fitVdls(s.lights, entry.normal, form_, vdls, s.clusters);
    if (form_ == VdlForm::corrected) scaleTo(glm::vec3(density.lux), entry.normal, vdls);
    if (layer_.tolerance > 0.0f) spendVdls(vdls, entry.normal, form_, layer_.tolerance, s.clusters);
    layer_.scalar[e] = glm::vec3(density.lux);
    layer_.noise[e] = static_cast<float>(density.noise);
    return density.isDegenerate;
}

} // namespace lightloom
