// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/rng.h"
#include "core/trace/cell_clip.h"
#include "core/trace/ray_scene.h"
#include <functional>

namespace lightloom {

/// The sides of a scene's triangles as elements that light reaches or not as a whole: large triangles fall into their
/// cells of a lattice, small ones that share an edge belong together as far as their surface goes.
class SideElements {
public:
    /// `depth`: of the lattice over the scene, 2^depth cells along its longest side. O(n log n) on all workers. Null:
    /// stopped.
    static std::unique_ptr<const SideElements> build(const RayScene& rays, int depth, Workers& workers,
                                                     const std::stop_token& stop);

    [[nodiscard]] std::uint32_t count() const { return count_; }
    [[nodiscard]] std::uint32_t of(const Hit& hit) const;
    /// A point on the element, off its edges, and the normal of its side. False: the point that came up is too
    /// near an edge, or the element has no area.
    [[nodiscard]] bool sample(std::uint32_t element, Rng& rng, glm::vec3& p, glm::vec3& n) const;
    /// Whether a point of the element, moved off its surface (`RayScene::leave`), can lie before one that faces `n` at
    /// `p` and see it before itself. Cheap; true where it is not sure, and always for elements of small triangles.
    [[nodiscard]] bool canFace(std::uint32_t element, glm::vec3 p, glm::vec3 n) const;
    /// Whether a point within `box` can lie before the element. Cheaper still, and true where it is not sure.
    [[nodiscard]] bool mayFace(std::uint32_t element, const Bounds& box) const;
    /// Adds the facets of the elements for which `isReached`, in rising order of sides; large triangles that are
    /// reached as a whole stay whole. `joined` gets those of the others again, cells joined to larger ones as far as
    /// all of these are reached. False: stopped.
    [[nodiscard]] bool listFacets(const std::function<bool(std::uint32_t)>& isReached, const std::stop_token& stop,
                                  std::vector<ReachedFacet>& facets, std::vector<ReachedFacet>& joined) const;

private:
    struct Part { // of a large triangle's side
        std::uint64_t cell;
        std::uint32_t element;
        std::uint32_t firstCorner, corners;
    };
    struct Range {
        std::uint32_t first = 0, count = 0; // parts; count 0: a small triangle, `first` is its element
    };
    [[nodiscard]] bool isLarge(const SceneTriangle& t) const;
    SideElements(const RayScene& rays, int depth);
    [[nodiscard]] glm::vec3 normalOf(std::uint32_t side) const
    {
        return rays_.triangleNormal(side / 2) * (side % 2 ? -1.0f : 1.0f);
    }
    void cut(std::uint32_t triangle);
    void addJoined(std::uint32_t side, const std::function<bool(std::uint32_t)>& isReached,
                   std::vector<ReachedFacet>& joined) const;
    void addSmall(std::uint32_t side, std::uint32_t& element); ///< to its surface's element, made at the first of them

    const RayScene& rays_;
    CellLattice lattice_;
    std::uint32_t count_ = 0;
    std::vector<Range> sides_;
    std::vector<Part> parts_;                         // of one side together, sorted by cell
    std::vector<glm::vec3> corners_;                  // of the parts' polygons
    std::vector<std::vector<std::uint32_t>> members_; // per element: a part's index, or sides of small triangles
    std::vector<std::uint8_t> isPart_;                // per element: which of the two
};

} // namespace lightloom
