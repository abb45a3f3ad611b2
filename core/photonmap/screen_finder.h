// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/sampling.h"
#include "core/photonmap/surface_area.h"
#include "core/trace/ray_scene.h"

namespace lightloom {

/// What stands around a gather kernel's centre. Walls part the surface of a plane: light in front of one says nothing
/// of the light behind it, and without screens it leaks along floors, ceilings and walls however thick the wall is.
/// Any thread may ask.
class ScreenFinder {
public:
    /// All three are kept by reference.
    ScreenFinder(const RayScene& rays, const LightReach& reach, const SurfaceArea& area);

    /// Appends the screens of a kernel around `p`, on a surface facing `n` (unit), that hide reached surface within
    /// `radius`. Walls are looked for in 16 directions, `height` above the surface or half way to what lies over it.
    /// What lies over and under it hides all beyond.
    /// False: `p` is buried: most ways lead to sides that light does not reach.
    [[nodiscard]] bool find(glm::vec3 p, glm::vec3 n, float height, float radius, std::vector<Screen>& out) const;

    /// Whether a wall hides reached surface within `radius` of such a kernel.
    [[nodiscard]] bool isAnyHidden(const Screen& screen, glm::vec3 p, glm::vec3 n, float radius) const;

    /// How thick the wall is that is met from a little above `p` along `travel` (unit); 0: no solid one as thick as
    /// `most` within `far`.
    [[nodiscard]] float thicknessOf(glm::vec3 p, glm::vec3 n, float height, glm::vec3 travel, float far,
                                    float most) const;

    /// What walls make of a surface facing `n` through `p` within a box: parts that see nothing of each other, largest
    /// first; what is buried belongs to none.
    struct SeenPart {
        glm::vec3 middle; ///< on the surface
        std::size_t size; ///< in places of a raster
    };
    [[nodiscard]] std::vector<SeenPart> seenParts(glm::vec3 p, glm::vec3 n, float height,
                                                  const BoxGroups::Box& within) const;

private:
    static constexpr std::size_t kDirections = 16;
    struct Sight;
    struct Place {
        glm::vec3 on, above; ///< the surface
    };
    [[nodiscard]] std::vector<Place> seenPlaces(glm::vec3 p, glm::vec3 n, float height,
                                                const BoxGroups::Box& within) const;
    [[nodiscard]] bool isReached(const Hit& hit) const
    {
        return isReached_[2 * std::size_t(hit.triangle) + (hit.isFront ? 0 : 1)];
    }
    [[nodiscard]] glm::vec3 lifted(glm::vec3 p, glm::vec3 n, float height) const;
    void addSlab(glm::vec3 p, glm::vec3 n, float height, float radius, std::vector<Screen>& out) const;
    /// False: buried.
    [[nodiscard]] bool lookAround(glm::vec3 from, const Frame& frame, std::array<Sight, kDirections>& sights) const;

    const RayScene& rays_;
    const SurfaceArea& area_;
    std::vector<bool> isReached_; // by side
};

} // namespace lightloom
