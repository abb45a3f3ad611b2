// SPDX-License-Identifier: Apache-2.0
// Claims: the arrays that textures are made from hold the octree as METHODS section 3 says. 100 000 leaves with four
// lights each, orientation entries included, fit 5.2 MiB; looked up on the CPU they give what the octree gives, within
// what packing costs; what 24 bits or a texture cannot address is refused.
#include "core/bake/packed_octree.h"
#include "core/base/rng.h"
#include "core/base/sampling.h"
#include "core/base/units.h"
#include "core/octree/octree_build.h"
#include "core/scene/sample_scenes.h"
#include "core/trace/cell_clip.h"
#include "tests/bake_helpers.h"
#include <QtTest>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr double kMiB = 1024.0 * 1024.0;

glm::vec3 anyDirection(Rng& rng)
{
    const float z = 2.0f * rng.uniform() - 1.0f, phi = 2.0f * kPi * rng.uniform(), r = std::sqrt(1.0f - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// The first `leaves` leaves of a scene's octree.
std::shared_ptr<const OctreeGeometry> leavesOf(const std::shared_ptr<const Scene>& scene, int depth, float shift,
                                               std::size_t leaves)
{
    const auto rays = RayScene::build(scene);
    const LightSampler lights(*rays);
    Workers workers(2);
    const auto reach = LightReach::find(**rays, lights, workers, {});
    auto geometry =
        std::make_shared<OctreeGeometry>(*buildOctree(scene->bounds, *reach, depth, shift, workers, std::stop_token()));
    if (geometry->cells.size() > leaves) {
        geometry->cells.resize(leaves);
        geometry->firstEntry.resize(leaves + 1);
        geometry->entries.resize(geometry->firstEntry.back());
    }
    return geometry;
}

/// Every entry with `count` lights, each some way off its normal.
std::shared_ptr<VdlLayer> anyLayer(const OctreeGeometry& geometry, int count)
{
    auto layer = std::make_shared<VdlLayer>();
    layer->count = count;
    Rng rng(1, 2, 3);
    for (const OctreeEntry& entry : geometry.entries) {
        glm::vec3 sum(0.0f);
        for (int j = 0; j < count; ++j) {
            const glm::vec3 d = glm::normalize(anyDirection(rng) + 1.2f * entry.normal);
            const glm::vec3 colour = glm::vec3(rng.uniform(), rng.uniform(), rng.uniform()) * 300.0f;
            layer->vdls.push_back({colour, d});
            sum += colour * glm::max(0.0f, glm::dot(d, entry.normal));
        }
        layer->scalar.push_back(sum);
        layer->noise.push_back(0.0f);
    }
    return layer;
}

/// A geometry of single leaves at `cells`, one entry each.
std::shared_ptr<OctreeGeometry> sparse(int depth, std::vector<std::uint64_t> cells)
{
    auto geometry = std::make_shared<OctreeGeometry>();
    geometry->depth = depth;
    geometry->cells = std::move(cells);
    geometry->entries.resize(geometry->cells.size(), {glm::vec3(0.0f), glm::vec3(0, 1, 0), 1.0f});
    geometry->firstEntry.resize(geometry->cells.size() + 1);
    for (std::uint32_t i = 0; i < geometry->firstEntry.size(); ++i) geometry->firstEntry[i] = i;
    return geometry;
}

/// Centre of a leaf's cell.
glm::vec3 centreOf(const OctreeGeometry& geometry, std::size_t leaf)
{
    return geometry.lowest + (glm::vec3(mortonCell(geometry.cells[leaf])) + 0.5f) * geometry.cellSize();
}

} // namespace

class GpuLayoutTest : public QObject {
    Q_OBJECT

    std::shared_ptr<const Scene> cornell_;
    std::shared_ptr<const LightOctree> baked_;

private Q_SLOTS:
    void initTestCase()
    {
        cornell_ = share(cornellBox());
        BakeParams params;
        params.photonCount = 60'000;
        params.gatherCount = 100;
        params.octreeFirstDepth = params.octreeDepth = 5;
        baked_ = bakeOctree(cornell_, params).octree();
        QVERIFY(baked_);
    }

    void hundredThousandLeavesFit_data()
    {
        QTest::addColumn<QString>("scene");
        QTest::addColumn<int>("depth");
        QTest::addColumn<float>("shift");
        QTest::newRow("cornell") << "cornell" << 7 << 0.0f;
        QTest::newRow("cornell, shifted") << "cornell" << 7 << 0.5f;
        QTest::newRow("figure") << "figure" << 8 << 0.25f;
        QTest::newRow("gallery") << "gallery" << 8 << 0.0f;
    }
    void hundredThousandLeavesFit()
    {
        QFETCH(QString, scene);
        QFETCH(int, depth);
        QFETCH(float, shift);
        Result<Scene> made = sampleScene(scene.toStdString());
        QVERIFY(made);
        const auto geometry = leavesOf(share(std::move(*made)), depth, shift, 100'000);
        QCOMPARE(geometry->cells.size(), std::size_t(100'000));
        const LightOctree octree(geometry, {anyLayer(*geometry, 4)}, VdlForm::corrected, {});
        const auto gpu = makeGpuOctree(octree);
        QVERIFY(gpu);
        qInfo("%s d%d: %zu leaves, %zu entries: bricks %d x %d x %d %.3f MiB, lights %.3f, normals %.3f, all %.3f MiB",
              QTest::currentDataTag(), depth, geometry->cells.size(), geometry->entries.size(), gpu->side.x,
              gpu->side.y, gpu->side.z, double(gpu->bricks.size()) / kMiB, double(2 * gpu->vdls.size()) / kMiB,
              double(gpu->normals.size()) / kMiB, double(gpu->memoryBytes()) / kMiB);
        QVERIFY(geometry->entries.size() > geometry->cells.size()); // orientation entries are among them
        QCOMPARE(gpu->memoryBytes(), gpu->bricks.size() + 2 * gpu->vdls.size() + gpu->normals.size());
        QVERIFY(double(gpu->memoryBytes()) <= 5.2 * kMiB);
    }

    void bricksWasteNothingWorthNaming()
    {
        for (std::uint64_t n = 1; n <= 2'097'152; n += 1 + n / 7) {
            const auto box = brickBox(n);
            QVERIFY(box);
            const auto volume = std::uint64_t(box->x) * std::uint64_t(box->y) * std::uint64_t(box->z);
            QVERIFY(volume >= n && std::max({box->x, box->y, box->z}) <= 128);
            const double waste = double(volume - n) / double(n);
            QVERIFY2(waste <= (n < 1000 ? 0.1 : 0.01), qPrintable(QString("%1 bricks waste %2").arg(n).arg(waste)));
        }
        QCOMPARE(*brickBox(128ull * 128 * 128), glm::ivec3(128));
        QVERIFY(!brickBox(128ull * 128 * 128 + 1));
    }

    /// Each entry with a light of its own that says which it is.
    void everyEntryIsFound()
    {
        const auto geometry = leavesOf(cornell_, 5, 0.5f, 1'000'000);
        auto layer = std::make_shared<VdlLayer>();
        const auto colourOf = [](std::size_t e) {
            return glm::vec3(float(1 + e % 100), float(1 + e / 100 % 100), float(1 + e / 10'000));
        };
        for (std::size_t e = 0; e < geometry->entries.size(); ++e) {
            layer->vdls.push_back({colourOf(e), geometry->entries[e].normal});
            layer->scalar.push_back(colourOf(e));
            layer->noise.push_back(0.0f);
        }
        const LightOctree octree(geometry, {layer}, VdlForm::corrected, {});
        const auto gpu = makeGpuOctree(octree);
        QVERIFY(gpu);
        int severalIn = 0;
        for (std::size_t i = 0; i < geometry->cells.size(); ++i) {
            severalIn += geometry->firstEntry[i + 1] - geometry->firstEntry[i] > 1;
            for (std::uint32_t e = geometry->firstEntry[i]; e < geometry->firstEntry[i + 1]; ++e) {
                const glm::vec3 n = geometry->entries[e].normal, p = centreOf(*geometry, i);
                const auto lux = packedIlluminance(*gpu, p, n);
                QVERIFY(lux);
                // p is the centre but for rounding: no neighbour counts for more than that
                QVERIFY2(glm::length(*lux - colourOf(e)) <= 0.01f * glm::length(colourOf(e)),
                         qPrintable(QString("entry %1: %2 %3 %4").arg(e).arg(lux->x).arg(lux->y).arg(lux->z)));
            }
        }
        QVERIFY(severalIn > 100);
        QVERIFY(!packedIlluminance(*gpu, glm::vec3(1e30f), glm::vec3(0, 1, 0)));
        QVERIFY(!packedIlluminance(*gpu, glm::vec3(std::nanf("")), glm::vec3(0, 1, 0)));
        QVERIFY(!packedIlluminance(*gpu, geometry->lowest - 3.0f * geometry->cellSize(), glm::vec3(0, 1, 0)));
    }

    void lookupThroughArraysIsTheOctrees_data()
    {
        QTest::addColumn<int>("show");
        QTest::addColumn<bool>("isTilted");
        QTest::newRow("lights") << 0 << false;
        QTest::newRow("lights, bent normals") << 0 << true;
        QTest::newRow("colour") << 1 << false;
        QTest::newRow("colour, bent normals") << 1 << true;
    }
    void lookupThroughArraysIsTheOctrees()
    {
        QFETCH(int, show);
        QFETCH(bool, isTilted);
        BakeParams params;
        params.octreeShow = static_cast<OctreeShow>(show);
        const auto exact = shownField(baked_, params, nullptr);
        params.octreeValues = OctreeValues::packed;
        const auto packed = shownField(baked_, params, nullptr);
        QVERIFY(exact && packed);
        Rng rng(5, 6, 7);
        std::vector<double> errors;
        double mean = 0.0;
        int differ = 0;
        const OctreeGeometry& geometry = baked_->geometry();
        for (std::size_t e = 0; e < geometry.entries.size(); e += 3) {
            const OctreeEntry& entry = geometry.entries[e];
            const glm::vec3 n = isTilted ? glm::normalize(entry.normal + 0.8f * anyDirection(rng)) : entry.normal;
            const glm::vec3 p = entry.centroid + 0.3f * geometry.cellSize() * anyDirection(rng);
            glm::vec3 a(0.0f), b(0.0f);
            const bool known = (*exact)->lookup(p, n, a), same = (*packed)->lookup(p, n, b) == known;
            differ += same ? 0 : 1;
            if (!known || !same) continue;
            mean += luminance(a);
            errors.push_back(std::abs(double(luminance(a - b))));
        }
        mean /= double(errors.size());
        std::ranges::sort(errors);
        const double median = errors[errors.size() / 2] / mean, most = errors[errors.size() * 99 / 100] / mean;
        qInfo("%s: median %.2e, 99 %% below %.2e, worst %.2e of the mean; answers differ at %d of %zu",
              QTest::currentDataTag(), median, most, errors.back() / mean, differ, errors.size());
        // halves carry 11 bits; directions are off by .79 degrees at worst, which a normal of its own does not feel
        QVERIFY(median <= (isTilted && show == 0 ? 3e-3 : 2e-4));
        QVERIFY(most <= (isTilted && show == 0 ? 0.02 : 2e-3));
        QVERIFY(differ <= int(errors.size()) / 500);
    }

    void colourOctreeHasNoDirections()
    {
        BakeParams params;
        params.octreeShow = OctreeShow::colour;
        const auto colour = std::dynamic_pointer_cast<const LightOctree>(*shownField(baked_, params, nullptr));
        QVERIFY(colour);
        const auto gpu = makeGpuOctree(*colour);
        QVERIFY(gpu);
        QVERIFY(!gpu->hasDirections);
        QCOMPARE(gpu->vdlCount, 1);
        // a leaf with one entry alone among its neighbours' weights: the centre of its cell
        const OctreeGeometry& geometry = colour->geometry();
        const glm::vec3 p = centreOf(geometry, 0), n = geometry.entries[0].normal;
        glm::vec3 straight(0.0f), bent(0.0f), lights(0.0f), lightsBent(0.0f);
        const glm::vec3 aside = glm::normalize(n + 0.7f * glm::vec3(n.y, n.z, n.x));
        QVERIFY(colour->lookup(p, n, straight) && colour->lookup(p, aside, bent));
        QVERIFY(baked_->lookup(p, n, lights) && baked_->lookup(p, aside, lightsBent));
        QCOMPARE(straight, bent);
        QVERIFY(glm::length(lights - lightsBent) > 0.01f * glm::length(lights));
        // on the entry's own normal both say the same where the photons' surfaces share it
        QVERIFY(std::abs(luminance(straight) - luminance(lights)) <= 0.05f * luminance(lights));
        // dimming
        const auto half = colour->withMix(Mix(cornell_->groups.size(), glm::vec3(0.5f)));
        glm::vec3 dimmed(0.0f);
        QVERIFY(half->lookup(p, n, dimmed));
        QVERIFY(glm::length(dimmed - 0.5f * straight) <= 1e-6f * glm::length(straight));
    }

    void mixCountsInTheArrays()
    {
        const auto packed = PackedOctree::make(baked_);
        QVERIFY(packed);
        const auto half = (*packed)->withMix(Mix(cornell_->groups.size(), glm::vec3(0.5f)));
        const OctreeEntry& entry = baked_->geometry().entries[7];
        glm::vec3 full(0.0f), dimmed(0.0f);
        QVERIFY((*packed)->lookup(entry.centroid, entry.normal, full));
        QVERIFY(half->lookup(entry.centroid, entry.normal, dimmed));
        QVERIFY(glm::length(dimmed - 0.5f * full) <= 1e-3f * glm::length(full));
    }

    void emptyAndTiny()
    {
        const LightOctree none(sparse(4, {}), {}, VdlForm::corrected, {});
        const auto gpu = makeGpuOctree(none);
        QVERIFY(gpu);
        QVERIFY(!packedIlluminance(*gpu, glm::vec3(0.5f), glm::vec3(0, 1, 0)));
        const LightOctree one(sparse(1, {7}), {}, VdlForm::corrected, {});
        const auto single = makeGpuOctree(one);
        QVERIFY(single);
        QCOMPARE(single->side, glm::ivec3(1));
        const auto dark = packedIlluminance(*single, glm::vec3(0.75f), glm::vec3(0, 1, 0));
        QVERIFY(dark);
        QCOMPARE(*dark, glm::vec3(0.0f));
    }

    void overflowIsRefused()
    {
        // 8 lights each: 2^21 entries are the last that 24 bits address
        std::vector<std::uint64_t> cells((1u << 21) + 1);
        for (std::uint64_t i = 0; i < cells.size(); ++i) cells[i] = i;
        auto layer = std::make_shared<VdlLayer>();
        layer->count = 8;
        const LightOctree many(sparse(8, std::move(cells)), {layer}, VdlForm::corrected, {});
        const auto refused = makeGpuOctree(many);
        QVERIFY(!refused);
        QVERIFY(refused.error().message.find("24 bits") != std::string::npos);
        QVERIFY(refused.error().message.find("vdl.count") != std::string::npos);
        // leaves so far apart that each has nodes of its own
        std::vector<std::uint64_t> apart(800'000);
        for (std::uint64_t i = 0; i < apart.size(); ++i) apart[i] = i << 9;
        const LightOctree wide(sparse(10, std::move(apart)), {}, VdlForm::corrected, {});
        const auto nodes = makeGpuOctree(wide);
        QVERIFY(!nodes);
        QVERIFY(nodes.error().message.find("octree.depth") != std::string::npos);
    }
};

QTEST_APPLESS_MAIN(GpuLayoutTest)
#include "tst_gpu_layout.moc"
