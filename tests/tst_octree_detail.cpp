// SPDX-License-Identifier: Apache-2.0
// Claims: leaves split where the light calls for it and hardly where it does not; what is split tiles its parent; there
// is no seam between depths; pixels, files and picks see the same leaves; a lamp's leaves depend on its own photons
// alone, bit for bit, on any number of threads.
#include "core/bake/bake_file.h"
#include "core/bake/packed_octree.h"
#include "core/base/units.h"
#include "core/octree/detail_level.h"
#include "core/octree/detail_union.h"
#include "core/octree/leaf_pick.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/trace/cell_clip.h"
#include "tests/bake_helpers.h"
#include <QtTest>
#include <cmath>
#include <cstring>
#include <map>

using namespace lightloom;
using namespace lightloom::test;

namespace {

bool sameBits(const DetailLevel& a, const DetailLevel& b)
{
    const auto same = [](const auto& x, const auto& y) {
        return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
    };
    return a.geometry->cells == b.geometry->cells && a.geometry->firstEntry == b.geometry->firstEntry &&
           same(a.geometry->entries, b.geometry->entries) && same(a.layer->vdls, b.layer->vdls) &&
           same(a.layer->scalar, b.layer->scalar) && same(a.layer->noise, b.layer->noise);
}

bool sameBits(const LampDetail& a, const LampDetail& b)
{
    bool same = a.size() == b.size();
    for (std::size_t l = 0; same && l < a.size(); ++l) same = sameBits(a[l], b[l]);
    return same;
}

BakeParams ringParams()
{
    BakeParams params;
    params.photonCount = 200'000;
    params.gatherCount = 150;
    params.octreeFirstDepth = params.octreeDepth = 5;
    return params;
}

/// caustic_ring with a second lamp over the table.
Scene twoLamps()
{
    Scene scene = causticRing();
    PunctualLight lamp;
    lamp.position = {0.1f, 0.7f, -0.1f};
    lamp.intensity = {30.0f, 20.0f, 10.0f};
    lamp.node = "Second";
    scene.lights.push_back(lamp);
    finishScene(scene, {});
    return scene;
}

std::size_t leavesBelow(const LightOctree& octree)
{
    std::size_t count = 0;
    for (const UnionLevel& level : octree.deeper()) count += level.geometry.cells.size();
    return count;
}

} // namespace

class OctreeDetailTest : public QObject {
    Q_OBJECT

    std::shared_ptr<const Scene> ring_;
    std::shared_ptr<const LightOctree> octree_;

    void checkTiling(const LightOctree& octree, bool mayLack)
    {
        const OctreeGeometry* above = &octree.geometry();
        QCOMPARE(octree.deeper().size(), std::size_t(2));
        for (const UnionLevel& level : octree.deeper()) {
            std::map<std::uint64_t, double> areas; // of parents, by their children
            const OctreeGeometry& g = level.geometry;
            QCOMPARE(g.depth, above->depth + 1);
            for (std::size_t i = 0; i < g.cells.size(); ++i) {
                for (std::uint32_t e = g.firstEntry[i]; e < g.firstEntry[i + 1]; ++e)
                    areas[g.cells[i] >> 3] += double(g.entries[e].area);
            }
            for (const auto& [cell, area] : areas) {
                const std::int64_t parent = above->leafAt(glm::ivec3(mortonCell(cell)));
                QVERIFY(parent >= 0 && above != &g && g.splits(glm::ivec3(mortonCell(cell))));
                double whole = 0.0;
                const auto i = static_cast<std::size_t>(parent);
                for (std::uint32_t e = above->firstEntry[i]; e < above->firstEntry[i + 1]; ++e)
                    whole += double(above->entries[e].area);
                QVERIFY2(area / whole <= 1.0 + 1e-4 && (mayLack || area / whole >= 1.0 - 1e-4),
                         qPrintable(QString("%1 of %2").arg(area).arg(whole)));
            }
            above = &g;
        }
    }

private Q_SLOTS:
    void initTestCase()
    {
        ring_ = share(causticRing());
        const Baked baked = bakeOctree(ring_, ringParams());
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        octree_ = baked.octree();
        QCOMPARE(octree_->deeper().size(), std::size_t(2)); // the caustics
        QCOMPARE(baked.counters.leaves, std::uint64_t(octree_->geometry().cells.size() + leavesBelow(*octree_)));
    }

    void splitLeavesTileTheirParents()
    {
        BakeParams params = ringParams();
        params.gatherScreens = Switch::off; // buried leaves stay
        checkTiling(*bakeOctree(ring_, params).octree(), false);
        checkTiling(*octree_, true);
    }

    void noSeamsBetweenDepths()
    {
        const auto lux = [&](float x, float z) {
            return double(luminance(octree_->irradiance(ring_->toScene(glm::dvec3(x, 0.0, z)), {0, 1, 0})));
        };
        const double leaf = std::ldexp(double(octree_->geometry().rootSize), -octree_->geometry().depth - 2);
        const float step = float(leaf / 200.0);
        double most = 0.0, steepest = 0.0, steepestLarge = 0.0;
        for (int i = 0; i < 20'000; ++i) { // through both caustics, the ring's and the ball's
            const float x = -0.35f + step * float(i), z = 0.45f - 0.6f * (x + 0.35f);
            if (x > 0.35f) break;
            const double here = lux(x, z);
            most = std::max(most, here);
            steepest = std::max(steepest, std::abs(lux(x + step, z) - here) / double(step));
            steepestLarge = std::max(steepestLarge, std::abs(lux(x + 100 * step, z) - here) / double(100 * step));
        }
        // a seam of a hundredth of the peak would make the slope over one step twice the peak per leaf
        qInfo("steepest: %.0f lx/m, over half a leaf %.0f; peak %.0f lx", steepest, steepestLarge, most);
        QVERIFY(steepest <= 4.0 * steepestLarge);
        QVERIFY(steepest * double(step) <= 0.01 * most);
    }

    void levelsAreBlended() // by hand: where a cell is split, its children; where it is not, what stands above
    {
        auto base = std::make_shared<OctreeGeometry>();
        base->depth = 1, base->rootSize = 2.0f; // cells of 1 m
        auto layer = std::make_shared<VdlLayer>();
        auto children = std::make_shared<OctreeGeometry>();
        children->depth = 2, children->rootSize = 2.0f;
        auto fine = std::make_shared<VdlLayer>();
        const auto add = [](OctreeGeometry& g, VdlLayer& l, glm::uvec3 cell, float lux) {
            g.cells.push_back(mortonCode(cell));
            g.firstEntry.push_back(std::uint32_t(g.entries.size()));
            g.entries.push_back({(glm::vec3(cell) + 0.5f) * g.cellSize(), {0, 1, 0}, 1.0f});
            l.vdls.push_back({glm::vec3(lux), {0, 1, 0}});
            l.scalar.emplace_back(lux);
            l.noise.push_back(0.1f * lux);
        };
        add(*base, *layer, {0, 0, 0}, 10.0f), add(*base, *layer, {1, 0, 0}, 20.0f);
        for (const unsigned z : {0u, 1u}) // of the second cell, its floor
            for (const unsigned x : {2u, 3u}) add(*children, *fine, {x, 0, z}, x == 2 ? 30.0f : 50.0f);
        base->firstEntry.push_back(2), children->firstEntry.push_back(4);
        const auto detail = std::make_shared<LampDetail>(LampDetail{{children, fine}});
        const LightOctree octree(base, {layer}, VdlForm::corrected, {}, OctreeShow::lights, {detail});
        const auto at = [&](float x) { return double(octree.irradiance({x, 0.25f, 0.5f}, {0, 1, 0}).x); };
        const double above = 10.0 + 10.0 * (0.9 - 0.5); // of the level above at x = .9
        QVERIFY(std::abs(at(0.2f) - 10.0) <= 1e-4);     // no child near
        QVERIFY(std::abs(at(1.5f) - 40.0) <= 1e-4);     // between both children
        QVERIFY(std::abs(at(0.9f) - (0.3 * 30.0 + 0.7 * above)) <= 1e-4);
        QVERIFY(std::abs(at(0.75f) - 12.5) <= 1e-4); // where children begin to count
        QVERIFY(std::abs(double(*octree.noise({1.5f, 0.25f, 0.5f}, {0, 1, 0})) - 4.0) <= 1e-4);
        const auto packed = makeGpuOctree(octree);
        QVERIFY(packed);
        QCOMPARE(packed->deepest, 2);
        QCOMPARE(packed->leafCount, std::uint64_t(6));
        for (float x = 0.05f; x < 2.0f; x += 0.05f) {
            const double pixel = double(packedIlluminance(*packed, {x, 0.25f, 0.5f}, {0, 1, 0}).value().x);
            QVERIFY2(std::abs(pixel - at(x)) <= 2e-3 * at(x),
                     qPrintable(QString("%1: %2, %3").arg(x).arg(pixel).arg(at(x))));
        }
    }

    void pixelsSeeTheSameLeaves() // halves and 8-bit directions aside
    {
        const auto packed = makeGpuOctree(*octree_);
        QVERIFY(packed);
        QCOMPARE(packed->deepest, octree_->geometry().depth + 2);
        std::vector<double> apart;
        double mean = 0.0;
        for (const UnionLevel& level : octree_->deeper()) {
            for (std::size_t e = 0; e < level.geometry.entries.size(); e += 5) {
                const OctreeEntry& at = level.geometry.entries[e];
                const glm::vec3 exact = octree_->irradiance(at.centroid, at.normal);
                const auto pixel = packedIlluminance(*packed, at.centroid, at.normal);
                QVERIFY(pixel);
                apart.push_back(double(std::abs(luminance(*pixel) - luminance(exact))));
                mean += double(luminance(exact));
            }
        }
        mean /= double(apart.size());
        std::ranges::sort(apart);
        QVERIFY(apart[apart.size() / 2] <= 1e-3 * mean);
        QVERIFY2(apart[apart.size() * 99 / 100] <= 2e-2 * mean, qPrintable(QString::number(apart.back() / mean)));
    }

    void evenLightSplitsHardlyAnything()
    {
        BakeParams params;
        params.octreeFirstDepth = params.octreeDepth = 5;
        const auto octree = bakeOctree(share(furnaceBox(0.5f)), params).octree();
        QVERIFY(octree);
        QVERIFY2(leavesBelow(*octree) * 50 <= octree->geometry().cells.size(),
                 qPrintable(QString("%1 below %2").arg(leavesBelow(*octree)).arg(octree->geometry().cells.size())));
    }

    void gapsLoseWhatIsMissing() // by hand: three parents, far apart but for the last two
    {
        auto geometry = std::make_shared<OctreeGeometry>();
        geometry->depth = 5;
        auto layer = std::make_shared<VdlLayer>();
        DetailCandidates level;
        for (const glm::uvec3 cell : {glm::uvec3(1), glm::uvec3(9), glm::uvec3(10, 9, 9)})
            level.parents.push_back(mortonCode(cell));
        std::ranges::sort(level.parents);
        for (std::uint32_t i = 0; i < 3; ++i) {
            geometry->cells.push_back(level.parents[i] << 3);
            geometry->firstEntry.push_back(2 * i);
            for (int e = 0; e < 2; ++e) {
                geometry->entries.push_back({});
                layer->vdls.push_back({glm::vec3(8.0f), {0.0f, 1.0f, 0.0f}});
                layer->scalar.push_back(glm::vec3(8.0f)), layer->noise.push_back(2.0f);
            }
        }
        geometry->firstEntry.push_back(6);
        level.geometry = geometry, level.layer = layer;
        level.gain.resize(6);
        level.few = {{1.0f, 20.0f}, {0.0f, 0.0f}, {19.0f, 20.0f}, {19.0f, 20.0f}, {0.0f, 20.0f}, {0.0f, 20.0f}};
        darken(level, {});
        // 1 - D/M (1 - M / (2 D^2)), at a tenth of the neighbour each
        const auto left = [](double found, double expected) {
            const double less = expected - found;
            return float(1.0 - less / expected * std::max(0.0, 1.0 - 0.5 * expected / (less * less)));
        };
        const std::array<float, 6> expected{left(1, 20),  1.0f,          left(38, 44),
                                            left(38, 44), left(3.8, 44), left(3.8, 44)};
        for (std::size_t e = 0; e < 6; ++e) {
            const float of = expected[e];
            QVERIFY(std::abs(layer->scalar[e].y - 8.0f * of) <= 1e-5f &&
                    std::abs(layer->vdls[e].colour.x - 8.0f * of) <= 1e-5f &&
                    std::abs(layer->noise[e] - 2.0f * of) <= 1e-5f);
        }
        QVERIFY(left(38, 44) > 0.9f && left(3.8, 44) < 0.15f);
    }

    void whatIsAboveDoesNotDependOnIt()
    {
        BakeParams params = ringParams();
        BakeProducts products;
        OctreeSolver solver;
        const auto with = runSolver(solver, {ring_, params, {}}, products);
        params.octreeDetail = 0;
        const auto without = runSolver(solver, {ring_, params, {}}, products);
        QVERIFY(with.octree() && without.octree());
        QVERIFY(without.octree()->deeper().empty());
        QCOMPARE(with.octree()->layers()[0].get(), without.octree()->layers()[0].get()); // kept, not fitted again
        QCOMPARE(without.counters.gathers, std::uint64_t(0));
        params.octreeDetail = 1;
        const auto one = runSolver(solver, {ring_, params, {}}, products);
        QCOMPARE(one.octree()->deeper().size(), std::size_t(1));
        QCOMPARE(one.counters.photonsShot, std::uint64_t(0));
    }

    void lampsAreTheirOwn()
    {
        const auto scene = share(twoLamps());
        BakeParams params = ringParams();
        const glm::vec3 on(1.0f), off(0.0f);
        const auto both = bakeOctree(scene, params, 2).octree(), a = bakeOctree(scene, params, 1, {on, off}).octree(),
                   b = bakeOctree(scene, params, 5, {off, on}).octree();
        QVERIFY(both && a && b);
        QVERIFY(!both->detail(0).empty() && !both->detail(1).empty());
        QVERIFY(sameBits(both->detail(0), a->detail(0)) && sameBits(both->detail(1), b->detail(1)));
        QVERIFY(a->detail(1).empty());
        for (const UnionLevel& level : both->deeper()) {
            for (std::size_t e = 0; e < level.geometry.entries.size(); e += 11) {
                const OctreeEntry& at = level.geometry.entries[e];
                const glm::vec3 sum = a->irradiance(at.centroid, at.normal) + b->irradiance(at.centroid, at.normal);
                const glm::vec3 whole = both->irradiance(at.centroid, at.normal);
                for (int c = 0; c < 3; ++c) QVERIFY(std::abs(sum[c] - whole[c]) <= 1e-5f * whole[c]);
            }
        }
        // pixels hold one mixture on all lamps' leaves: a lamp without a leaf there gives what it has, interpolated
        const auto packed = makeGpuOctree(*both);
        QVERIFY(packed);
        std::vector<double> apart;
        for (const OctreeEntry& at : both->deeper()[0].geometry.entries) {
            const float exact = luminance(both->irradiance(at.centroid, at.normal));
            const auto pixel = packedIlluminance(*packed, at.centroid, at.normal);
            QVERIFY(pixel);
            if (exact > 0.0f) apart.push_back(std::abs(double(luminance(*pixel) / exact) - 1.0));
        }
        std::ranges::sort(apart);
        QVERIFY2(apart[apart.size() / 2] <= 0.02 && apart[apart.size() * 95 / 100] <= 0.1,
                 qPrintable(QString("%1 %2").arg(apart[apart.size() / 2]).arg(apart[apart.size() * 95 / 100])));
    }

    void aMovedLampKeepsTheOthers()
    {
        Scene scene = twoLamps();
        BakeProducts products;
        OctreeSolver solver;
        const auto before = runSolver(solver, {share(scene), ringParams(), {}}, products).octree();
        scene.lights.back().position += glm::vec3(0.05f, 0.0f, 0.1f);
        const auto after = runSolver(solver, {share(scene), ringParams(), {}}, products).octree();
        QVERIFY(before && after && !before->detail(0).empty());
        QCOMPARE(after->details()[0].get(), before->details()[0].get());
        QVERIFY(!sameBits(after->detail(1), before->detail(1)));
    }

    void filesKeepThem()
    {
        BakeInfo info;
        info.params = ringParams();
        info.sceneHash = sceneHash(*ring_);
        info.isa = "avx2", info.program = "test";
        const auto bytes = bakeBytes(*octree_, info, *ring_);
        QVERIFY2(static_cast<bool>(bytes), bytes ? "" : bytes.error().message.c_str());
        const Result<BakeFile> file = bakeFromBytes(*bytes, *ring_);
        QVERIFY2(static_cast<bool>(file), file ? "" : file.error().message.c_str());
        QVERIFY(sameBits(file->octree->detail(0), octree_->detail(0)));
    }

    void fewerLevelsCanBeTaken()
    {
        QCOMPARE(octree_->withDetail(5)->deeper().size(), octree_->deeper().size());
        QCOMPARE(octree_->withDetail(1)->deeper().size(), std::size_t(1));
        const auto plain = octree_->withDetail(0);
        QVERIFY(plain->deeper().empty() && makeGpuOctree(*plain));
        QCOMPARE(plain->layers()[0].get(), octree_->layers()[0].get());
    }

    /// A seal tells damage, not intent: a file may be made so that its parts contradict each other.
    void filesThatContradictThemselvesAreRefused()
    {
        const auto scene = share(twoLamps());
        const auto both = bakeOctree(scene, ringParams()).octree();
        QVERIFY(both && !both->detail(0).empty());
        BakeInfo info;
        info.params = ringParams();
        info.sceneHash = sceneHash(*scene);
        info.isa = "avx2", info.program = "test";
        const auto refused = [&](const LampDetail& second) {
            const LightOctree octree(
                both->geometryShared(), both->layers(), both->form(), both->mix(), both->show(),
                {std::make_shared<LampDetail>(both->detail(0)), std::make_shared<LampDetail>(second)});
            const auto bytes = bakeBytes(octree, info, *scene);
            return bytes && !bakeFromBytes(*bytes, *scene);
        };
        QVERIFY(!refused(both->detail(0))); // a lamp like the other is no contradiction
        const auto level = both->detail(0)[0];
        auto geometry = std::make_shared<OctreeGeometry>(*level.geometry);
        auto layer = std::make_shared<VdlLayer>(*level.layer);
        // the first leaf with one entry more
        geometry->entries.insert(geometry->entries.begin(), geometry->entries.front());
        for (std::size_t i = 1; i < geometry->firstEntry.size(); ++i) ++geometry->firstEntry[i];
        layer->vdls.insert(layer->vdls.begin(), std::size_t(layer->count), layer->vdls.front());
        layer->scalar.insert(layer->scalar.begin(), layer->scalar.front());
        layer->noise.insert(layer->noise.begin(), layer->noise.front());
        QVERIFY(refused({{geometry, layer}}));
        // a leaf below none: the first of all, in a cell without surface
        std::uint64_t parent = 0;
        while (std::ranges::binary_search(both->geometry().cells, parent)) ++parent;
        geometry = std::make_shared<OctreeGeometry>(*level.geometry);
        const std::uint32_t entries = geometry->firstEntry[1];
        geometry->cells = {parent << 3};
        geometry->firstEntry = {0, entries};
        geometry->entries.resize(entries);
        QVERIFY(refused({{geometry, level.layer}}));
    }

    void picksFindThem()
    {
        const UnionLevel& deepest = octree_->deeper().back();
        BakeParams params = ringParams();
        BakeProducts products;
        Workers workers(2);
        BakeControl control(workers, {});
        const Result<PhotonProducts> photons = photonProducts({ring_, params, {}}, products, control, 1.0);
        QVERIFY(photons);
        for (std::size_t e = 0; e < deepest.geometry.entries.size(); e += 37) {
            const OctreeEntry& entry = deepest.geometry.entries[e];
            const auto leaf = pickLeaf(*octree_, entry.centroid, entry.normal);
            QVERIFY(leaf && leaf->answers >= 0);
            QCOMPARE(leaf->depth, deepest.geometry.depth);
            const auto near =
                gatheredPhotons(*octree_, *leaf, leaf->answers, *photons->maps[0], *photons->area, params);
            if (near.size() <= 24) continue; // as the bake gathered: kernels that would hold fewer are wider
            for (const glm::vec3& p : near)
                QVERIFY(glm::distance(p, entry.centroid) <= 1.5001f * deepest.geometry.cellSize());
        }
    }
};

QTEST_APPLESS_MAIN(OctreeDetailTest)
#include "tst_octree_detail.moc"
