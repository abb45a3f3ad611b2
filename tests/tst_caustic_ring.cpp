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
        BakeParams params; // the defaults: leaves of 19 mm and 300 photons, split where that blurs
        params.octreeFirstDepth = params.octreeDepth;
        const Baked baked = bakeOctree(lit.scene, params);
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        QVERIFY(baked.counters.causticPhotons > 10'000);
        std::size_t probe = 0;
        for (const Line& line : lines()) {
            std::vector<double> truth, found;
            for (int i = 0; i < Line::kPoints; ++i, ++probe) {
                truth.push_back(double(luminance(reference.probes[probe].indirect)));
                found.push_back(double(luminance(baked.field->irradiance(probes[probe].position, {0, 1, 0}))));
            }
            const Hump r = humpOf(truth, line.step()), o = humpOf(found, line.step());
            qInfo("%s: peak %.0f lx of %.0f, width %.1f mm of %.1f", qPrintable(line.name), o.peak, r.peak,
                  1000.0 * o.width, 1000.0 * r.width);
            QVERIFY2(std::abs(o.peak - r.peak) <= 0.2 * r.peak, qPrintable(line.name));
            QVERIFY2(std::abs(o.width - r.width) <= 0.2 * r.width, qPrintable(line.name));
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
