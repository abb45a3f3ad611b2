// SPDX-License-Identifier: Apache-2.0
// Claims: directions survive 8 + 8 bits within .79 degrees; clustering is close to the best of 20 restarts and survives
// degenerate input; corrected VDLs keep the light on the entry's own normal for every k, printed ones show the bias of
// the formula.
#include "core/base/rng.h"
#include "core/base/sampling.h"
#include "core/octree/vdl_cluster.h"
#include "core/octree/vdl_codec.h"
#include <QtTest>
#include <cmath>

using namespace lightloom;

class VdlTest : public QObject {
    Q_OBJECT

    static std::vector<LightVector> cosineLights(std::size_t count, std::uint64_t seed, glm::vec3 n)
    {
        std::vector<LightVector> lights;
        const Frame frame(n);
        for (std::size_t i = 0; i < count; ++i) {
            Rng rng(seed, 11, i);
            const float u1 = rng.uniform(), u2 = rng.uniform();
            const glm::vec3 local = sampleCosineHemisphere(u1, u2);
            const float c = glm::max(local.z, kLeastCosine);
            lights.push_back({frame.toWorld(local), glm::vec3(1.0f, 0.5f, 0.25f) / c, 1.0f});
        }
        return lights;
    }

    static glm::vec3 shade(const std::vector<Vdl>& vdls, glm::vec3 n)
    {
        glm::vec3 e(0.0f);
        for (const Vdl& v : vdls) e += v.colour * glm::max(0.0f, glm::dot(n, v.toLight));
        return e;
    }

private Q_SLOTS:
    void directionsSurviveSixteenBits()
    {
        double worst = 0.0;
        for (std::uint64_t i = 0; i < 200'000; ++i) {
            Rng rng(1, 1, i);
            const float u1 = rng.uniform(), u2 = rng.uniform();
            const glm::vec3 d = sampleSphere(u1, u2);
            const glm::vec3 back = unpackDirection(packDirection(d));
            worst =
                std::max(worst, 2.0 * std::asin(std::min(1.0, glm::length(glm::dvec3(back) - glm::dvec3(d)) / 2.0)));
        }
        // half steps of 180/255 and 360/256 degrees at right angles: .7870
        QVERIFY2(worst * 180.0 / M_PI <= 0.788, qPrintable(QString::number(worst * 180.0 / M_PI)));
        QVERIFY(glm::length(unpackDirection(packDirection({0, 0, 1})) - glm::vec3(0, 0, 1)) <= 1e-6f);
        QVERIFY(glm::length(unpackDirection(packDirection({0, 0, -1})) - glm::vec3(0, 0, -1)) <= 1e-6f);
        QCOMPARE(packDirection({1, -1e-9f, 0}) & 255, 0); // phi wraps
    }

    void brightnessDoesNotDependOnK()
    {
        const glm::vec3 n = glm::normalize(glm::vec3(0.3f, 0.8f, -0.5f));
        const std::vector<LightVector> lights = cosineLights(400, 3, n);
        ClusterScratch scratch;
        for (std::size_t k = 1; k <= 8; ++k) {
            std::vector<Vdl> vdls(k);
            fitVdls(lights, n, VdlForm::corrected, vdls, scratch);
            const glm::vec3 e = shade(vdls, n);
            // every light has cosine 1/c * c = 1: the sum is the count, but for those under the cosine floor
            double truth = 0.0;
            for (const LightVector& l : lights) truth += static_cast<double>(l.colour.x * glm::dot(l.toLight, n));
            QVERIFY2(std::abs(static_cast<double>(e.x) / truth - 1.0) <= 1e-5,
                     qPrintable(QString("k=%1: %2 of %3").arg(k).arg(static_cast<double>(e.x)).arg(truth)));
            QVERIFY(std::abs(e.y / e.x - 0.5f) <= 1e-5f && std::abs(e.z / e.x - 0.25f) <= 1e-5f);
        }
    }

    void printedFormDarkensWithK()
    {
        // as printed, flux is shaded with the cosine a second time. One VDL at the mean direction n keeps all of it; in
        // the limit of many, the mean cosine of a cosine-distributed hemisphere is left: 2/3
        const glm::vec3 n(0, 1, 0);
        std::vector<LightVector> lights = cosineLights(20'000, 5, n);
        for (LightVector& l : lights) l.colour = glm::vec3(1.0f);
        ClusterScratch scratch;
        double before = 2.0;
        for (const std::size_t k : {1u, 2u, 4u, 8u}) {
            std::vector<Vdl> vdls(k);
            fitVdls(lights, n, VdlForm::paper, vdls, scratch);
            const double share = static_cast<double>(shade(vdls, n).x) / static_cast<double>(lights.size());
            QVERIFY2(share > 2.0 / 3.0 && share < before, qPrintable(QString("k=%1: %2").arg(k).arg(share)));
            before = share;
        }
        QVERIFY2(before <= 0.75, qPrintable(QString::number(before)));
    }

    void clustersAreNearTheBestOfTwenty()
    {
        double ours = 0.0, best = 0.0;
        for (std::uint64_t trial = 0; trial < 20; ++trial) {
            std::vector<LightVector> lights = cosineLights(300, 100 + trial, {0, 1, 0});
            ClusterScratch scratch;
            const int clusters = clusterDirections(lights, 4, scratch);
            ours += clusterCost(lights, scratch, clusters);
            double least = 1e30;
            for (std::uint64_t restart = 0; restart < 20; ++restart) {
                least = std::min(least, lloyd(lights, 4, Rng(trial, 77, restart)));
            }
            best += least;
        }
        QVERIFY2(ours <= 1.03 * best, qPrintable(QString("%1 against %2: %3").arg(ours).arg(best).arg(ours / best)));
    }

    void survivesDegenerateInput()
    {
        ClusterScratch scratch;
        const glm::vec3 n(0, 1, 0), up(0, 1, 0), down(0, -1, 0), side(1, 0, 0);
        const auto count = [&](std::vector<LightVector> lights, int k) {
            return clusterDirections(lights, k, scratch);
        };
        QCOMPARE(count({}, 4), 0);
        QCOMPARE(count({{up, glm::vec3(1), 1}}, 4), 1);
        QCOMPARE(count(std::vector<LightVector>(50, {up, glm::vec3(1), 1}), 8), 1);
        QCOMPARE(count({{up, glm::vec3(1), 1}, {side, glm::vec3(1), 1}, {up, glm::vec3(1), 1}}, 8), 2);
        QCOMPARE(count({{up, glm::vec3(1), 1}, {down, glm::vec3(1), 1}}, 8), 2);
        QCOMPARE(count({{up, glm::vec3(0), 0}, {side, glm::vec3(0), 0}}, 8), 1); // no weight: nothing to part

        std::vector<Vdl> one(1); // exactly opposite directions in one VDL: finite, not negative
        fitVdls(std::vector<LightVector>{{up, glm::vec3(1), 1}, {down, glm::vec3(1), 1}}, n, VdlForm::corrected, one,
                scratch);
        for (int c = 0; c < 3; ++c) QVERIFY(std::isfinite(one[0].colour[c]) && one[0].colour[c] >= 0.0f);
        QVERIFY(std::abs(glm::length(one[0].toLight) - 1.0f) <= 1e-5f);
    }

private:
    /// Plain k-means with random seeds in double, written without a look at ours.
    static double lloyd(const std::vector<LightVector>& lights, std::size_t k, Rng rng)
    {
        std::vector<glm::dvec3> centres;
        while (centres.size() < k) centres.emplace_back(lights[rng.bits() % lights.size()].toLight);
        std::vector<std::size_t> of(lights.size());
        double cost = 0.0;
        for (int round = 0; round < 50; ++round) {
            std::vector<glm::dvec3> sums(k, glm::dvec3(0.0));
            double weight = 0.0, length = 0.0;
            for (std::size_t i = 0; i < lights.size(); ++i) {
                for (std::size_t j = 0; j < k; ++j) {
                    const glm::dvec3 d(lights[i].toLight);
                    if (j == 0 || glm::dot(d, centres[j]) > glm::dot(d, centres[of[i]])) of[i] = j;
                }
                sums[of[i]] += static_cast<double>(lights[i].weight) * glm::dvec3(lights[i].toLight);
                weight += static_cast<double>(lights[i].weight);
            }
            for (std::size_t j = 0; j < k; ++j) {
                length += glm::length(sums[j]);
                if (glm::length(sums[j]) > 0.0) centres[j] = glm::normalize(sums[j]);
            }
            cost = 2.0 * weight - 2.0 * length;
        }
        return cost;
    }

    void scaledToALuxTheyGiveIt()
    {
        const glm::vec3 n = glm::normalize(glm::vec3(0.3f, 0.8f, -0.5f)), lux(12.0f, 0.0f, 3.0f);
        std::vector<Vdl> vdls(4);
        ClusterScratch scratch;
        fitVdls(cosineLights(400, 3, n), n, VdlForm::corrected, vdls, scratch);
        const glm::vec3 was = vdls[1].toLight;
        scaleTo(lux, n, vdls);
        QVERIFY(glm::length(shade(vdls, n) - lux) <= 1e-4f);
        QCOMPARE(vdls[1].toLight, was);
        // all light from behind the plane: one lamp of the strongest's direction stands in, and none without light
        std::vector<Vdl> behind{{{0.0f, 0.0f, 0.0f}, n}, {{0.0f, 0.0f, 0.0f}, -n}};
        scaleTo(lux, n, behind);
        QVERIFY(glm::length(shade(behind, n) - lux) <= 1e-4f);
        scaleTo(glm::vec3(0.0f), n, behind);
        QCOMPARE(shade(behind, n), glm::vec3(0.0f));
        scaleTo(lux, n, {}); // no lamp, no crash
        // grazing light must not flash on a surface that turns to it
        const Frame frame(n);
        for (const float cosine : {-0.05f, 0.0015f, 0.01f, 0.1f}) {
            const glm::vec3 d = frame.toWorld({std::sqrt(1.0f - cosine * cosine), 0.0f, cosine});
            std::vector<Vdl> grazing{{glm::vec3(1.5f), d}, {glm::vec3(0.0f), n}};
            scaleTo(glm::vec3(3.0f), n, grazing);
            QVERIFY(glm::length(shade(grazing, n) - glm::vec3(3.0f)) <= 1e-4f);
            QVERIFY(shade(grazing, glm::normalize(n + 0.6f * d)).x <= 3.0f + 4.0f * 1.5f);
        }
    }
};

QTEST_APPLESS_MAIN(VdlTest)
#include "tst_vdl.moc"
