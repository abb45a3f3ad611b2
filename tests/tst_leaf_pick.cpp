// SPDX-License-Identifier: Apache-2.0
// Claims: what is told of a picked leaf is what the octree holds: its cell encloses the point, its entries' lights give
// the light that a lookup gives at the cell's centre, and the photons shown are those the bake gathered.
#include "bake_helpers.h"
#include "core/base/units.h"
#include "core/octree/leaf_pick.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/sample_scenes.h"
#include "light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

class LeafPickTest : public QObject {
    Q_OBJECT

    std::shared_ptr<const Scene> scene_;
    BakeParams params_;
    BakeProducts products_;
    std::shared_ptr<const LightOctree> octree_;
    std::optional<PhotonProducts> photons_;

private Q_SLOTS:
    void initTestCase()
    {
        scene_ = share(cornellBox());
        params_.photonCount = 60'000;
        params_.gatherCount = 100;
        params_.octreeFirstDepth = params_.octreeDepth = 5;
        OctreeSolver solver;
        const BakeJob job{scene_, params_, {}};
        octree_ = runSolver(solver, job, products_).octree();
        QVERIFY(octree_);
        Workers workers(2);
        BakeControl control(workers, {});
        const auto at = sceneProducts(job, products_, control);
        QVERIFY(at);
        photons_ = keptPhotons(job, *at, products_);
        QVERIFY(photons_ && photons_->maps[0]);
        BakeJob other = job;
        other.params.photonCount = 10;
        QVERIFY(!keptPhotons(other, *at, products_));
    }

    void pointsLieInTheirCell()
    {
        int picked = 0;
        for (const FacePoint& p : facePoints(*scene_, 500, 1)) {
            const auto leaf = pickLeaf(*octree_, p.position, p.normal);
            if (!leaf) continue;
            ++picked;
            const float slack = 0.011f * octree_->geometry().cellSize();
            QVERIFY(glm::all(glm::greaterThanEqual(p.position, leaf->low - slack)));
            QVERIFY(glm::all(glm::lessThanEqual(p.position, leaf->high + slack)));
            QVERIFY(!leaf->entries.empty());
            glm::vec3 lux(0.0f);
            QCOMPARE(leaf->isLit, octree_->lookup(p.position, p.normal, lux));
            QCOMPARE(leaf->lux, lux);
            for (std::size_t e = 0; e < leaf->entries.size(); ++e) {
                glm::vec3 sum(0.0f);
                for (const Vdl& vdl : leaf->entries[e].lights) {
                    QVERIFY(vdl.colour != glm::vec3(0.0f));
                    sum += vdl.colour * glm::max(0.0f, glm::dot(leaf->entries[e].surface.normal, vdl.toLight));
                }
                QCOMPARE(leaf->entries[e].lux, sum);
                const float facing = glm::dot(leaf->entries[e].surface.normal, p.normal);
                if (leaf->answers >= 0) {
                    const auto best = static_cast<std::size_t>(leaf->answers);
                    QVERIFY(facing <= glm::dot(leaf->entries[best].surface.normal, p.normal));
                } else {
                    QVERIFY(facing <= kCompatibleCosine);
                }
            }
        }
        QVERIFY(picked > 450);
    }

    void theCentreOfACellIsItsEntry()
    {
        const OctreeGeometry& geometry = octree_->geometry();
        for (std::size_t i = 0; i < geometry.cells.size(); i += 11) {
            const glm::vec3 n = geometry.entries[geometry.firstEntry[i]].normal;
            const auto leaf = pickLeaf(*octree_, geometry.entries[geometry.firstEntry[i]].centroid, n);
            QVERIFY(leaf);
            glm::vec3 lux(0.0f);
            QVERIFY(octree_->lookup(0.5f * (leaf->low + leaf->high), n, lux));
            const PickedEntry& entry = leaf->entries[static_cast<std::size_t>(leaf->answers)];
            QVERIFY(glm::length(entry.lux - lux) <= 1e-3f * glm::length(lux) + 1e-6f);
        }
    }

    void photonsAreTheBakesOwn()
    {
        int shown = 0;
        for (const FacePoint& p : facePoints(*scene_, 60, 2)) {
            const auto leaf = pickLeaf(*octree_, p.position, p.normal);
            if (!leaf || leaf->answers < 0) continue;
            const auto found =
                gatheredPhotons(*octree_, *leaf, leaf->answers, *photons_->maps[0], *photons_->area, params_);
            QVERIFY(!found.empty() && found.size() <= 2 * static_cast<std::size_t>(params_.gatherCount));
            // all near: nothing further than the furthest gathered one of as many is left out of brute force
            const glm::vec3 centre = leaf->entries[static_cast<std::size_t>(leaf->answers)].surface.centroid;
            float most = 0.0f;
            for (const glm::vec3 at : found) most = glm::max(most, glm::length(at - centre));
            QVERIFY(most <= 0.5f * scene_->bounds.longestSide());
            ++shown;
        }
        QVERIFY(shown > 40);
    }

    void nothingInMidAir()
    {
        QVERIFY(!pickLeaf(*octree_, scene_->bounds.high + 100.0f, {0, 1, 0}));
        QVERIFY(!pickLeaf(*octree_, glm::vec3(std::nanf("")), {0, 1, 0}));
        QVERIFY(!pickLeaf(*octree_, glm::mix(scene_->bounds.low, scene_->bounds.high, glm::vec3(0.5f, 0.75f, 0.8f)),
                          {0, 1, 0}));
    }
};

QTEST_APPLESS_MAIN(LeafPickTest)
#include "tst_leaf_pick.moc"
