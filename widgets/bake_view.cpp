// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/bake_view.h"
#include "core/compare/field_noise.h"
#include "core/octree/detail_union.h"

namespace lightloom {

namespace {

struct Textures {
    Result<GpuOctree> lights, colours;
    QString remark; ///< if the deepest leaves were left out
};

/// The octree as textures; without its deepest leaves where these are too many.
Textures texturesOf(std::shared_ptr<const LightOctree> octree)
{
    const std::size_t all = octree->deeper().size();
    while (true) {
        Result<GpuOctree> lights = makeGpuOctree(*octree);
        Result<GpuOctree> colours = lights ? makeGpuOctree(*octree->showing(OctreeShow::colour)) : lights;
        const std::size_t levels = octree->deeper().size();
        if (colours || levels == 0) {
            QString remark;
            if (levels < all)
                remark = QStringLiteral("Leaves deeper than %1 are too many for the viewport, which shows those above.")
                             .arg(octree->geometry().depth + static_cast<int>(levels));
            return {std::move(lights), std::move(colours), remark};
        }
        octree = octree->withDetail(levels - 1);
    }
}

} // namespace

BakeView withMix(BakeView view, const Mix& mix, std::uint64_t mixSerial)
{
    view.mixSerial = mixSerial;
    view.snapshot.field = view.snapshot.field->withMix(mix);
    if (view.photons) view.photons = std::static_pointer_cast<const PhotonMapField>(view.photons->withMix(mix));
    view.noise = view.noisePoints ? statedNoise(*view.snapshot.field, *view.noisePoints) : std::nullopt;
    const auto octree = std::dynamic_pointer_cast<const LightOctree>(view.snapshot.field);
    if (!octree) {
        view.problem = QStringLiteral("This viewport cannot show the method %1.")
                           .arg(QString::fromStdString(std::string(view.snapshot.field->method())));
        return view;
    }
    view.colours = octree->showing(OctreeShow::colour);
    Textures textures = texturesOf(octree);
    Result<GpuOctree>& gpu = textures.lights;
    Result<GpuOctree>& gpuOfColours = textures.colours;
    if (!gpuOfColours) {
        view.gpu.reset();
        view.gpuOfColours.reset();
        view.problem = QString::fromStdString(gpuOfColours.error().message);
        return view;
    }
    view.leaves = gpu->leafCount;
    view.entries = gpu->entryCount;
    view.gpu = std::make_shared<const GpuOctree>(std::move(*gpu));
    view.gpuOfColours = std::make_shared<const GpuOctree>(std::move(*gpuOfColours));
    view.problem = std::move(textures.remark);
    return view;
}

} // namespace lightloom
