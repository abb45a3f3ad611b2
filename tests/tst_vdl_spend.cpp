// SPDX-License-Identifier: Apache-2.0
// Claims: with vdl.tolerance entries keep as few lights as leave the picture within it, the entry's own light to the
// last digits; brightness stays that of the furnace; layers, files and textures hold the fewer lights only.
#include "core/bake/bake_file.h"
#include "core/bake/packed_octree.h"
#include "core/base/sampling.h"
#include "core/base/units.h"
#include "core/octree/detail_union.h"
#include "core/octree/vdl_cluster.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "tests/bake_helpers.h"
#include <QtTest>
#include <cmath>

using namespace lightloom;
using namespace lightloom::test;

namespace {

glm::vec3 onNormal(std::span<const Vdl> vdls, glm::vec3 n)
{
    glm::vec3 lux(0.0f);
    for (const Vdl& vdl : vdls) lux += vdl.colour * glm::max(0.0f, glm::dot(vdl.toLight, n));
    return lux;
}

std::size_t used(const VdlLayer& layer)
{
    std::size_t count = 0;
    for (std::size_t e = 0; e < layer.scalar.size(); ++e) {
        for (const Vdl& vdl : layer.of(e)) count += vdl.colour != glm::vec3(0.0f);
    }
    return count;
}

BakeParams params(float tolerance)
{
    BakeParams p;
    p.photonCount = 60'000, p.gatherCount = 100;
    p.octreeFirstDepth = p.octreeDepth = 5;
    p.vdlCount = 8, p.vdlTolerance = tolerance;
    return p;
}

} // namespace

class VdlSpendTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void oneDirectionTakesOneLight()
    {
        const glm::vec3 n(0, 1, 0), d = glm::normalize(glm::vec3(0.3f, 1.0f, 0.1f));
        std::vector<Vdl> vdls(8, Vdl{glm::vec3(0.0f), n});
        ClusterScratch scratch;
        QCOMPARE(spendVdls(vdls, n, VdlForm::corrected, 0.01f, scratch), std::size_t(0)); // dark
        for (int i = 0; i < 5; ++i) vdls[static_cast<std::size_t>(i)] = {glm::vec3(10.0f + float(i)), d};
        const glm::vec3 before = onNormal(vdls, n);
        QCOMPARE(spendVdls(vdls, n, VdlForm::corrected, 0.01f, scratch), std::size_t(1));
        QVERIFY(glm::length(onNormal(vdls, n) - before) <= 1e-5f * glm::length(before));
        QVERIFY(vdls[1].colour == glm::vec3(0.0f));
        // across each other: neither stands for the other, unless anything goes
        std::vector<Vdl> two{{glm::vec3(10.0f, 0.0f, 0.0f), glm::normalize(glm::vec3(1, 0.3f, 0))},
                             {glm::vec3(0.0f, 10.0f, 0.0f), glm::normalize(glm::vec3(-1, 0.3f, 0))}};
        std::vector<Vdl> copy = two;
        QCOMPARE(spendVdls(copy, n, VdlForm::corrected, 0.05f, scratch), std::size_t(2));
        QVERIFY(copy[0].colour == two[0].colour && copy[1].colour == two[1].colour);
    }

    void pictureStaysWithinTheTolerance_data()
    {
        QTest::addColumn<QString>("scene");
        for (const char* scene : {"cornell", "figure"}) QTest::newRow(scene) << scene;
    }
    void pictureStaysWithinTheTolerance()
    {
        QFETCH(QString, scene);
        const Result<Scene> made = scene == "figure" ? sampleScene("figure", 5'000) : sampleScene(scene.toStdString());
        QVERIFY(made);
        const auto shared = share(*made);
        BakeProducts products;
        OctreeSolver solver;
        const auto all = runSolver(solver, {shared, params(0.0f), {}}, products).octree();
        QVERIFY(all);
        std::size_t before = used(*all->layers()[0]);
        for (const float tolerance : {0.05f, 0.1f, 0.2f}) {
            const Baked baked = runSolver(solver, {shared, params(tolerance), {}}, products);
            const auto few = baked.octree();
            QVERIFY2(few, baked.error.c_str());
            QCOMPARE(baked.counters.photonsShot, std::uint64_t(0));
            const VdlLayer &a = *all->layers()[0], &b = *few->layers()[0];
            std::vector<double> errors;
            Rng rng(3, 1, 4);
            for (std::size_t e = 0; e < a.scalar.size(); ++e) {
                const glm::vec3 n = all->geometry().entries[e].normal;
                const glm::vec3 own = onNormal(a.of(e), n);
                QVERIFY(glm::length(onNormal(b.of(e), n) - own) <= 2e-4f * glm::length(own) + 1e-6f);
                const Frame frame(n);
                float most = 0.0f, apart = 0.0f; // over normals of its own choosing
                for (int i = 0; i < 40; ++i) {
                    const float cosine = 0.3f + 0.7f * rng.uniform(), sine = std::sqrt(1.0f - cosine * cosine);
                    const float phi = 2.0f * kPi * rng.uniform();
                    const glm::vec3 m =
                        cosine * n + sine * (std::cos(phi) * frame.tangent + std::sin(phi) * frame.bitangent);
                    most = glm::max(most, luminance(onNormal(a.of(e), m)));
                    apart = glm::max(apart, maxChannel(glm::abs(onNormal(a.of(e), m) - onNormal(b.of(e), m))));
                }
                if (most > 0.0f) errors.push_back(double(apart / most));
            }
            std::ranges::sort(errors);
            const double worst = errors.back(), nearly = errors[errors.size() * 99 / 100];
            const std::size_t now = used(b);
            qInfo("%s, tolerance %g: %.2f lights an entry of %.2f, 99 %% within %.3f, worst %.3f", qPrintable(scene),
                  double(tolerance), double(now) / double(b.scalar.size()), double(used(a)) / double(a.scalar.size()),
                  nearly, worst);
            QVERIFY(now < before);
            QCOMPARE(b.vdls.size(), now); // none is stored in vain
            before = now;
            // spendVdls looks at 65 normals; between them few entries are further off, where two lights set at once
            QVERIFY(nearly <= double(tolerance) && worst <= 1.2 * double(tolerance));
        }
    }

    void texturesAndFilesHoldTheFewer()
    {
        const auto scene = share(causticRing()); // with leaves that are split
        const auto all = bakeOctree(scene, params(0.0f)).octree(), few = bakeOctree(scene, params(0.05f)).octree();
        QVERIFY(all && few && !few->deeper().empty());
        const auto whole = makeGpuOctree(*all), packed = makeGpuOctree(*few);
        QVERIFY(whole && packed);
        qInfo("lights %zu bytes of %zu, all %zu of %zu", 2 * packed->vdls.size(), 2 * whole->vdls.size(),
              packed->memoryBytes(), whole->memoryBytes());
        QVERIFY(packed->vdls.size() * 4 < whole->vdls.size() * 3);
        QCOMPARE(packed->entryCount, std::uint64_t(packed->classEnds[8]));
        QVERIFY(few->memoryBytes() < all->memoryBytes());
        std::vector<double> apart;
        double mean = 0.0;
        for (std::size_t e = 0; e < few->geometry().entries.size(); ++e) {
            const OctreeEntry& at = few->geometry().entries[e];
            const glm::vec3 exact = few->irradiance(at.centroid, at.normal);
            const auto pixel = packedIlluminance(*packed, at.centroid, at.normal);
            QVERIFY(pixel);
            apart.push_back(double(glm::length(*pixel - exact)));
            mean += double(glm::length(exact));
        }
        mean /= double(apart.size());
        std::ranges::sort(apart);
        QVERIFY(apart[apart.size() * 99 / 100] <= 1e-2 * mean);

        BakeInfo info;
        info.params = params(0.05f);
        info.sceneHash = sceneHash(*scene);
        info.isa = "avx2", info.program = "test";
        const auto bytes = bakeBytes(*few, info, *scene);
        QVERIFY2(static_cast<bool>(bytes), bytes ? "" : bytes.error().message.c_str());
        const Result<BakeFile> file = bakeFromBytes(*bytes, *scene);
        QVERIFY2(static_cast<bool>(file), file ? "" : file.error().message.c_str());
        const auto same = [](const VdlLayer& a, const VdlLayer& b) {
            bool is = a.first == b.first && a.vdls.size() == b.vdls.size() && a.tolerance == b.tolerance;
            for (std::size_t i = 0; is && i < a.vdls.size(); ++i)
                is = a.vdls[i].colour == b.vdls[i].colour && a.vdls[i].toLight == b.vdls[i].toLight;
            return is;
        };
        QVERIFY(same(*file->octree->layers()[0], *few->layers()[0]));
        for (std::size_t l = 0; l < few->detail(0).size(); ++l)
            QVERIFY(same(*file->octree->detail(0)[l].layer, *few->detail(0)[l].layer));
    }

    void furnaceHolds()
    {
        BakeProducts products;
        OctreeSolver solver;
        const auto scene = share(furnaceBox(0.5f));
        double means[2] = {};
        for (const int i : {0, 1}) {
            BakeParams p;
            p.octreeFirstDepth = p.octreeDepth = 4;
            p.vdlCount = 8, p.vdlTolerance = i ? 0.1f : 0.0f;
            const auto octree = runSolver(solver, {scene, p, {}}, products).octree();
            QVERIFY(octree);
            double area = 0.0;
            for (const OctreeEntry& e : octree->geometry().entries) {
                means[i] += double(e.area * luminance(octree->irradiance(e.centroid, e.normal)));
                area += double(e.area);
            }
            means[i] /= area;
        }
        QVERIFY2(std::abs(means[1] / means[0] - 1.0) <= 0.001 && std::abs(means[1] - 1.0) <= 0.02,
                 qPrintable(QString("%1 %2").arg(means[0]).arg(means[1])));
    }
};

QTEST_APPLESS_MAIN(VdlSpendTest)
#include "tst_vdl_spend.moc"
