// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"
#include "core/octree/octree_solver.h"
#include <memory>
#include <string>
#include <vector>

/// What tests of bakes share: run a solver to its end and keep what it published.
namespace lightloom::test {

struct Baked {
    std::shared_ptr<const IndirectField> field; ///< the last snapshot's
    std::vector<Snapshot> snapshots;
    WorkCounters counters;
    std::string error; ///< empty: done

    [[nodiscard]] std::shared_ptr<const LightOctree> octree() const
    {
        return std::dynamic_pointer_cast<const LightOctree>(field);
    }
};

inline Baked runSolver(Solver& solver, const BakeJob& job, BakeProducts& products, int threads = 2)
{
    Workers workers(threads);
    Baked result;
    BakeControl control(workers, {[&](Snapshot s) {
                                      result.field = s.field;
                                      result.snapshots.push_back(std::move(s));
                                  },
                                  {}});
    products.beginRound();
    const Result<Done> done = solver.bake(job, products, control);
    if (!done) result.error = done.error().message;
    result.counters = products.counters;
    return result;
}

inline Baked bakeOctree(std::shared_ptr<const Scene> scene, const BakeParams& params, int threads = 2, Mix mix = {})
{
    OctreeSolver solver;
    BakeProducts products;
    return runSolver(solver, {std::move(scene), params, std::move(mix)}, products, threads);
}

inline std::shared_ptr<const Scene> share(Scene scene) { return std::make_shared<const Scene>(std::move(scene)); }

} // namespace lightloom::test
