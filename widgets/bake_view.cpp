// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/bake_view.h"
#include "core/compare/field_noise.h"

namespace lightloom {

BakeView withMix(BakeView view, const Mix& mix, std::uint64_t mixSerial)
{
    view.mixSerial = mixSerial;
    view.snapshot.field = view.snapshot.field->withMix(mix);
    view.noise = view.noisePoints ? statedNoise(*view.snapshot.field, *view.noisePoints) : std::nullopt;
    const auto octree = std::dynamic_pointer_cast<const LightOctree>(view.snapshot.field);
    if (!octree) {
        view.problem = QStringLiteral("This viewport cannot show the method %1.")
                           .arg(QString::fromStdString(std::string(view.snapshot.field->method())));
        return view;
    }
    Result<GpuOctree> gpu = makeGpuOctree(*octree);
    if (!gpu) {
        view.gpu.reset();
        view.problem = QString::fromStdString(gpu.error().message);
        return view;
    }
    view.leaves = gpu->leafCount;
    view.entries = gpu->entryCount;
    view.gpu = std::make_shared<const GpuOctree>(std::move(*gpu));
    view.problem.clear();
    return view;
}

} // namespace lightloom
