// SPDX-License-Identifier: Apache-2.0
#include "core/bake/voxel_volume.h"
#include "core/bake/volume_file.h"
#include "core/base/units.h"
#include "core/trace/cell_clip.h"
#include "core/voxel/voxel_field.h"

namespace lightloom {
namespace {

class VolumeMaker {
public:
    VolumeMaker(const VoxelField& field, const Scene& scene, VdbFile& file)
        : leaves_(*field.surface().leaves),
          file_(file), lattice_{scene.toFile(leaves_.lowest), glm::dvec3(double(leaves_.cellSize()))}
    {
        for (const std::uint64_t cell : leaves_.cells) cells_.emplace_back(mortonCell(cell));
    }

    /// valueOf(entry): mean over each voxel's entries, by area.
    template<class ValueOf>
    void addMean(const std::string& name, const ValueOf& valueOf)
    {
        std::vector<decltype(valueOf(0u))> values;
        for (std::size_t v = 0; v < cells_.size(); ++v) {
            auto sum = 0.0f * valueOf(leaves_.firstEntry[v]);
            float area = 0.0f;
            for (std::uint32_t e = leaves_.firstEntry[v]; e < leaves_.firstEntry[v + 1]; ++e) {
                sum += leaves_.entries[e].area * valueOf(e);
                area += leaves_.entries[e].area;
            }
            values.push_back(area > 0.0f ? sum / area : valueOf(leaves_.firstEntry[v]));
        }
        file_.add(name, lattice_, cells_, std::span(std::as_const(values)));
    }

    void addAreas()
    {
        std::vector<float> areas;
        std::vector<glm::vec3> normals;
        for (std::size_t v = 0; v < cells_.size(); ++v) {
            areas.push_back(0.0f);
            for (std::uint32_t e = leaves_.firstEntry[v]; e < leaves_.firstEntry[v + 1]; ++e)
                areas.back() += leaves_.entries[e].area;
            normals.push_back(leaves_.entries[leaves_.firstEntry[v]].normal); // the largest comes first
        }
        file_.add("area", lattice_, cells_, std::span(std::as_const(areas)));
        file_.add("normal", lattice_, cells_, std::span(std::as_const(normals)));
    }

private:
    const OctreeGeometry& leaves_;
    VdbFile& file_;
    VdbFile::Lattice lattice_;
    std::vector<glm::ivec3> cells_;
};

} // namespace

Result<std::vector<std::uint8_t>> voxelVolume(const VoxelField& field, const BakeInfo& info, const Scene& scene)
{
    return volumeBytes(info, [&](VdbFile& file) {
        VolumeMaker volume(field, scene, file);
        volume.addMean("irradiance", [&](std::uint32_t e) { return field.octree().mixedColour({e, 0}); });
        volume.addMean("irradiance_direct", [&](std::uint32_t e) { return field.direct(e); });
        volume.addMean("illuminance", [&](std::uint32_t e) { return luminance(field.illuminance(e)); });
        volume.addMean("radiosity", [&](std::uint32_t e) { return field.exitance(e); });
        volume.addMean("albedo", [&](std::uint32_t e) { return field.surface().albedo[e]; });
        volume.addAreas();
    });
}

} // namespace lightloom
