// SPDX-License-Identifier: Apache-2.0
// Claims: clusters of a light tree hold what they say; no light of a cluster ever sends a receiver more than the
// cluster's bound, and bounds are not idle; a tree with exchanged exitances is the tree that is built of them; lights
// stand for others as often as their flux says; degenerate lights make no trouble.
#include "core/base/statistics.h"
#include "core/lightcuts/cluster_bound.h"
#include "core/scene/sample_scenes.h"
#include "light_helpers.h"
#include "voxel_lights.h"
#include <QtTest>
#include <cstring>
#include <limits>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

struct Lights {
    std::vector<DiscLight> discs;
    std::vector<glm::vec3> exitance;
    void add(const DiscLight& disc, glm::vec3 e) { discs.push_back(disc), exitance.push_back(e); }
    [[nodiscard]] std::shared_ptr<const LightTree> tree(std::uint64_t seed = 1) const
    {
        return LightTree::build(discs, exitance, 0.05f, seed);
    }
};

glm::vec3 anyDirection(Rng& rng) { return sampleSphere(rng.uniform(), rng.uniform()); }

/// Discs of many sizes and brightnesses, a third of them dark: anywhere, in a flat heap, in a few dense heaps, or all
/// facing nearly one way.
Lights randomDiscs(int kind, int count, std::uint64_t seed)
{
    Lights lights;
    Rng rng(seed, hashName("discs"), static_cast<std::uint64_t>(kind));
    const glm::vec3 way = anyDirection(rng);
    for (int i = 0; i < count; ++i) {
        glm::vec3 p(rng.uniform(), rng.uniform(), rng.uniform());
        if (kind == 1) p.y = 0.25f;
        if (kind == 2) p = 0.01f * p + glm::vec3(i % 3, i % 5, i % 2);
        const glm::vec3 n = kind == 3 ? glm::normalize(way + 0.1f * anyDirection(rng)) : anyDirection(rng);
        const glm::vec3 e(rng.uniform(), std::pow(10.0f, 4.0f * rng.uniform()), rng.uniform());
        lights.add({p, std::pow(10.0f, -6.0f * rng.uniform()), n}, rng.uniform() < 0.3f ? glm::vec3(0.0f) : e);
    }
    return lights;
}

bool isSame(const LightTree& a, const LightTree& b)
{
    return a.nodes().size() == b.nodes().size() &&
           std::memcmp(a.nodes().data(), b.nodes().data(), a.nodes().size_bytes()) == 0;
}

} // namespace

class LightTreeTest : public QObject {
    Q_OBJECT

    /// Random clusters, large ones as often as small ones, against receivers among and around the lights: each pair
    /// with up to 64 of the cluster's lights.
    static void checkBounds(const LightTree& tree, int pairs, std::uint64_t seed)
    {
        Rng rng(seed, hashName("pairs"), 0);
        const glm::vec3 low = tree.nodes()[0].low, size = tree.nodes()[0].high - low;
        RunningMean tightness;
        std::uint64_t compared = 0, violations = 0;
        for (int i = 0; i < pairs; ++i) {
            std::uint32_t number = 0;
            for (auto steps = static_cast<int>(18.0f * rng.uniform()); steps-- > 0 && !tree.nodes()[number].isLeaf();)
                number = tree.nodes()[number].child + (rng.uniform() < 0.5f ? 0u : 1u);
            const LightNode& node = tree.nodes()[number];
            const auto [first, last] = tree.lightsOf(number);
            Receiver at{low + size * (3.0f * glm::vec3(rng.uniform(), rng.uniform(), rng.uniform()) - 1.0f),
                        anyDirection(rng)};
            if (i % 4 == 0) { // on a surface beside the lights
                const auto any = static_cast<std::size_t>(rng.uniform() * static_cast<float>(tree.lights().size()));
                at = {tree.lights()[any].position + 1e-4f * anyDirection(rng), tree.lights()[any].normal};
            }
            NearRange near;
            if (i % 2 == 0) near.inner = 0.2f * rng.uniform(), near.outer = near.inner * (1.0f + rng.uniform());
            const float bound = ClusterBound(at, near).transfer(node);
            QVERIFY(bound >= 0.0f && bound < kInfinity);
            float largest = 0.0f;
            const std::uint32_t step = 1 + (last - first) / 64;
            for (std::uint32_t light = first; light < last; light += step) {
                if (tree.fluxOf(light) == glm::vec3(0.0f)) continue;
                largest = std::max(largest, discTransfer(at, tree.lights()[light], near));
                ++compared;
            }
            if (!(largest <= bound)) ++violations;
            if (largest > 0.0f && last - first <= 64) tightness.add(static_cast<double>(largest / bound));
        }
        qInfo("%llu lights of %d pairs: largest transfer is %.2f of the bound in the mean",
              (unsigned long long)compared, pairs, tightness.mean());
        QCOMPARE(violations, std::uint64_t(0));
        QVERIFY(tightness.mean() >= 0.5); // small clusters: of course
    }

private Q_SLOTS:
    void clustersHoldWhatTheySay()
    {
        const Lights lights = randomDiscs(2, 3000, 7);
        const auto tree = lights.tree();
        QCOMPARE(tree->nodes().size(), 2 * lights.discs.size() - 1);
        for (std::size_t i = 0; i < tree->nodes().size(); ++i) {
            const LightNode& node = tree->nodes()[i];
            const auto [first, last] = tree->lightsOf(i);
            QVERIFY(first < last);
            QCOMPARE(node.isLeaf(), last - first == 1);
            if (!node.isLeaf()) {
                QCOMPARE(tree->lightsOf(node.child).first, first);
                QCOMPARE(tree->lightsOf(node.child).last, tree->lightsOf(node.child + 1).first);
                QCOMPARE(tree->lightsOf(node.child + 1).last, last);
                QVERIFY(node.chosen == tree->nodes()[node.child].chosen ||
                        node.chosen == tree->nodes()[node.child + 1].chosen);
            }
            glm::dvec3 flux(0.0);
            for (std::uint32_t light = first; light < last; ++light) {
                if (tree->fluxOf(light) == glm::vec3(0.0f)) continue;
                const DiscLight& disc = tree->lights()[light];
                QVERIFY(glm::all(glm::lessThanEqual(node.low, disc.position)));
                QVERIFY(glm::all(glm::lessThanEqual(disc.position, node.high)));
                QVERIFY(glm::dot(node.axis, disc.normal) >= node.cosine && node.leastArea <= disc.area);
                flux += glm::dvec3(tree->fluxOf(light));
            }
            QVERIFY(glm::all(glm::lessThanEqual(glm::abs(glm::dvec3(node.flux) - flux), 1e-5 * flux)));
            if (flux.y > 0.0) QVERIFY(tree->fluxOf(node.chosen) != glm::vec3(0.0f));
        }
    }

    void boundsHoldForRandomDiscs_data()
    {
        QTest::addColumn<int>("kind");
        for (const int kind : {0, 1, 2, 3}) QTest::addRow("%d", kind) << kind;
    }
    void boundsHoldForRandomDiscs()
    {
        QFETCH(int, kind);
        checkBounds(*randomDiscs(kind, 4000, 11).tree(), 25'000, 3);
    }

    void boundsHoldForVoxels()
    {
        const LitScene s(cornellBox());
        Workers workers(2);
        const auto reach = LightReach::find(*s.rays, *s.lights, workers, {});
        const VoxelLights lights(*s.rays, *s.lights, *reach, 32, 64, workers);
        checkBounds(*lights.tree(), 100'000, 5);
    }

    void exchangedExitancesAreANewTree()
    {
        Lights lights = randomDiscs(0, 2000, 5);
        const auto first = lights.tree(3);
        Rng rng(1, 2, 3);
        for (glm::vec3& e : lights.exitance) e = rng.uniform() < 0.5f ? glm::vec3(0.0f) : glm::vec3(rng.uniform());
        const auto built = lights.tree(3), exchanged = first->withExitance(lights.exitance);
        QVERIFY(!isSame(*first, *built));
        QVERIFY(isSame(*exchanged, *built));
        QVERIFY(!isSame(*lights.tree(4), *built)); // other lights stand for the rest
        for (glm::vec3& e : lights.exitance) e *= 0.25f;
        const auto dimmed = first->withExitance(lights.exitance);
        for (std::size_t i = 0; i < built->nodes().size(); ++i) {
            QCOMPARE(dimmed->nodes()[i].flux, 0.25f * built->nodes()[i].flux);
            QCOMPARE(dimmed->nodes()[i].chosen, built->nodes()[i].chosen);
        }
    }

    void lightsStandForOthersByTheirFlux()
    {
        Lights lights;
        for (int i = 0; i < 8; ++i)
            lights.add({{static_cast<float>(i), 0.0f, 0.0f}, 1.0f, {0.0f, 0.0f, 1.0f}},
                       glm::vec3(static_cast<float>(i)));
        RunningMean stands[8];
        const auto tree = lights.tree();
        for (std::uint64_t seed = 0; seed < 4000; ++seed) {
            const auto drawn = lights.tree(seed);
            for (std::uint32_t i = 0; i < 8; ++i) stands[i].add(drawn->nodes()[0].chosen == i ? 1.0 : 0.0);
        }
        for (std::uint32_t i = 0; i < 8; ++i)
            VERIFY_MEAN(stands[i], static_cast<double>(tree->fluxOf(i).y) / 28.0, sidakLimit(8), "light");
    }

    void degenerateLights()
    {
        const Lights none;
        QVERIFY(none.tree()->nodes().empty());

        Lights one;
        one.add({glm::vec3(1.0f), 2.0f, {0.0f, 1.0f, 0.0f}}, glm::vec3(3.0f));
        QCOMPARE(one.tree()->nodes().size(), std::size_t(1));
        QVERIFY(one.tree()->nodes()[0].isLeaf() && one.tree()->nodes()[0].flux == glm::vec3(6.0f));

        Lights heap; // all at one place, two ways
        for (int i = 0; i < 100; ++i)
            heap.add({glm::vec3(1.0f), 1.0f, {0.0f, i < 50 ? 1.0f : -1.0f, 0.0f}}, glm::vec3(1.0f));
        QCOMPARE(heap.tree()->nodes().size(), std::size_t(199));
        QCOMPARE(heap.tree()->nodes()[0].flux, glm::vec3(100.0f));
        QVERIFY(ClusterBound({glm::vec3(1.0f, 3.0f, 1.0f), {0.0f, -1.0f, 0.0f}}, {}).transfer(heap.tree()->nodes()[0]) >
                0.07f);

        Lights broken; // what is no light stays dark and hides nothing
        broken.add({glm::vec3(0.0f), 1.0f, {0.0f, 0.0f, 1.0f}}, glm::vec3(1.0f));
        broken.add({glm::vec3(kNaN), 1.0f, {0.0f, 0.0f, 1.0f}}, glm::vec3(1.0f));
        broken.add({glm::vec3(5.0f), 1.0f, glm::vec3(kInfinity)}, glm::vec3(1.0f));
        broken.add({glm::vec3(5.0f), -1.0f, {0.0f, 0.0f, 1.0f}}, glm::vec3(1.0f));
        broken.add({glm::vec3(1.0f), 1.0f, {0.0f, 0.0f, 1.0f}}, {kNaN, 1.0f, 1.0f});
        broken.add({glm::vec3(1.0f), 1.0f, {0.0f, 0.0f, 1.0f}}, glm::vec3(-1.0f));
        broken.add({glm::vec3(1.0f), 1.0f, {0.0f, 0.0f, 1.0f}}, glm::vec3(0.0f, kInfinity, 0.0f));
        const LightNode root = broken.tree()->nodes()[0];
        QCOMPARE(root.flux, glm::vec3(1.0f));
        QVERIFY(root.low == glm::vec3(0.0f) && root.high == glm::vec3(0.0f) && root.leastArea == 1.0f);

        Lights bright; // so bright that a sum of squares is infinite
        for (int i = 0; i < 64; ++i)
            bright.add({glm::vec3(static_cast<float>(i)), 1e20f, {0.0f, 0.0f, 1.0f}}, glm::vec3(1e18f));
        QVERIFY(isFinite(bright.tree()->nodes()[0].flux));
    }
};

QTEST_APPLESS_MAIN(LightTreeTest)
#include "tst_light_tree.moc"
