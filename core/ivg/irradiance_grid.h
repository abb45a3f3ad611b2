// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/indirect_field.h"
#include "core/ivg/grid_corners.h"

namespace lightloom {

/// How a grid is looked up: no bake is needed to change it.
struct GridShow {
    GridRemap remap = GridRemap::joined;
    GridFilter filter = GridFilter::trilinear;
    float offset = 0.5f; ///< cells along the normal
    bool operator==(const GridShow&) const = default;
};

class IrradianceGrid;

/// A finer grid within a grid. Inside the box it answers; towards the box's faces it fades into the outer grid, over
/// `fade` metres, so that no edge shows.
struct GridInside {
    std::shared_ptr<const IrradianceGrid> grid; ///< null: there is none
    Bounds box;                                 ///< scene space, within the finer lattice
    float fade = 0.0f;
    /// Part of the finer grid in the light at `p`: 0 outside the box, 1 where no face is near; smooth.
    [[nodiscard]] float weight(glm::vec3 p) const;
};

/// Irradiance vectors of all light groups on one lattice, mixed, as a field of light in space: it answers for any
/// surface anywhere in the grid, also for one that was not there when it was baked. O(1): 8 reads, or 64 for tricubic.
class IrradianceGrid final : public IndirectField {
public:
    /// `layers` by light group; null where a lamp is off.
    IrradianceGrid(std::shared_ptr<const GridGeometry> geometry, std::vector<std::shared_ptr<const GridLayer>> layers,
                   GridEstimator estimator, Mix mix, GridShow show);

    /// False outside the grid by more than a cell, and where every vertex around lies behind walls as seen from there.
    [[nodiscard]] bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override;
    [[nodiscard]] std::optional<float> noise(glm::vec3 p, glm::vec3 n) const override;
    [[nodiscard]] std::shared_ptr<const IndirectField> withMix(Mix mix) const override;
    [[nodiscard]] std::shared_ptr<const IrradianceGrid> withShow(GridShow show) const;
    /// With a finer grid of the same lamps inside.
    [[nodiscard]] std::shared_ptr<const IrradianceGrid> withInside(GridInside inside) const;
    [[nodiscard]] std::string_view method() const override { return "irradiance-grid"; }
    [[nodiscard]] std::size_t memoryBytes() const override; ///< with geometry, layers and the grid inside
    /// Of the mix alone.
    [[nodiscard]] static std::size_t bytesPerVertex(GridRemap remap);

    /// The six vectors of a vertex under the mix.
    [[nodiscard]] IrradianceVectors mixedVectors(std::size_t vertex) const;
    [[nodiscard]] const GridGeometry& geometry() const { return *geometry_; }
    [[nodiscard]] const std::vector<std::shared_ptr<const GridLayer>>& layers() const { return layers_; }
    [[nodiscard]] GridEstimator estimator() const { return estimator_; }
    [[nodiscard]] const GridShow& show() const { return show_; }
    [[nodiscard]] const GridInside& inside() const { return inside_; }
    /// By direction, of the luminance of I_delta . delta under the mix, lux^2.
    [[nodiscard]] const std::array<float, 6>& variance(std::size_t vertex) const { return variance_[vertex]; }

    /// Vertices that a lookup reads, and their parts of it before what is open there is asked for. False: none.
    [[nodiscard]] bool findCorners(glm::vec3 p, glm::vec3 n, GridCorners& corners) const;

    // what lookups read, of the mix
    [[nodiscard]] std::span<const glm::vec3> keptAt(std::size_t vertex) const ///< keepForRemap's numbers
    {
        const std::size_t size = remapSize(show_.remap);
        return {kept_.data() + vertex * size, size};
    }
    /// Weight of a part of the remap at a vertex, from what is open there.
    [[nodiscard]] float trust(std::size_t vertex, std::size_t part) const { return trust_[vertex * parts() + part]; }
    /// By direction: lux per cell along it. Remaps `joined` and `flux` only.
    [[nodiscard]] const std::array<glm::vec3, 6>& slopes(std::size_t vertex) const { return slopes_[vertex]; }

private:
    void mixLayers();
    void findSlopes();
    [[nodiscard]] std::array<glm::vec3, 6> slopesAt(std::size_t vertex,
                                                    std::span<const std::array<glm::vec3, 6>> flux) const;
    void weigh();
    void spread();
    [[nodiscard]] bool blend(const GridCorners& corners, glm::vec3 p, glm::vec3 n, glm::vec3& lux) const;
    [[nodiscard]] bool ownLookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const;
    [[nodiscard]] std::optional<float> ownNoise(glm::vec3 p, glm::vec3 n) const;
    [[nodiscard]] bool hasSlopes() const { return show_.remap == GridRemap::joined || show_.remap == GridRemap::flux; }

    [[nodiscard]] std::size_t parts() const { return parts_.size(); }

    std::shared_ptr<const GridGeometry> geometry_;
    std::vector<std::shared_ptr<const GridLayer>> layers_;
    GridEstimator estimator_;
    Mix mix_;
    GridShow show_;
    std::span<const RemapPart> parts_;             ///< of show_.remap
    std::vector<glm::vec3> kept_;                  ///< by vertex: what the remap keeps of the mixed vectors
    std::vector<float> trust_;                     ///< by vertex and part: open share, 0 where too little is open
    std::vector<std::array<glm::vec3, 6>> slopes_; ///< by vertex and direction: of I_delta . delta along it, per cell
    std::vector<std::array<float, 6>> variance_;   ///< by vertex, of the mix
    GridInside inside_;
};

} // namespace lightloom
