// SPDX-License-Identifier: Apache-2.0
// Claims: light that bounces along discrete lines is what is known exactly (METHODS section 8): furnaces wherever their
// walls lie in the cells, open planes and screens (A4, A5) and plates with the same code, a lit cube (A7).
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "voxel_helpers.h"
#include <QtTest>
#include <algorithm>

using namespace lightloom;
using namespace lightloom::test;

class VoxelBouncesTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void furnacesGlowEvenly_data()
    {
        QTest::addColumn<double>("shift");
        for (const double shift : {0.0, 0.3}) QTest::addRow("shift %g", shift) << shift;
    }
    void furnacesGlowEvenly() // A8: B = E = M / (1 - rho) at every place
    {
        QFETCH(double, shift);
        const std::pair<const char*, Scene> rooms[] = {
            {"box", furnaceBox(0.5f, 1.0f, {2.0f, 1.3f, 1.7f})}, {"L", cavityL(0.5f)}, {"rooms", twoRooms()}};
        for (const auto& [name, scene] : rooms) {
            Voxels voxels(scene, 64, static_cast<float>(shift));
            for (const double rho : {0.95, 0.2, 0.5, 0.8}) {
                BounceParams params;
                params.directions = rho > 0.9 ? 512 : 256;
                std::vector<double> glow =
                    voxels.grey([](const auto&) { return 1.0; }, [&](const auto&) { return rho; }, params);
                for (double& g : glow) g *= 1.0 - rho;
                const double mean = voxels.meanOf(glow);
                std::ranges::sort(glow);
                qInfo("%s, rho %g: mean %.4f, 1st percentile %.3f, least %.3f, most %.3f", name, rho, mean,
                      glow[glow.size() / 100], glow.front(), glow.back());
                QVERIFY(std::abs(mean - 1.0) <= (rho > 0.9 ? 0.02 : 0.005));
                QVERIFY(glow[glow.size() / 100] >= 0.96);
                QVERIFY(glow.back() <= 1.001); // nothing is brighter than the furnace
            }
        }
    }

    void inTurnItIsTheSame() // Gauss-Seidel: the same furnace in fewer bounces, and one more changes nothing
    {
        Voxels voxels(twoRooms(), 48, 0.3f);
        constexpr double rho = 0.8;
        BounceParams params;
        params.directions = params.leastDirections = 256;
        params.leastGain = 1e-4f;
        params.seriesOff = 0.0f; // a furnace's light is a series from the start
        const auto count = voxels.entries().size();
        const EntryValues light{3, std::vector<float>(3 * count, 1.0f)};
        const std::vector<glm::vec3> albedo(count, glm::vec3(static_cast<float>(rho)));
        const auto table = voxels.stored(params.directions);
        Workers workers(2);
        int bounces[2] = {};
        for (const VoxelBounces order : {VoxelBounces::halving, VoxelBounces::gaussSeidel}) {
            params.order = order;
            int& taken = bounces[order == VoxelBounces::gaussSeidel];
            const EntryValues lux = bounceLight(*voxels.rays, *voxels.surface, *voxels.orders, light, albedo, params,
                                                workers, {}, &taken, table.get());
            BounceParams once = params;
            once.order = VoxelBounces::halving;
            once.mostBounces = 1;
            EntryValues leaving = light;
            for (std::size_t i = 0; i < lux.values.size(); ++i)
                leaving.values[i] += static_cast<float>(rho) * lux.values[i];
            const EntryValues next = voxels.bounced(leaving, albedo, once, 2, table.get());
            double off = 0.0, mean = 0.0, area = 0.0;
            for (std::size_t e = 0; e < count; ++e) {
                const auto a = static_cast<double>(voxels.entries()[e].area),
                           l = static_cast<double>(lux.values[3 * e]);
                const double d = static_cast<double>(next.values[3 * e]) - l;
                off += d * d * a, mean += l * a, area += a;
            }
            mean /= area;
            qInfo("%d bounces, mean %.4f of what is expected, residual %.1e", taken, mean * (1.0 - rho),
                  std::sqrt(off / area) / mean);
            QVERIFY(std::abs(mean * (1.0 - rho) - 1.0) <= 0.005);
            QVERIFY(std::sqrt(off / area) <= 1e-4 * mean);
        }
        QVERIFY(bounces[1] <= 0.75 * bounces[0]); // half as many, did each part see all others alike
    }

    void aSeriesStandsForTheLastBounces_data()
    {
        QTest::addColumn<bool>("isEarly");
        QTest::newRow("cornell") << true;
        QTest::newRow("two_rooms") << false; // light still finds its way into the other room
    }
    void aSeriesStandsForTheLastBounces() // as far off as it is taken to be, or no further than bounces to the gain
    {
        QFETCH(bool, isEarly);
        Voxels voxels(*sampleScene(QTest::currentDataTag()), 32, 0.3f);
        BounceParams params;
        params.directions = params.leastDirections = 128;
        EntryValues light;
        std::vector<glm::vec3> albedo;
        for (const Orientation& o : voxels.entries()) {
            const float lit = o.centroid.x < voxels.surface->lattice.lowest.x + 1.0f ? 1.0f : 0.0f;
            light.values.insert(light.values.end(), {lit, 0.5f * lit, 0.0f});
            albedo.emplace_back(0.8f, 0.5f, 0.3f);
        }
        const auto table = voxels.stored(params.directions);
        Workers workers(2);
        const auto solved = [&](float gain, float seriesOff, int& bounces) {
            params.leastGain = gain, params.seriesOff = seriesOff;
            return bounceLight(*voxels.rays, *voxels.surface, *voxels.orders, light, albedo, params, workers, {},
                               &bounces, table.get());
        };
        int all = 0, some = 0, early = 0;
        const EntryValues exact = solved(1e-6f, 0.0f, all), usual = solved(0.005f, 0.0f, some),
                          series = solved(0.005f, 0.5f, early);
        const auto offBy = [&](const EntryValues& of) { // as a share of an entry's light, mean by area
            double off = 0.0, area = 0.0;
            for (std::size_t e = 0; e < voxels.entries().size(); ++e) {
                double apart = 0.0, come = 0.0;
                for (std::size_t c = 3 * e; c < 3 * e + 3; ++c) {
                    apart += std::abs(static_cast<double>(of.values[c]) - static_cast<double>(exact.values[c]));
                    come += static_cast<double>(exact.values[c]);
                }
                if (!(come > 0.0)) continue;
                off += static_cast<double>(voxels.entries()[e].area) * apart / come;
                area += static_cast<double>(voxels.entries()[e].area);
            }
            return off / area;
        };
        qInfo("%d bounces, %d to the gain, off by %.5f, %d by the series, off by %.5f", all, some, offBy(usual), early,
              offBy(series));
        QVERIFY(isEarly ? early < some : early == some);
        QVERIFY(some < all);
        QVERIFY(offBy(series) <= std::max(2.0 * 0.5 * 0.005, offBy(usual))); // it is told about twice too small at most
        for (std::size_t i = 2; i < series.values.size(); i += 3) QCOMPARE(series.values[i], 0.0f); // no blue light
    }

    void reflectionOfAPlane() // A4: an open scene, by the code that furnaces use
    {
        Voxels voxels(reflectionScene(4.0f), 128);
        const std::vector<glm::dvec3> s2{{-2, 0, 0}, {2, 0, 0}, {2, 4, 0}, {-2, 4, 0}};
        hold(voxels, [&](glm::dvec3 p) { return configurationFactor(p, {0, 1, 0}, s2); });
    }

    void reflectionPastAScreen() // A5
    {
        Voxels voxels(obstructionScene(), 256);
        hold(voxels, [](glm::dvec3 p) {
            double factor = configurationFactor(p, {0, 1, 0}, {{-2, 0, 0}, {2, 0, 0}, {2, 1, 0}, {-2, 1, 0}});
            const double over = p.z > 0.5 ? p.z / (p.z - 0.5) : 4.0;
            if (over < 4.0)
                factor += configurationFactor(p, {0, 1, 0}, {{-2, over, 0}, {2, over, 0}, {2, 4, 0}, {-2, 4, 0}});
            return factor;
        });
    }

    void plates() // A9: in the middle of wide plates
    {
        const double low = 0.6, high = 0.4;
        Voxels voxels(parallelPlates(0.6f, 0.4f), 128);
        const auto isLow = [](const Orientation& o) { return o.normal.y > 0.5f; };
        BounceParams params;
        params.directions = 1024;
        const std::vector<double> lux =
            voxels.grey([&](const Orientation& o) { return isLow(o) ? 1.0 : 0.0; },
                        [&](const Orientation& o) { return isLow(o) ? low : high; }, params);
        const double leaving = 1.0 / (1.0 - low * high);
        double sum[2] = {}, area[2] = {};
        for (std::size_t e = 0; e < lux.size(); ++e) {
            const Orientation& o = voxels.entries()[e];
            if (std::abs(o.centroid.x) > 20.0f || std::abs(o.centroid.z) > 20.0f) continue;
            sum[isLow(o)] += lux[e] * static_cast<double>(o.area);
            area[isLow(o)] += static_cast<double>(o.area);
        }
        qInfo("upper %.4f, lower %.4f", sum[0] / area[0] / leaving, sum[1] / area[1] / (high * leaving));
        QVERIFY(std::abs(sum[0] / area[0] / leaving - 1.0) <= 0.01);
        QVERIFY(std::abs(sum[1] / area[1] / (high * leaving) - 1.0) <= 0.01);
    }

    void convexThingsAreAsWideAsTheyAre_data()
    {
        QTest::addColumn<std::shared_ptr<const Mesh>>("thing");
        QTest::addColumn<double>("share"); // by which it may seem wider or narrower
        const auto row = [](const char* name, Mesh mesh, double share) {
            QTest::newRow(name) << std::make_shared<const Mesh>(std::move(mesh)) << share;
        };
        const glm::vec3 middle{1.01f, 0.99f, 1.02f}; // voxels of 3.1 cm
        row("ball of 16 voxels", sphereMesh(middle, 0.25f, 32), 0.015);
        row("ball of 4 voxels", sphereMesh(middle, 0.0625f, 24), 0.03);
        row("round column of 6 voxels", cylinderMesh({1.01f, 0.4f, 1.02f}, 0.09f, 1.2f, 24), 0.05);
        row("box", boxMesh({0.71f, 0.62f, 0.83f}, {1.33f, 1.41f, 1.24f}), 0.04);
        row("square column, .4 of a voxel", boxMesh({1.0f, 0.3f, 1.0f}, {1.0125f, 1.7f, 1.0125f}), 0.12);
    }
    void convexThingsAreAsWideAsTheyAre() // reciprocity: the walls see of it A_thing / A_walls, as it sees them alone
    {
        QFETCH(std::shared_ptr<const Mesh>, thing);
        QFETCH(double, share);
        SceneBuilder builder("thing in a room");
        const int white = builder.addMaterial("white", glm::vec3(0.5f));
        builder.add("Room", boxMesh({0.0f, 0.0f, 0.0f}, {2.0f, 2.0f, 2.0f}, Facing::in), white);
        builder.add("Thing", *thing, white);
        builder.addPoint("Lamp", {0.1f, 1.9f, 0.1f}, glm::vec3(1.0f));
        const Scene scene = builder.finish();
        BounceParams params;
        params.mostBounces = 1;
        params.directions = 128;
        const float shifts[] = {0.0f, 0.25f, 0.5f, 0.75f};
        double mean = 0.0; // one shift may widen it or narrow it by a part of a voxel
        for (const float shift : shifts) {
            Voxels voxels(scene, 64, shift);
            const auto isWall = [](const Orientation& o) {
                return glm::any(glm::greaterThan(glm::abs(o.centroid - 1.0f), glm::vec3(0.99f)));
            };
            double area[2] = {};
            for (const Orientation& o : voxels.entries()) area[isWall(o)] += static_cast<double>(o.area);
            const std::vector<double> lux = voxels.grey([&](const Orientation& o) { return isWall(o) ? 1.0 : 0.0; },
                                                        [](const auto&) { return 0.0; }, params);
            double sum[2] = {};
            for (std::size_t e = 0; e < lux.size(); ++e) {
                const Orientation& o = voxels.entries()[e];
                sum[isWall(o)] += lux[e] * static_cast<double>(o.area);
            }
            const double ofWalls = sum[0] / area[0], width = (area[1] - sum[1]) / area[0];
            qInfo("shift %g: as wide as %.4f, sees %.4f", static_cast<double>(shift), width, ofWalls);
            QVERIFY(std::abs(ofWalls - 1.0) <= 0.002);
            mean += width / static_cast<double>(std::size(shifts));
        }
        qInfo("as wide as %.4f", mean);
        QVERIFY(std::abs(mean - 1.0) <= share);
    }

    void aLitCube() // A7: the mean of what is reflected
    {
        const double rho = 0.5, candela = 100.0;
        Voxels voxels(litCube(0.5f), 48, 0.3f);
        const std::vector<double> lux = voxels.grey(
            [&](const Orientation& o) {
                const glm::dvec3 p(o.centroid);
                return rho * candela / std::pow(glm::dot(p, p), 1.5);
            },
            [&](const auto&) { return rho; });
        const double expected = 4.0 * std::numbers::pi * candela * rho / (24.0 * (1.0 - rho));
        qInfo("mean %.4f of what is expected", voxels.meanOf(lux) / expected);
        QVERIFY(std::abs(voxels.meanOf(lux) / expected - 1.0) <= 0.01);
    }

    void aSmallBrightPatch()
    {
        // the floor of a closed room under a lamp 3 cm above it: what comes straight from every place of it is known;
        // lines meet the bright ones by chance only
        Voxels voxels(furnaceBox(0.5f, 1.0f, {2.0f, 2.0f, 2.0f}), 64, 0.3f);
        const std::vector<glm::vec3> albedo(voxels.entries().size(), glm::vec3(0.0f));
        EntryValues light;
        std::vector<std::pair<const Orientation*, double>> lumen;
        double brightest = 0.0, all = 0.0;
        for (const Orientation& o : voxels.entries()) {
            const float x = o.centroid.x - 0.2f, z = o.centroid.z + 0.1f, r2 = 9e-4f + x * x + z * z;
            const float sent = o.normal.y > 0.5f ? 1e-3f / (r2 * r2) : 0.0f;
            light.values.insert(light.values.end(), 3, sent);
            if (sent > 0.0f) lumen.emplace_back(&o, static_cast<double>(sent * o.area));
            all += static_cast<double>(sent * o.area);
            if (x * x + z * z < 0.0036f) brightest += static_cast<double>(sent * o.area);
        }
        QVERIFY(brightest > 0.7 * all && brightest < 0.9 * all); // within 6 cm
        BounceParams params;
        params.mostBounces = 1;
        const EntryValues lux = voxels.bounced(light, albedo, params);
        for (const glm::vec3 wall : {glm::vec3(0, -1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1)}) {
            double squares = 0.0, expectedSquares = 0.0, sum = 0.0, expectedSum = 0.0;
            for (std::size_t e = 0; e < voxels.entries().size(); ++e) {
                const Orientation& o = voxels.entries()[e];
                if (glm::dot(o.normal, wall) < 0.9f) continue;
                double expected = 0.0;
                for (const auto& [source, flux] : lumen) {
                    const glm::vec3 way = source->centroid - o.centroid;
                    const float r2 = glm::dot(way, way);
                    expected += flux * static_cast<double>(glm::max(0.0f, glm::dot(way, o.normal)) *
                                                           glm::max(0.0f, -glm::dot(way, source->normal)) / (r2 * r2));
                }
                expected /= kPiD;
                const double off = static_cast<double>(lux.values[3 * e]) - expected, a = static_cast<double>(o.area);
                squares += off * off * a, expectedSquares += expected * expected * a;
                sum += off * a, expectedSum += expected * a;
            }
            qInfo("rms %.4f, mean %+.4f", std::sqrt(squares / expectedSquares), sum / expectedSum);
            QVERIFY(std::sqrt(squares / expectedSquares) <= 0.08);
            QVERIFY(std::abs(sum / expectedSum) <= 0.02);
        }
    }

    void wallsWithinAVoxelDoNotLeak()
    {
        for (const float thick : {0.001f, 0.02f, 0.05f}) { // voxels of 6.6 cm
            SceneBuilder builder("parted");
            const int white = builder.addMaterial("white", glm::vec3(0.6f));
            builder.add("Room", boxMesh({0.0f, 0.0f, 0.0f}, {4.0f, 1.5f, 2.0f}, Facing::in), white);
            builder.add("Wall", boxMesh({2.0f, -0.1f, -0.1f}, {2.0f + thick, 1.6f, 2.1f}, Facing::out), white);
            builder.addPoint("Left", {1.0f, 1.0f, 1.0f}, glm::vec3(1.0f));
            builder.addPoint("Right", {3.0f, 1.0f, 1.0f}, glm::vec3(1.0f));
            const Scene scene = builder.finish();
            for (const float shift : {0.0f, 0.25f, 0.5f, 0.75f}) {
                Voxels voxels(scene, 64, shift);
                const float wall = 2.0f + 0.5f * thick;
                const auto isLeft = [&](const Orientation& o) { return o.centroid.x < wall; };
                const std::vector<double> lux = voxels.grey([&](const Orientation& o) { return isLeft(o) ? 1.0 : 0.0; },
                                                            [](const auto&) { return 0.6; });
                double sum[2] = {}, area[2] = {};
                for (std::size_t e = 0; e < lux.size(); ++e) {
                    const Orientation& o = voxels.entries()[e];
                    sum[isLeft(o)] += lux[e] * static_cast<double>(o.area);
                    area[isLeft(o)] += static_cast<double>(o.area);
                }
                const double leak = sum[0] / area[0] / (sum[1] / area[1]);
                qInfo("%g cm, shift %g: %.3f %%, lit side %.4f", 100.0 * double(thick), double(shift), 100.0 * leak,
                      sum[1] / area[1] * 0.4);
                QVERIFY(leak <= 0.02);
            }
        }
    }

private:
    /// The wall before a plane that sends 500 lm/m2 up: its light against `factor` times that, from two cells up. Open
    /// rims are off by a part of a cell, which goes with the cell's size (4.5, 2.4, 1.3 % at 32, 64, 128 cells in A4).
    template<class Factor>
    static void hold(Voxels voxels, Factor factor)
    {
        BounceParams params;
        params.directions = 1024;
        params.mostBounces = 1; // nothing is reflected
        const auto isPlane = [](const Orientation& o) { return o.normal.y > 0.5f && o.centroid.y < 0.01f; };
        const std::vector<double> lux = voxels.grey([&](const Orientation& o) { return isPlane(o) ? 500.0 : 0.0; },
                                                    [](const auto&) { return 0.0; }, params);
        double found = 0.0, expected = 0.0, squares = 0.0, all = 0.0;
        for (std::size_t e = 0; e < lux.size(); ++e) {
            const Orientation& o = voxels.entries()[e];
            const glm::dvec3 p(o.centroid.z, o.centroid.x, o.centroid.y); // z up, as the scenes are described
            const bool isWall = o.normal.x > 0.5f && std::abs(p.y) < 0.01;
            if (!isWall || std::abs(p.x) > 1.0 || p.z < 2.0 * static_cast<double>(voxels.surface->cellSize())) continue;
            const double exact = 500.0 * factor(p), area = static_cast<double>(o.area);
            found += lux[e] * area;
            expected += exact * area;
            squares += (lux[e] - exact) * (lux[e] - exact) * area;
            all += exact * exact * area;
        }
        qInfo("mean %.4f of what is expected, rms %.4f", found / expected, std::sqrt(squares / all));
        QVERIFY(std::abs(found / expected - 1.0) <= 0.02);
        QVERIFY(std::sqrt(squares / all) <= 0.06);
    }
};

QTEST_APPLESS_MAIN(VoxelBouncesTest)
#include "tst_voxel_bounces.moc"
