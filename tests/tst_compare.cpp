// SPDX-License-Identifier: Apache-2.0
// Claim: errors are measured as METHODS defines them (held against numbers worked out by hand), what is no number never
// becomes one, tables are read and written without loss and complain with the line, FLIP behaves as its paper says.
#include "core/base/rng.h"
#include "core/base/units.h"
#include "core/compare/flip.h"
#include "core/compare/image_error.h"
#include "core/compare/legend.h"
#include "core/compare/probes.h"
#include <QtTest>
#include <bit>
#include <cmath>
#include <limits>
#include <set>

using namespace lightloom;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool isNear(double value, double wanted, double limit = 1e-12) { return std::abs(value - wanted) <= limit; }

FloatImage filled(int width, int height, glm::vec3 colour)
{
    FloatImage image(width, height);
    for (glm::vec3& p : image.pixels) p = colour;
    return image;
}

FloatImage noisy(FloatImage image, float amount, std::uint64_t seed)
{
    Rng rng(seed, 0, 0);
    for (glm::vec3& p : image.pixels) p += amount * (rng.uniform() - 0.5f);
    return image;
}

FloatImage stripes(int width, int height)
{
    FloatImage image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) image.at(x, y) = glm::vec3((x / 8 + y / 8) % 2 ? 0.8f : 0.1f);
    }
    return image;
}

/// CIELAB of a linear colour, written out from CIE 15 for the test alone.
glm::dvec3 labOf(glm::dvec3 c)
{
    const double x = (0.4124 * c.x + 0.3576 * c.y + 0.1805 * c.z) / 0.9505;
    const double y = 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
    const double z = (0.0193 * c.x + 0.1192 * c.y + 0.9505 * c.z) / 1.089;
    const auto f = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0; };
    return {116.0 * f(y) - 16.0, 500.0 * (f(x) - f(y)), 200.0 * (f(y) - f(z))};
}

} // namespace

class CompareTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void metricsByHand()
    {
        // d = 1 -1 0 2, mean reference 2.5
        const std::vector<double> reference{1, 2, 3, 4}, values{2, 1, 3, 6};
        const Result<ErrorMetrics> m = measureError(values, reference);
        QVERIFY(static_cast<bool>(m));
        QCOMPARE(m->count, std::uint64_t{4});
        QVERIFY(isNear(m->meanReference, 2.5));
        QVERIFY(isNear(m->relRmse, std::sqrt(6.0 / 4.0) / 2.5));
        QVERIFY(isNear(m->bias, 0.5 / 2.5));
        QVERIFY(isNear(m->mae, 1.0 / 2.5));
        QVERIFY(isNear(m->max, 2.0 / 2.5));
        QVERIFY(isNear(m->p95, 2.0 / 2.5)); // rank ceil(3.8) = 4 of 4
        QVERIFY(isNear(m->perPoint, std::sqrt((1.0 + 0.25 + 0.0 + 0.25) / 4.0)));
        QVERIFY(isNear(measureError(reference, values)->bias, -0.5 / 3.0)); // too dark is below 0
    }

    void luminanceIsThatOfRec709()
    {
        const std::vector<glm::vec3> primaries{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        const std::vector<double> found = luminances(primaries), expected{0.2126, 0.7152, 0.0722};
        for (std::size_t i = 0; i < 3; ++i) QVERIFY(std::abs(found[i] - expected[i]) <= 1e-7);
    }

    void percentileIsTheNearestRank()
    {
        std::vector<double> reference(100, 1.0), values(100, 1.0);
        for (std::size_t i = 0; i < 100; ++i) values[i] += static_cast<double>((i * 37) % 100 + 1) / 100.0;
        QVERIFY(isNear(measureError(values, reference)->p95, 0.95, 1e-9));
    }

    void perPointHasAFloorOfOnePercent()
    {
        // the second point is dark: its error counts against .01 * mean, not against 0
        const std::vector<double> reference{2, 0}, values{2, 0.1};
        const Result<ErrorMetrics> m = measureError(values, reference);
        QVERIFY(isNear(m->perPoint, std::sqrt(0.5 * std::pow(0.1 / 0.01, 2))));
    }

    void blackAndBrokenInputs()
    {
        const std::vector<double> black(3, 0.0), lit(3, 1.0), broken{1.0, kNaN, 1.0},
            endless{1.0, 1.0, std::numeric_limits<double>::infinity()};
        QCOMPARE(measureError(black, black)->relRmse, 0.0);
        QVERIFY(!measureError(lit, black));
        QVERIFY(!measureError(lit, std::vector<double>(3, -1.0)));
        QVERIFY(!measureError({}, {}));
        QVERIFY(!measureError(lit, std::vector<double>(2, 1.0)));
        QVERIFY(measureError(broken, lit).error().message.find("value 2 of the result") != std::string::npos);
        QVERIFY(measureError(lit, broken).error().message.find("value 2 of the reference") != std::string::npos);
        QVERIFY(!measureError(endless, lit));
    }

    void noiseOfAReference()
    {
        const std::vector<glm::vec3> errors(7, glm::vec3(0.03f));
        QVERIFY(isNear(relativeNoise(errors, 1.5), 0.02, 1e-8));
        QCOMPARE(relativeNoise({}, 1.5), 0.0);
    }

    void pointsSurviveARoundTrip()
    {
        std::vector<ProbeRow> rows{{{0.1, -2.5e-7, 1e6}, {0, 1, 0}}, {{1.0 / 3.0, 0, 0}, {0, 0, -7.25}}};
        const std::string text = pointsText(rows);
        QVERIFY(text.starts_with("x,y,z,nx,ny,nz\n0.1,-2.5e-07,1000000,0,1,0\n"));
        const Result<std::vector<ProbeRow>> read = parsePoints(text);
        QVERIFY2(static_cast<bool>(read), read ? "" : read.error().message.c_str());
        QVERIFY(*read == rows);
        QVERIFY(parsePoints("x,y,z,nx,ny,nz\n")->empty());
        QVERIFY(static_cast<bool>(parsePoints("\xEF\xBB\xBFx, y, z, nx, ny, nz\r\n1, 2, 3, 0, 0, 1\r\n\r\n")));
    }

    void wrongPointsNameTheLine_data()
    {
        QTest::addColumn<QString>("rows");
        QTest::addColumn<QString>("mention");
        QTest::newRow("zero normal") << "0,0,0,0,1,0\n0,0,0,0,0,0\n"
                                     << "line 3: the normal 0 0 0";
        QTest::newRow("nan") << "0,nan,0,0,1,0\n"
                             << "line 2: y ";
        QTest::newRow("infinite") << "0,0,0,0,inf,0\n"
                                  << "line 2: ny ";
        QTest::newRow("overflow") << "0,0,0,0,1e400,0\n"
                                  << "line 2: ny ";
        QTest::newRow("too few") << "0,0,0,0,1,0\n0,0,0,0,1\n"
                                 << "line 3: expected 6 numbers, found 5";
        QTest::newRow("too many") << "0,0,0,0,1,0,0\n"
                                  << "found 7";
        QTest::newRow("word") << "0,0,up,0,1,0\n"
                              << "line 2: z should be a finite number, it is \"up\"";
        QTest::newRow("trailing") << "0,0,0m,0,1,0\n"
                                  << "\"0m\"";
        QTest::newRow("hole") << "0,0,0,0,1,0\n\n0,0,0,0,1,0\n"
                              << "line 3";
        QTest::newRow("control") << "0,\x1b[31m,0,0,1,0\n"
                                 << "\"?[31m\"";
    }
    void wrongPointsNameTheLine()
    {
        QFETCH(QString, rows);
        QFETCH(QString, mention);
        const auto read = parsePoints("x,y,z,nx,ny,nz\n" + rows.toStdString());
        QVERIFY(!read);
        QVERIFY2(QString::fromStdString(read.error().message).contains(mention), read.error().message.c_str());
    }

    void wrongHeaderIsRefused()
    {
        QVERIFY(!parsePoints(""));
        QVERIFY(parsePoints("a,b,c\n").error().message.starts_with("line 1: expected the header x,y,z,nx,ny,nz"));
        QVERIFY(!parseResult("x,y,z,nx,ny,nz\n0,0,0,0,1,0\n"));
    }

    void resultsSurviveARoundTrip()
    {
        Rng rng(7, 0, 0);
        ProbeTable table;
        for (int i = 0; i < 50; ++i) {
            const auto any = [&] { return std::ldexp(rng.uniform(), static_cast<int>(rng.bits() % 60) - 30); };
            table.points.push_back({{any(), -any(), any()}, {0, 1, any()}});
            table.direct.emplace_back(any(), any(), any());
            table.indirect.emplace_back(any(), any(), any());
            table.standardError.emplace_back(any(), any(), any());
        }
        const std::string text = resultText(table);
        QVERIFY(text.starts_with("x,y,z,nx,ny,nz,direct_r,direct_g,direct_b,indirect_r,indirect_g,indirect_b,"
                                 "stderr_r,stderr_g,stderr_b\n"));
        const Result<ProbeTable> read = parseResult(text);
        QVERIFY2(static_cast<bool>(read), read ? "" : read.error().message.c_str());
        QVERIFY(read->points == table.points && read->direct == table.direct && read->indirect == table.indirect);
        QVERIFY(read->standardError == table.standardError);

        const Result<ProbeTable> partial = parseResult(resultText(table, 80));
        QVERIFY(!partial);
        QVERIFY2(partial.error().message.starts_with("line 52") &&
                     partial.error().message.find("50 of 80") != std::string::npos,
                 partial.error().message.c_str());
    }

    void foreignReferencesAreRead()
    {
        const auto read = parseResult("direct_r,direct_g,direct_b,indirect_r,indirect_g,indirect_b\n1,2,3,4,5,6\n");
        QVERIFY(static_cast<bool>(read));
        QVERIFY(read->points.empty() && read->indirect.at(0) == glm::vec3(4, 5, 6));
    }

    void aRowsStreamIsItsOwn()
    {
        Scene scene;
        scene.origin = {100, 0, 0};
        const ProbeRow row{{101, 2, 3}, {0, 0, 5}};
        const ProbePoint point = inScene(scene, row);
        QCOMPARE(point.position.x, 1.0f);
        QCOMPARE(point.normal.z, 1.0f);
        QCOMPARE(inScene(scene, ProbeRow{{101, 2, 3}, {-0.0, 0, 5}}).stream, point.stream);
        std::set<std::uint64_t> streams;
        for (int i = 0; i < 1000; ++i) streams.insert(inScene(scene, ProbeRow{{101, 2, i}, {0, 0, 5}}).stream);
        for (int i = 0; i < 1000; ++i) streams.insert(inScene(scene, ProbeRow{{101, i, 2000}, {0, 0, 5}}).stream);
        QCOMPARE(streams.size(), std::size_t{2000});
    }

    void flipOfAPictureWithItselfIsZero()
    {
        const FloatImage image = noisy(stripes(64, 48), 0.2f, 1);
        QCOMPARE(meanOf(flipMap(image, image)), 0.0);
    }

    void flipIsSymmetric()
    {
        const FloatImage a = stripes(64, 48), b = noisy(a, 0.3f, 2);
        const ScalarImage ab = flipMap(a, b), ba = flipMap(b, a);
        for (std::size_t i = 0; i < ab.values.size(); ++i) {
            QVERIFY(std::abs(ab.values[i] - ba.values[i]) <= 1e-5f);
            QVERIFY(ab.values[i] >= 0.0f && ab.values[i] <= 1.0f);
        }
        QVERIFY(meanOf(ab) > 0.01);
    }

    void flipOfUniformPicturesByHand()
    {
        // no filter and no feature acts on a uniform picture; what is left is the colour formula of section 4.1
        const auto hunt = [](glm::dvec3 lab) { return glm::dvec3(lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z); };
        const auto hyab = [&](glm::dvec3 a, glm::dvec3 b) {
            const glm::dvec3 d = hunt(labOf(a)) - hunt(labOf(b));
            return std::pow(std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z), 0.7);
        };
        const double most = hyab({0, 1, 0}, {0, 0, 1});
        const auto wanted = [&](glm::dvec3 a, glm::dvec3 b) {
            const double e = hyab(a, b);
            return e < 0.4 * most ? 0.95 * e / (0.4 * most) : 0.95 + 0.05 * (e - 0.4 * most) / (0.6 * most);
        };
        const std::vector<std::pair<glm::vec3, glm::vec3>> pairs{
            {glm::vec3(0.0f), glm::vec3(1.0f)}, {{0, 1, 0}, {0, 0, 1}}, {{0.5f, 0.2f, 0.1f}, {0.45f, 0.22f, 0.1f}}};
        for (const auto& [a, b] : pairs) {
            const double flip = meanOf(flipMap(filled(40, 30, a), filled(40, 30, b)));
            const double exact = wanted(glm::dvec3(a), glm::dvec3(b));
            QVERIFY2(isNear(flip, exact, 2e-3), qPrintable(QString("%1, by hand %2").arg(flip).arg(exact)));
        }
    }

    void flipSeesMoreNoiseAsWorse()
    {
        const FloatImage image = stripes(64, 48);
        double last = 0;
        for (const float amount : {0.02f, 0.1f, 0.4f}) {
            const double flip = meanOf(flipMap(noisy(image, amount, 3), image));
            QVERIFY2(flip > last && flip < 1.0, qPrintable(QString("%1 after %2").arg(flip).arg(last)));
            last = flip;
        }
    }

    void falseColourIsEven()
    {
        double least = 1e9, most = 0, lightness = -1;
        for (int i = 0; i < 64; ++i) {
            const glm::dvec3 a = labOf(glm::dvec3(falseColour(static_cast<float>(i) / 64.0f)));
            const glm::dvec3 b = labOf(glm::dvec3(falseColour(static_cast<float>(i + 1) / 64.0f)));
            const double step = glm::length(a - b);
            least = std::min(least, step);
            most = std::max(most, step);
            QVERIFY2(a.x > lightness && b.x > a.x, qPrintable(QString("step %1 does not get lighter").arg(i)));
            lightness = a.x;
        }
        QVERIFY2(most <= 1.1 * least, qPrintable(QString("steps from %1 to %2").arg(least).arg(most)));
        QVERIFY(falseColour(std::numeric_limits<float>::quiet_NaN()) == falseColour(1.0f));
        QVERIFY(falseColour(-1.0f) == falseColour(0.0f) && falseColour(9.0f) == falseColour(1.0f));
    }

    void differenceColourIsEvenAndLooksAlikeOnBothSides()
    {
        const auto lab = [](float t) { return labOf(glm::dvec3(differenceColour(t))); };
        double least = 1e9, most = 0;
        for (int i = 0; i < 32; ++i) {
            const float t = static_cast<float>(i) / 32.0f, next = static_cast<float>(i + 1) / 32.0f;
            for (const float side : {-1.0f, 1.0f}) {
                const double step = glm::length(lab(side * t) - lab(side * next));
                least = std::min(least, step);
                most = std::max(most, step);
            }
            QVERIFY2(std::abs(lab(t).x - lab(-t).x) <= 0.5, qPrintable(QString("lightness parts at %1").arg(t)));
        }
        QVERIFY2(most <= 1.05 * least, qPrintable(QString("steps from %1 to %2").arg(least).arg(most)));
        const glm::vec3 white = differenceColour(0.0f), blue = differenceColour(-1.0f), red = differenceColour(1.0f);
        QVERIFY(white.x > 0.85f && glm::length(white - glm::vec3(white.x)) <= 0.01f);
        QVERIFY(blue.z > 4.0f * blue.x && red.x > 4.0f * red.z);
        QVERIFY(differenceColour(7.0f) == red && differenceColour(-7.0f) == blue);
        QVERIFY(differenceColour(std::numeric_limits<float>::quiet_NaN()) == red);
    }

    void theColourBlindTellTheSidesApart()
    {
        // Machado, Oliveira, Fernandes 2009: full loss of one kind of cone, as a matrix on linear colour
        const std::vector<std::pair<const char*, glm::dmat3>> eyes{
            {"protanopia", glm::transpose(glm::dmat3(0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216,
                                                     -0.003882, -0.048116, 1.051998))},
            {"deuteranopia", glm::transpose(glm::dmat3(0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413,
                                                       -0.011820, 0.042940, 0.968881))},
            {"tritanopia", glm::transpose(glm::dmat3(1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602,
                                                     0.004733, 0.691367, 0.303900))}};
        for (const auto& [name, eye] : eyes) {
            const auto seen = [&](float t) { return labOf(eye * glm::dvec3(differenceColour(t))); };
            for (const float t : {0.25f, 0.5f, 1.0f}) {
                const double apart = glm::length(seen(t) - seen(-t)), fromWhite = glm::length(seen(t) - seen(0.0f));
                const bool clear = apart >= 40.0 * static_cast<double>(t) && fromWhite >= 40.0 * static_cast<double>(t);
                QVERIFY2(clear, qPrintable(QString("%1 at %2: %3 apart").arg(name).arg(t).arg(apart)));
            }
        }
    }

    void errorKindsByHand()
    {
        QCOMPARE(errorValue(ErrorKind::relative, 3.0f, 5.0f, 4.0f), 0.5f);
        QCOMPARE(errorValue(ErrorKind::absolute, 3.0f, 5.0f, 4.0f), 2.0f);
        QCOMPARE(errorValue(ErrorKind::difference, 3.0f, 5.0f, 4.0f), -0.5f);
        QCOMPARE(errorValue(ErrorKind::relative, 3.0f, 5.0f, 0.0f), 0.0f);
        QVERIFY(errorColour(ErrorKind::difference, -2.0f, 4.0f) == differenceColour(-0.5f));
        QVERIFY(errorColour(ErrorKind::absolute, 2.0f, 4.0f) == falseColour(0.5f));
        const ScalarImage map =
            errorMap(filled(2, 1, glm::vec3(1.5f)), filled(2, 1, glm::vec3(2.0f)), 2.0, ErrorKind::difference);
        QVERIFY(map.values.size() == 2 && isNear(static_cast<double>(map.values[0]), -0.25, 1e-6));
    }

    void legendNumbersCarryUnits()
    {
        QCOMPARE(legendText(0.125f, LegendUnit::percent), std::string("12.5%"));
        QCOMPARE(legendText(0.125f, LegendUnit::percent, true), std::string("+12.5%"));
        QCOMPARE(legendText(-0.05f, LegendUnit::percent, true), std::string("-5%"));
        QCOMPARE(legendText(0.0f, LegendUnit::percent, true), std::string("0%"));
        QCOMPARE(legendText(40.0f, LegendUnit::lux), std::string("40 lx"));
        QCOMPARE(legendText(0.5f, LegendUnit::candelaPerM2), std::string("0.5 cd/m2"));
        QCOMPARE(legendText(20.0f, LegendUnit::plain), std::string("20"));
    }

    void legendTopIsRound()
    {
        ScalarImage map{10, 10, std::vector<float>(100, 0.034f)};
        QCOMPARE(legendTop(map), 0.05f);
        map.values.assign(100, 0.0f);
        QCOMPARE(legendTop(map), 0.01f);
        map.values.assign(100, -0.034f);
        QCOMPARE(legendTop(map), 0.05f);
        map.values.assign(100, 700.0f);
        QCOMPARE(legendTop(map), 1000.0f);
    }

    void heatmapHoldsMapAndLegend()
    {
        ScalarImage map{300, 20, {}};
        for (int i = 0; i < 300 * 20; ++i) map.values.push_back(static_cast<float>(i % 300) / 299.0f);
        const ByteImage picture = heatmap(map, {ErrorKind::relative, 1.0f, LegendUnit::plain, "what it is"});
        QCOMPARE(picture.width, 300);
        QCOMPARE(picture.height, 20 + kLegendHeight);
        const auto colours = [&](int fromRow, int toRow) {
            std::set<std::uint32_t> seen;
            for (int i = fromRow * 300; i < toRow * 300; ++i) {
                const std::uint8_t* p = picture.rgb.data() + 3 * i;
                seen.insert(static_cast<std::uint32_t>(p[0] << 16 | p[1] << 8 | p[2]));
            }
            return seen.size();
        };
        QVERIFY2(colours(0, 20) > 150, "the map has few colours");
        QVERIFY2(colours(28, 40) > 150, "the bar has few colours");
        const auto ink = [&](std::size_t fromRow, std::size_t toRow) {
            int bright = 0;
            for (std::size_t i = fromRow * 300 * 3; i < toRow * 300 * 3; i += 3) bright += picture.rgb[i] > 200;
            return bright;
        };
        QVERIFY2(ink(48, 57) > 60, qPrintable(QString("%1 pixels of numbers").arg(ink(48, 57))));
        QVERIFY2(ink(60, 80) > 60, qPrintable(QString("%1 pixels of caption").arg(ink(60, 80))));
        const ScalarImage small{4, 4, std::vector<float>(16, 0.5f)};
        QCOMPARE(heatmap(small, {ErrorKind::relative, 1.0f, LegendUnit::percent, ""}).width, 240);
    }

    void signedHeatmapIsWhiteInTheMiddle()
    {
        ScalarImage map{240, 1, std::vector<float>(240, 0.0f)};
        map.values[0] = -0.2f;
        map.values[239] = 0.2f;
        const ByteImage picture = heatmap(map, {ErrorKind::difference, 0.2f, LegendUnit::percent, ""});
        const auto at = [&](int x, int y) {
            const std::uint8_t* p = picture.rgb.data() + 3 * (y * 240 + x);
            return glm::ivec3(p[0], p[1], p[2]);
        };
        QVERIFY(at(0, 0).z > at(0, 0).x + 100 && at(239, 0).x > at(239, 0).z + 100);
        QVERIFY(at(120, 0).x > 235 && at(120, 0).y > 235 && at(120, 0).z > 235);
        const int bar = 1 + 12; // inside the legend's bar, which runs from 12 to 227
        QVERIFY(at(13, bar).z > at(13, bar).x + 100 && at(226, bar).x > at(226, bar).z + 100);
        QVERIFY(at(119, bar).y > 230 && at(120, bar).y > 230);
    }
};

QTEST_APPLESS_MAIN(CompareTest)
#include "tst_compare.moc"
