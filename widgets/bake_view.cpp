// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/bake_view.h"
#include "core/compare/field_noise.h"

namespace lightloom {

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
    const auto colours = octree->showing(OctreeShow::colour);
    view.colours = colours;
    Result<GpuOctree> gpu = makeGpuOctree(*octree);
    Result<GpuOctree> gpuOfColours = gpu ? makeGpuOctree(*colours) : gpu;
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
    view.problem.clear();
    return view;
}

} // namespace lightloom
