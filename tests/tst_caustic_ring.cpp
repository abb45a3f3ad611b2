// SPDX-License-Identifier: Apache-2.0
// Claim: caustics of metal and of glass land in the octree: on caustic_ring, along the axis of the ring's caustic and
// across it, and across the glass ball's focus, peak and width are within 20 % of the reference. Where nothing mirrors
// and nothing is clear, not one photon counts as caustic.
#include "core/base/units.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "tests/bake_helpers.h"
#include "tests/glass_scene.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// A line of points on the table, `length` from `first` on.
struct Line {
    QString name;
    glm::dvec2 first, towards; ///< x and z, metres
    double length;
    static constexpr int kPoints = 61;
    [[nodiscard]] double step() const { return length / (kPoints - 1); }
    [[nodiscard]] glm::dvec3 at(int i) const
    {
        const glm::dvec2 p = first + towards * (step() * i);
        return {p.x, 0.0, p.y};
    }
};

/// The lamp stands over (-.58, -.28), the ring's middle is (.12, .06), the ball lies at (-.34, .27).
std::vector<Line> lines()
{
    const glm::dvec2 lamp(-0.58, -0.28), ring(0.12, 0.06), ball(-0.34, 0.27);
    const glm::dvec2 a = glm::normalize(ring - lamp), b = glm::normalize(ball - lamp);
    const glm::dvec2 acrossA(-a.y, a.x), acrossB(-b.y, b.x);
    return {{"ring, along its axis", ring, a, 0.235},
            {"ring, across", ring + 0.10 * a - 0.15 * acrossA, acrossA, 0.30},
            {"ball, across", ball + 0.155 * b - 0.10 * acrossB, acrossB, 0.20}};
}

struct Hump {
    double peak = 0.0, width = 0.0; ///< lux; metres at half height over the line's lowest value
};
Hump humpOf(const std::vector<double>& lux, double step)
{
    const auto top = std::max_element(lux.begin(), lux.end());
    const double half = 0.5 * (*top + *std::min_element(lux.begin(), lux.end()));
    const auto crossing = [&](int by) { // where it falls below half, from the top on
        auto i = top - lux.begin();
        const auto n = static_cast<std::ptrdiff_t>(lux.size());
        while (i + by >= 0 && i + by < n && lux[std::size_t(i + by)] > half) i += by;
        if (i + by < 0 || i + by >= n) return double(i);
        const double here = lux[std::size_t(i)], next = lux[std::size_t(i + by)];
        return double(i) + by * (here - half) / (here - next);
    };
    return {*top, (crossing(1) - crossing(-1)) * step};
}

} // namespace

class CausticRingTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void octreeAgainstReference()
    {
        const LitScene lit(causticRing());
        std::vector<ProbePoint> probes;
        for (const Line& line : lines()) {
            for (int i = 0; i < Line::kPoints; ++i)
                probes.push_back({lit.scene->toScene(line.at(i)), {0, 1, 0}, probes.size()});
        }
        const ReferenceResult reference = traceProbes(lit, probes, 32'768);
        QCOMPARE(reference.causticPhotons, std::uint64_t(0)); // a panel that paths find by themselves
        // the defaults: leaves of 19 mm and 300 photons, split where that blurs. One bake's width is uncertain by a
        // sixth, so that any one may miss by chance: the middle one of five tells whether the method is right
        constexpr int kBakes = 5;
        std::array<std::array<double, kBakes>, 3> peaks{}, widths{};
        for (int b = 0; b < kBakes; ++b) {
            BakeParams params;
            params.octreeFirstDepth = params.octreeDepth;
            params.seed = std::uint64_t(b + 1);
            const Baked baked = bakeOctree(lit.scene, params);
            QVERIFY2(baked.error.empty(), baked.error.c_str());
            QVERIFY(baked.counters.causticPhotons > 10'000);
            for (std::size_t line = 0; line < 3; ++line) {
                std::vector<double> found;
                for (std::size_t i = 0; i < Line::kPoints; ++i)
                    found.push_back(double(
                        luminance(baked.field->irradiance(probes[line * Line::kPoints + i].position, {0, 1, 0}))));
                const Hump hump = humpOf(found, lines()[line].step());
                peaks[line][std::size_t(b)] = hump.peak, widths[line][std::size_t(b)] = hump.width;
            }
        }
        for (std::size_t line = 0; line < 3; ++line) {
            std::vector<double> truth;
            for (std::size_t i = 0; i < Line::kPoints; ++i)
                truth.push_back(double(luminance(reference.probes[line * Line::kPoints + i].indirect)));
            const Hump r = humpOf(truth, lines()[line].step());
            std::ranges::sort(peaks[line]);
            std::ranges::sort(widths[line]);
            const std::string name = lines()[line].name.toStdString();
            const double peak = peaks[line][kBakes / 2], width = widths[line][kBakes / 2];
            qInfo("%s: peak %.0f (%.0f to %.0f) lx of %.0f, width %.1f (%.1f to %.1f) mm of %.1f", name.c_str(), peak,
                  peaks[line].front(), peaks[line].back(), r.peak, 1000.0 * width, 1000.0 * widths[line].front(),
                  1000.0 * widths[line].back(), 1000.0 * r.width);
            QVERIFY2(std::abs(peak - r.peak) <= 0.2 * r.peak, name.c_str());
            QVERIFY2(std::abs(width - r.width) <= 0.2 * r.width, name.c_str());
        }
    }

    void nothingIsShotForCausticsWithoutNeed()
    {
        BakeParams params;
        params.photonCount = 20'000;
        QCOMPARE(bakeOctree(share(cornellBox()), params).counters.causticPhotons, std::uint64_t(0));
        QCOMPARE(bakeOctree(share(cavityCube(0.5f)), params).counters.causticPhotons, std::uint64_t(0));
    }
};

QTEST_APPLESS_MAIN(CausticRingTest)
#include "tst_caustic_ring.moc"
