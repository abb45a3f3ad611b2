// SPDX-License-Identifier: Apache-2.0
// Claims: smoothing takes most of the noise out of even light and states what is left; light that grows in step stays,
// beside walls too; an edge that noise does not hide stays; a wall keeps light apart; twice the light is twice the
// result and threads change no bit; a bake has less noise with it, and is much less mottled.
#include "bake_helpers.h"
#include "core/base/sampling.h"
#include "core/base/statistics.h"
#include "core/base/units.h"
#include "core/ivg/grid_smooth.h"
#include "core/ivg/ivg_solver.h"
#include "core/scene/sample_scenes.h"
#include "grid_helpers.h"
#include "light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

GridGeometry emptyGrid(glm::ivec3 cells = {12, 12, 12})
{
    const GridLattice lattice{{0.0f, 0.0f, 0.0f}, glm::vec3(0.5f), cells};
    return {lattice, GridOpenness::everything(lattice)};
}

/// A wall across x, half a cell behind the vertices of `plane`.
void buildWall(GridGeometry& grid, int plane)
{
    for (std::size_t v = 0; v < grid.lattice.vertexCount(); ++v) {
        const int x = grid.lattice.vertex(v).x;
        if (x == plane) grid.openness.sight[v][1] = static_cast<std::uint8_t>(0.5f * GridOpenness::kSightUnits);
        if (x == plane + 1) grid.openness.sight[v][0] = static_cast<std::uint8_t>(0.5f * GridOpenness::kSightUnits);
    }
}

/// Even noise of the standard deviation `noise` on light(vertex), alike in all directions and channels.
template<class Light>
GridLayer noisyLayer(const GridGeometry& grid, float noise, const Light& light)
{
    const std::size_t count = grid.lattice.vertexCount();
    GridLayer layer;
    layer.vectors.resize(count);
    layer.variance.resize(count);
    Rng rng(5, hashName("noise"), 0);
    for (std::size_t v = 0; v < count; ++v) {
        for (std::size_t d = 0; d < 6; ++d) {
            const float off = std::sqrt(3.0f) * noise * (2.0f * rng.uniform() - 1.0f);
            const float value = light(grid.lattice.vertex(v)) + off;
            const float sign = d % 2 == 0 ? -1.0f : 1.0f;
            for (int channel = 0; channel < 3; ++channel)
                layer.vectors[v][d][channel][static_cast<int>(d / 2)] = sign * value;
            layer.variance[v][d] = noise * noise;
        }
    }
    return layer;
}

void smooth(const GridGeometry& grid, GridLayer& layer, int threads = 2)
{
    Workers workers(threads);
    smoothVectors(grid, GridEstimator::crossings, layer, workers);
}

double valueOf(const GridLayer& layer, std::size_t v, std::size_t d)
{
    return double(luminance(alongAxis(layer.vectors[v], d)));
}

} // namespace

class GridSmoothTest : public QObject {
    Q_OBJECT
private Q_SLOTS:

    void evenLightLosesItsNoise()
    {
        const GridGeometry grid = emptyGrid();
        const float noise = 0.1f;
        GridLayer layer = noisyLayer(grid, noise, [](glm::ivec3) { return 1.0f; });
        smooth(grid, layer);
        RunningMean value, stated;
        for (std::size_t v = 0; v < layer.vectors.size(); ++v) {
            const glm::ivec3 at = grid.lattice.vertex(v);
            if (glm::any(glm::lessThan(at, glm::ivec3(3))) || glm::any(glm::greaterThan(at, glm::ivec3(9)))) continue;
            for (std::size_t d = 0; d < 6; ++d) {
                value.add(valueOf(layer, v, d));
                stated.add(double(layer.variance[v][d]));
            }
        }
        const double left = std::sqrt(value.variance()) / double(noise);
        qInfo("%.3f of the noise left, stated %.3f, mean %.4f", left, std::sqrt(stated.mean()) / double(noise),
              value.mean());
        QVERIFY(left <= 0.35); // 25 values: .2 if it was known that light is even
        QVERIFY(std::abs(value.mean() - 1.0) <= 0.01);
        // it is meant for lookups between vertices, which err together: more than a vertex has, less than before
        QVERIFY(std::sqrt(stated.mean()) >= 0.9 * left * double(noise) &&
                stated.mean() <= 0.25 * double(noise * noise));
    }

    void lightThatGrowsInStepStays() // whatever its noise is said to be
    {
        GridGeometry grid = emptyGrid();
        buildWall(grid, 4);
        const auto ramp = [](glm::ivec3 at) { return 1.0f + 0.1f * float(at.x) + 0.03f * float(at.y - 2 * at.z); };
        GridLayer layer = noisyLayer(grid, 0.0f, ramp);
        for (auto& variance : layer.variance) variance.fill(0.04f);
        smooth(grid, layer);
        for (std::size_t v = 0; v < layer.vectors.size(); ++v) {
            for (std::size_t d = 0; d < 6; ++d) {
                const double off = valueOf(layer, v, d) - double(ramp(grid.lattice.vertex(v)));
                QVERIFY2(std::abs(off) <= 1e-5, qPrintable(QString("vertex %1 is off by %2").arg(v).arg(off)));
            }
        }
    }

    void edgesStay_data()
    {
        QTest::addColumn<bool>("isWall");
        QTest::newRow("in the open, 20 times the noise") << false;
        QTest::newRow("a wall, no more than the noise") << true;
    }
    void edgesStay()
    {
        QFETCH(bool, isWall);
        GridGeometry grid = emptyGrid();
        if (isWall) buildWall(grid, 5);
        const float noise = isWall ? 1.0f : 0.05f; // stated: the values have none, so that all that changes is seen
        GridLayer layer = noisyLayer(grid, 0.0f, [](glm::ivec3 at) { return at.x <= 5 ? 1.0f : 2.0f; });
        for (auto& variance : layer.variance) variance.fill(noise * noise);
        smooth(grid, layer);
        double most = 0.0;
        for (std::size_t v = 0; v < layer.vectors.size(); ++v) {
            const double is = grid.lattice.vertex(v).x <= 5 ? 1.0 : 2.0;
            for (std::size_t d = 0; d < 6; ++d) most = std::max(most, std::abs(valueOf(layer, v, d) - is));
        }
        QVERIFY2(most <= (isWall ? 1e-5 : 0.025), qPrintable(QString("changed by %1").arg(most)));
    }

    void twiceTheLightAndAnyThreads()
    {
        const GridGeometry grid = emptyGrid({5, 7, 4});
        const auto light = [](glm::ivec3 at) { return 1.0f + float(at.x * at.y % 3); };
        GridLayer one = noisyLayer(grid, 0.3f, light), two = one;
        for (std::size_t v = 0; v < two.vectors.size(); ++v) {
            for (std::size_t d = 0; d < 6; ++d) two.vectors[v][d] *= 2.0f, two.variance[v][d] *= 4.0f;
        }
        smooth(grid, one, 1);
        smooth(grid, two, 5);
        for (std::size_t v = 0; v < one.vectors.size(); ++v) {
            for (std::size_t d = 0; d < 6; ++d) {
                QVERIFY(2.0f * one.vectors[v][d] == two.vectors[v][d]);
                QVERIFY(4.0f * one.variance[v][d] == two.variance[v][d]);
            }
        }
    }

    void bakesAreCalmer() // cornell at 16^3 with 100,000 photons
    {
        const auto scene = share(*sampleScene("cornell"));
        BakeParams with = gridParams(16, 100'000), without = with;
        without.gridSmooth = Switch::off;
        const auto points = facePoints(*scene, 400, 3);
        const Kind calm = kindOf(scene, with, points), raw = kindOf(scene, without, points);
        qInfo("noise %.3f and %.3f, mottled by %.3f and %.3f", calm.noise, raw.noise, calm.mottling, raw.mottling);
        QVERIFY(calm.mottling <= 0.6 * raw.mottling);
        QVERIFY(calm.noise <= 0.8 * raw.noise);
    }

private:
    struct Kind {
        double noise;    ///< at a place, by two seeds; shares of the mean light
        double mottling; ///< noise of the difference between places three fifths of a cell apart
    };
    template<class Points>
    static Kind kindOf(const std::shared_ptr<const Scene>& scene, BakeParams p, const Points& points)
    {
        std::vector<Baked> runs;
        for (std::uint64_t seed : {1, 2}) {
            p.seed = seed;
            IvgSolver solver;
            BakeProducts products;
            runs.push_back(runSolver(solver, {scene, p, {}}, products, 2));
        }
        const float cell = dynamic_cast<const IrradianceGrid&>(*runs[0].field).geometry().lattice.cellSize.x;
        double mean = 0.0, noise = 0.0, mottled = 0.0;
        for (const auto& point : points) {
            const glm::vec3 aside = point.position + 0.6f * cell * Frame(point.normal).tangent;
            const auto at = [&](std::size_t run, glm::vec3 place) {
                return double(luminance(runs[run].field->irradiance(place, point.normal)));
            };
            const double a = at(0, point.position), b = at(1, point.position);
            mean += 0.5 * (a + b), noise += 0.5 * (a - b) * (a - b);
            const double step = at(0, aside) - a - (at(1, aside) - b);
            mottled += 0.5 * step * step;
        }
        const auto n = double(points.size());
        return {std::sqrt(noise / n) / (mean / n), std::sqrt(mottled / n) / (mean / n)};
    }
};

QTEST_APPLESS_MAIN(GridSmoothTest)
#include "tst_grid_smooth.moc"
