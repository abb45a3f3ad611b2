// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/picked_leaf.h"
#include "widgets/bake_view.h"

namespace lightloom {

PickedLeaf pickedLeaf(const BakeView& view, glm::vec3 p, glm::vec3 n)
{
    PickedLeaf out;
    out.field = view.snapshot.field;
    const auto octree = std::dynamic_pointer_cast<const LightOctree>(view.snapshot.field);
    if (!octree) return out;
    out.leaf = pickLeaf(*octree, p, n);
    if (!out.leaf || out.leaf->answers < 0 || !view.photons) return out;
    for (const auto& layer : octree->layers()) {
        if (!layer || gainOf(octree->mix(), layer->group) == glm::vec3(0.0f)) continue;
        const auto& map = view.photons->layers()[static_cast<std::size_t>(layer->group)].map;
        if (!map) continue;
        const std::vector<glm::vec3> some =
            gatheredPhotons(*octree, *out.leaf, out.leaf->answers, *map, *view.photons->area(), view.params);
        out.photons.insert(out.photons.end(), some.begin(), some.end());
    }
    return out;
}

} // namespace lightloom
