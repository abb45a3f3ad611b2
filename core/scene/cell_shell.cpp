// SPDX-License-Identifier: Apache-2.0
#include "core/scene/shapes.h"
#include <array>
#include <cassert>
#include <map>
#include <unordered_map>

namespace lightloom {
namespace {

class ShellMaker {
public:
    explicit ShellMaker(const CellPlan& plan) : plan_(plan), planes_{&plan.xs, &plan.ys, &plan.zs}
    {
        for ([[maybe_unused]] const std::vector<float>* p : planes_) assert(p->size() >= 2);
    }

    std::vector<Mesh> make()
    {
        for (int axis = 0; axis < 3; ++axis) {
            const glm::ivec3 cells(count(0) - 1, count(1) - 1, count(2) - 1);
            glm::ivec3 faces = cells;
            ++faces[axis];
            for (int z = 0; z < faces.z; ++z) {
                for (int y = 0; y < faces.y; ++y) {
                    for (int x = 0; x < faces.x; ++x) visit(axis, {x, y, z});
                }
            }
        }
        std::vector<Mesh> found;
        for (auto& [material, part] : parts_) {
            part.mesh.material = material;
            found.push_back(std::move(part.mesh));
        }
        return found;
    }

private:
    struct Part {
        Mesh mesh;
        std::unordered_map<int, unsigned> vertexOf; // lattice point -> vertex, so that neighbours share it
    };

    int count(int axis) const { return static_cast<int>(planes_[static_cast<std::size_t>(axis)]->size()); }
    float plane(int axis, int i) const
    {
        return (*planes_[static_cast<std::size_t>(axis)])[static_cast<std::size_t>(i)];
    }
    float middle(int axis, int i) const { return 0.5f * (plane(axis, i) + plane(axis, i + 1)); }

    bool isAir(glm::ivec3 cell) const
    {
        for (int axis = 0; axis < 3; ++axis) {
            if (cell[axis] < 0 || cell[axis] >= count(axis) - 1) return plan_.airOutside;
        }
        return plan_.isAir({middle(0, cell.x), middle(1, cell.y), middle(2, cell.z)});
    }

    /// The face below `cell` along `axis`.
    void visit(int axis, glm::ivec3 cell)
    {
        glm::ivec3 below = cell;
        --below[axis];
        const bool airAbove = isAir(cell);
        if (airAbove == isAir(below)) return;
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        glm::vec3 centre, normal(0.0f);
        centre[axis] = plane(axis, cell[axis]);
        centre[u] = middle(u, cell[u]);
        centre[v] = middle(v, cell[v]);
        normal[axis] = airAbove ? 1.0f : -1.0f;
        Part& part = parts_[plan_.materialOf ? plan_.materialOf(centre, normal) : 0];
        std::array<unsigned, 4> corner{};
        for (int k = 0; k < 4; ++k) {
            glm::ivec3 at = cell;
            at[u] += k == 1 || k == 2;
            at[v] += k >= 2;
            corner[static_cast<std::size_t>(k)] = vertex(part, at);
        }
        if (!airAbove) std::swap(corner[1], corner[3]);
        part.mesh.triangles.emplace_back(corner[0], corner[1], corner[2]);
        part.mesh.triangles.emplace_back(corner[0], corner[2], corner[3]);
    }

    unsigned vertex(Part& part, glm::ivec3 at) const
    {
        const int key = (at.z * count(1) + at.y) * count(0) + at.x;
        const auto [entry, isNew] = part.vertexOf.try_emplace(key, static_cast<unsigned>(part.mesh.positions.size()));
        if (isNew) part.mesh.positions.emplace_back(plane(0, at.x), plane(1, at.y), plane(2, at.z));
        return entry->second;
    }

    const CellPlan& plan_;
    std::array<const std::vector<float>*, 3> planes_;
    std::map<int, Part> parts_;
};

} // namespace

std::vector<Mesh> cellShell(const CellPlan& plan) { return ShellMaker(plan).make(); }

} // namespace lightloom
