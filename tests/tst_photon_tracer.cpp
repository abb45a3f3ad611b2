// SPDX-License-Identifier: Apache-2.0
// Claims: eight photons under way together are the same photons, to the bit, as one after the other, on walls, metal
// and glass and from every kind of lamp; directions drawn together are those drawn one by one.
#include "core/scene/sample_scenes.h"
#include "core/trace/cosine_draws.h"
#include "core/trace/photon_tracer.h"
#include "tests/light_helpers.h"
#include <cstring>

using namespace lightloom;
using namespace lightloom::test;

namespace {

std::vector<std::array<float, 12>> sorted(const PhotonPaths& paths)
{
    std::vector<std::array<float, 12>> all;
    for (const Photon& photon : paths.photons) {
        std::array<float, 12> numbers;
        static_assert(sizeof(photon) == sizeof(numbers));
        std::memcpy(numbers.data(), &photon, sizeof(photon));
        all.push_back(numbers);
    }
    std::ranges::sort(all);
    return all;
}

glm::dvec3 meanPlace(const PhotonPaths& paths)
{
    glm::dvec3 sum(0.0);
    for (const Photon& photon : paths.photons) sum += glm::dvec3(photon.position);
    return sum / static_cast<double>(std::max<std::size_t>(paths.photons.size(), 1));
}

} // namespace

class PhotonTracerTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void togetherIsOneByOne_data()
    {
        QTest::addColumn<QString>("name");
        for (const char* name : {"cornell", "two_rooms", "atrium", "gallery", "caustic_ring"})
            QTest::newRow(name) << name;
    }
    void togetherIsOneByOne()
    {
        QFETCH(QString, name);
        const Result<Scene> scene = sampleScene(name.toStdString());
        QVERIFY(static_cast<bool>(scene));
        const LitScene lit(*scene);
        Workers workers;
        for (int group = 0; group < static_cast<int>(scene->groups.size()); ++group) {
            PhotonJob job{group, 3, 10'007, 1024};
            const auto together = tracePhotons(*lit.rays, *lit.lights, job, workers, {});
            job.oneByOne = true;
            const auto single = tracePhotons(*lit.rays, *lit.lights, job, workers, {});
            QCOMPARE(together->photons.size(), single->photons.size());
            if (name != "atrium") QVERIFY(sorted(*together) == sorted(*single));
            QVERIFY(glm::length(meanPlace(*together) - meanPlace(*single)) <= 1e-6);
            QCOMPARE(together->rays, single->rays);
            QCOMPARE(together->caustic, single->caustic);
            QCOMPARE(together->cutOff, single->cutOff);
            const double lumen = glm::length(single->ledger.emitted);
            QVERIFY(glm::length(together->ledger.absorbed - single->ledger.absorbed) <= 1e-7 * lumen);
            QVERIFY(glm::length(together->ledger.escaped - single->ledger.escaped) <= 1e-7 * lumen);
            QVERIFY(glm::length(together->ledger.missing()) <= 1e-9 * lumen);
        }
    }

    void drawnTogetherIsDrawnOneByOne()
    {
        CosineDraws draws;
        for (std::uint64_t i = 0; i < 20'000; ++i) {
            std::array<glm::vec3, CosineDraws::kCount> normals;
            std::array<glm::vec2, CosineDraws::kCount> u;
            for (std::size_t lane = 0; lane < normals.size(); ++lane) {
                Rng rng(5, lane, i);
                const auto [a, b] = rng.uniformPair();
                const auto [c, d] = rng.uniformPair();
                normals[lane] = i % 8 == lane ? glm::vec3(0, 0, i % 16 < 8 ? 1 : -1) : sampleSphere(a, b);
                u[lane] = {c, d};
                draws.ask(lane, normals[lane], u[lane]);
            }
            draws.draw();
            for (std::size_t lane = 0; lane < normals.size(); ++lane) {
                const glm::vec3 single = Frame(normals[lane]).toWorld(sampleCosineHemisphere(u[lane].x, u[lane].y));
                QVERIFY(single == draws.drawn(lane));
            }
        }
    }
};

QTEST_APPLESS_MAIN(PhotonTracerTest)
#include "tst_photon_tracer.moc"
