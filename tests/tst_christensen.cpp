// SPDX-License-Identifier: Apache-2.0
// Claims: Christensen's cache keeps what density estimation says at every 4th photon, to the bit, and answers with the
// nearest one that faces alike and lies within the kernel: right where light is even, in patches where it is not. It is
// kept, stored and filled anew like other products. Without the normal filter a gather takes light from round corners.
#include "bake_helpers.h"
#include "core/bake/bake_file.h"
#include "core/base/units.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "light_helpers.h"
#include <set>

using namespace lightloom;
using namespace lightloom::test;

namespace {

BakeParams cachedParams(int photons = 60'000)
{
    BakeParams params;
    params.photonCount = photons;
    params.gatherCount = 100;
    params.photonLookup = PhotonLookup::christensen;
    return params;
}

BakeParams direct(BakeParams params)
{
    params.photonLookup = PhotonLookup::direct;
    return params;
}

Baked bake(const std::shared_ptr<const Scene>& scene, const BakeParams& params, BakeProducts& products, int threads = 2,
           const Mix& mix = {})
{
    PhotonMapSolver solver;
    return runSolver(solver, {scene, params, mix}, products, threads);
}

std::shared_ptr<const PhotonMapField> fieldOf(const Baked& baked)
{
    return std::dynamic_pointer_cast<const PhotonMapField>(baked.field);
}

} // namespace

class ChristensenTest : public QObject {
    Q_OBJECT

    std::shared_ptr<const Scene> cornell_;
    BakeProducts products_;
    std::shared_ptr<const PhotonMapField> cached_, direct_;

private Q_SLOTS:
    void initTestCase()
    {
        cornell_ = share(cornellBox());
        cached_ = fieldOf(bake(cornell_, cachedParams(), products_));
        direct_ = fieldOf(bake(cornell_, direct(cachedParams()), products_));
        QVERIFY(cached_ && direct_);
        QVERIFY(cached_->layers()[0].cache && !direct_->layers()[0].cache);
    }

    void keepsTheEstimateOfEveryFourthPhoton()
    {
        const PhotonMap& map = *direct_->layers()[0].map;
        const ChristensenCache::Values& kept = cached_->layers()[0].cache->values();
        QCOMPARE(kept.lux.size(), (map.size() + 3) / 4);
        const std::vector<std::uint32_t> order = map.listOrder(); // the cache keeps photons in the order they were shot
        for (std::uint32_t i = 0; i < map.size(); i += 4 * 37) {
            const Photon& photon = map.photon(order[i]);
            glm::vec3 wanted(0.0f), found(0.0f);
            QVERIFY(direct_->lookup(photon.position, photon.normal, wanted));
            QCOMPARE(kept.lux[i / 4], wanted);
            QVERIFY(cached_->lookup(photon.position, photon.normal, found));
            QCOMPARE(found, wanted); // the nearest is the photon itself
            const auto a = direct_->noise(photon.position, photon.normal);
            const auto b = cached_->noise(photon.position, photon.normal);
            QVERIFY(a && b && std::abs(*a - *b) <= 1e-4f * *a);
        }
    }

    void evenLightIsRight() // furnace: M rho / (1 - rho) everywhere
    {
        const auto scene = share(furnaceBox(0.5f));
        BakeParams params = cachedParams(200'000);
        params.gatherCount = 200;
        BakeProducts products;
        const auto field = fieldOf(bake(scene, params, products));
        QVERIFY(field);
        RunningMean mean;
        int far = 0;
        double worst = 0.0;
        for (const FacePoint& p : facePoints(*scene, 4000, 1)) {
            const double lux = field->irradiance(p.position, p.normal).x;
            // 6 % noise; 24 % in a corner, where a plane through the photons is held up by a quarter of a disc
            far += std::abs(lux - 1.0) > 0.4;
            worst = std::max(worst, std::abs(lux - 1.0));
            mean.add(lux);
        }
        qInfo("furnace: mean %.4f, %d points far off, the worst by %.2f", mean.mean(), far, worst);
        QVERIFY2(far <= 2, qPrintable(QString::number(far)));
        QVERIFY2(worst <= 0.5, qPrintable(QString::number(worst)));
        QVERIFY(std::abs(mean.mean() - 1.0) <= 0.02);
    }

    void agreesWithTheDensityEstimate()
    {
        double squares = 0.0, bias = 0.0, mean = 0.0, noise = 0.0;
        int count = 0;
        for (const FacePoint& p : facePoints(*cornell_, 3000, 2)) {
            glm::vec3 a(0.0f), b(0.0f);
            if (!direct_->lookup(p.position, p.normal, a) || !cached_->lookup(p.position, p.normal, b)) continue;
            const double off = luminance(b) - luminance(a), said = *direct_->noise(p.position, p.normal);
            squares += off * off, bias += off, mean += luminance(a), noise += said * said;
            ++count;
        }
        const double rms = std::sqrt(squares / count) / (mean / count),
                     stated = std::sqrt(noise / count) / (mean / count);
        qInfo("against density estimation at %d points: rms %.3f, bias %+.4f; its own noise %.3f of the mean", count,
              rms, bias / mean, stated);
        QVERIFY(count > 2500);
        QVERIFY(rms <= stated); // moving to the nearest photon costs less than the noise there is
        QVERIFY(std::abs(bias / mean) <= 0.01);
    }

    void lightStandsInPatches()
    {
        std::set<float> cached, estimated;
        for (int i = 0; i < 2000; ++i) { // across the floor
            const float t = 0.1f + 0.8f * static_cast<float>(i) / 1999.0f;
            const glm::vec3 p = glm::mix(cornell_->bounds.low, cornell_->bounds.high, glm::vec3(t, 0.0f, 0.85f));
            cached.insert(cached_->irradiance(p, glm::vec3(0, 1, 0)).y);
            estimated.insert(direct_->irradiance(p, glm::vec3(0, 1, 0)).y);
        }
        qInfo("2000 points across the floor: %zu values cached, %zu estimated", cached.size(), estimated.size());
        QVERIFY(cached.size() * 5 < estimated.size());
        QVERIFY(cached.size() > 20);
    }

    void radiusIsBounded()
    {
        const auto& layer = cached_->layers()[0];
        const glm::vec3 centre = cornell_->bounds.centre(), up(0, 1, 0);
        QVERIFY(layer.kernel.cap < 0.2f * cornell_->bounds.longestSide());
        QVERIFY(!layer.cache->lookup(cornell_->bounds.high + glm::vec3(3.0f * layer.kernel.cap), up));
        const Photon& photon = layer.map->photon(0);
        QVERIFY(layer.cache->lookup(photon.position, photon.normal));
        // as the density estimate: no answer where there is no surface
        glm::vec3 a(1.0f), b(1.0f);
        QCOMPARE(cached_->lookup(centre + glm::vec3(100.0f), up, a),
                 direct_->lookup(centre + glm::vec3(100.0f), up, b));
        QCOMPARE(a, b);
        // facing the other way there is nothing near that faces alike
        for (std::uint32_t i = 0; i < 400; i += 4) {
            const Photon& at = layer.map->photon(i);
            const auto found = layer.cache->lookup(at.position, -at.normal);
            const auto own = layer.cache->lookup(at.position, at.normal);
            QVERIFY(own && (!found || found->lux != own->lux));
        }
    }

    void fewPhotonsAreSurvived_data()
    {
        QTest::addColumn<int>("photons");
        for (const int n : {0, 1, 2, 4, 5, 50}) QTest::addRow("%d", n) << n;
    }
    void fewPhotonsAreSurvived()
    {
        QFETCH(int, photons);
        BakeProducts products;
        const auto field = fieldOf(bake(cornell_, cachedParams(photons), products));
        const auto estimate = fieldOf(bake(cornell_, direct(cachedParams(photons)), products));
        QVERIFY(field && estimate);
        for (const FacePoint& p : facePoints(*cornell_, 200, 3)) {
            glm::vec3 a(0.0f), b(0.0f);
            QCOMPARE(field->lookup(p.position, p.normal, a), estimate->lookup(p.position, p.normal, b));
            QVERIFY(std::isfinite(luminance(a)) && luminance(a) >= 0.0f);
            if (photons == 0) QCOMPARE(a, glm::vec3(0.0f));
        }
    }

    void dimmingNeedsNoNewCache()
    {
        const auto half = cached_->withMix(Mix(cornell_->groups.size(), glm::vec3(0.5f)));
        const glm::vec3 p = cornell_->bounds.centre() * glm::vec3(1, 0, 1) + glm::vec3(0, cornell_->bounds.low.y, 0);
        glm::vec3 full(0.0f), dimmed(0.0f);
        QVERIFY(cached_->lookup(p, glm::vec3(0, 1, 0), full) && half->lookup(p, glm::vec3(0, 1, 0), dimmed));
        QVERIFY(glm::length(dimmed - 0.5f * full) <= 1e-6f * glm::length(full));
        QVERIFY(std::abs(*half->noise(p, glm::vec3(0, 1, 0)) - 0.5f * *cached_->noise(p, glm::vec3(0, 1, 0))) <=
                1e-5f * *cached_->noise(p, glm::vec3(0, 1, 0)));
    }

    void isKeptBetweenBakes()
    {
        const Baked again = bake(cornell_, cachedParams(), products_);
        QCOMPARE(again.counters.gathers, std::uint64_t(0));
        QCOMPARE(again.counters.photonsShot, std::uint64_t(0));
        QCOMPARE(fieldOf(again)->layers()[0].cache, cached_->layers()[0].cache);
        BakeParams other = cachedParams();
        other.gatherCount = 50;
        const Baked finer = bake(cornell_, other, products_);
        QCOMPARE(finer.counters.photonsShot, std::uint64_t(0));
        QVERIFY(finer.counters.gathers > 0);
        QVERIFY(fieldOf(finer)->layers()[0].cache->values().lux != cached_->layers()[0].cache->values().lux);
    }

    void sameBitsOnAnyThreadsAndFromAFile()
    {
        BakeProducts products;
        const auto field = fieldOf(bake(cornell_, cachedParams(), products, 3));
        QVERIFY(field->layers()[0].cache->values().lux == cached_->layers()[0].cache->values().lux);
        QVERIFY(field->layers()[0].cache->values().noise == cached_->layers()[0].cache->values().noise);

        BakeInfo info;
        info.method = Method::photonMap;
        info.params = cachedParams();
        info.sceneHash = sceneHash(*cornell_);
        info.isa = "avx2";
        const auto bytes = bakeBytes(*cached_, info, *cornell_);
        QVERIFY(bytes);
        auto file = bakeFromBytes(*bytes, *cornell_);
        QVERIFY2(file, file ? "" : file.error().message.c_str());
        QCOMPARE(file->caches.size(), cornell_->groups.size());
        QVERIFY(file->caches[0].lux == cached_->layers()[0].cache->values().lux);
        const auto restored = withCaches(*direct_, std::move(file->caches), {});
        QVERIFY(restored);
        for (const FacePoint& p : facePoints(*cornell_, 500, 4)) {
            glm::vec3 a(0.0f), b(0.0f);
            QCOMPARE(cached_->lookup(p.position, p.normal, a), (*restored)->lookup(p.position, p.normal, b));
            QCOMPARE(a, b);
        }
        QVERIFY(!withCaches(*direct_, {ChristensenCache::Values{{glm::vec3(1.0f)}, {0.0f}}}, {}));
    }

    void stopIsSeen()
    {
        Workers workers(2);
        std::stop_source stop;
        stop.request_stop();
        BakeControl control(workers, {}, stop.get_token());
        QVERIFY(!withCaches(*direct_, control));
    }

    void withoutTheFilterLightTurnsCorners()
    {
        BakeParams all = direct(cachedParams());
        all.gatherFilter = Switch::off;
        const auto unfiltered = fieldOf(bake(cornell_, all, products_));
        const auto atEdge = [&](const PhotonMapField& field) { // on the floor, just before the red wall, lit by others
            RunningMean mean;
            for (int i = 0; i < 200; ++i) {
                const float t = 0.2f + 0.6f * static_cast<float>(i) / 199.0f;
                const glm::vec3 p = glm::mix(cornell_->bounds.low, cornell_->bounds.high, glm::vec3(0.002f, 0.0f, t));
                mean.add(luminance(field.irradiance(p, glm::vec3(0, 1, 0))));
            }
            return mean.mean();
        };
        const double with = atEdge(*direct_), without = atEdge(*unfiltered);
        RunningMean off;
        for (int i = 0; i < 200; ++i) { // in the open floor nothing else is within the kernel
            const glm::vec3 p = glm::mix(cornell_->bounds.low, cornell_->bounds.high,
                                         glm::vec3(0.4f + 0.001f * static_cast<float>(i), 0.0f, 0.9f));
            off.add(std::abs(luminance(unfiltered->irradiance(p, glm::vec3(0, 1, 0))) -
                             luminance(direct_->irradiance(p, glm::vec3(0, 1, 0)))));
        }
        qInfo("floor before the wall: %.3f lx filtered, %.3f not", with, without);
        QVERIFY(std::abs(without / with - 1.0) >= 0.03);
        QCOMPARE(off.mean(), 0.0);
        // no light is made by it: a furnace stays one
        const auto furnace = share(furnaceBox(0.5f));
        BakeProducts products;
        const auto field = fieldOf(bake(furnace, all, products));
        RunningMean mean;
        for (const FacePoint& p : facePoints(*furnace, 2000, 5)) mean.add(field->irradiance(p.position, p.normal).x);
        QVERIFY(std::abs(mean.mean() - 1.0) <= 0.02);
    }
};

QTEST_APPLESS_MAIN(ChristensenTest)
#include "tst_christensen.moc"
