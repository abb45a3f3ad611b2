// SPDX-License-Identifier: Apache-2.0
// Claims: in light that is the same from everywhere, each combination of estimator and remap equals its own closed
// form: the printed estimator 2/3, the printed remap sum |n|^3, both .385 on the diagonal, all others 1, at vertices
// inside, on faces, edges and corners of the grid alike. A distant lamp, one segment, no segment and any number of
// threads.
#include "core/base/sampling.h"
#include "core/base/statistics.h"
#include "core/ivg/grid_deposit.h"
#include "light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

std::shared_ptr<const GridGeometry> emptyGrid(glm::ivec3 cells = {3, 4, 2}, glm::vec3 cellSize = {0.5f, 0.4f, 0.8f})
{
    const GridLattice lattice{{-0.7f, 0.3f, 1.0f}, cellSize, cells};
    return std::make_shared<const GridGeometry>(GridGeometry{lattice, GridOpenness::everything(lattice)});
}

/// Photons that make a radiance of 1 / pi from everywhere in a sphere around the grid: its inside emits 1 lm/m2.
std::vector<SegmentBlock> evenLight(const GridLattice& lattice, std::uint64_t photons, std::uint64_t seed)
{
    const glm::vec3 half = 0.5f * glm::vec3(lattice.cells) * lattice.cellSize, centre = lattice.lowest + half;
    const float radius = 1.1f * glm::length(half);
    const float flux = 4.0f * kPi * radius * radius / static_cast<float>(photons);
    std::vector<SegmentBlock> blocks(16);
    Rng rng(seed, hashName("even light"), 0);
    for (std::uint64_t i = 0; i < photons; ++i) {
        const auto [u1, u2] = rng.uniformPair();
        const auto [u3, u4] = rng.uniformPair();
        const glm::vec3 out = sampleSphere(u1, u2), way = Frame(-out).toWorld(sampleCosineHemisphere(u3, u4));
        const glm::vec3 from = centre + radius * out;
        const float length = -2.0f * radius * glm::dot(out, way);
        blocks[i % blocks.size()].segments.push_back({from, way, glm::vec3(flux, 2.0f * flux, 0.0f), length});
    }
    return blocks;
}

GridLayer deposited(const std::shared_ptr<const GridGeometry>& grid, const std::vector<SegmentBlock>& blocks,
                    GridEstimator estimator, int threads = 2)
{
    Workers workers(threads);
    GridDeposit deposit(grid, estimator);
    std::vector<const SegmentBlock*> all;
    for (const SegmentBlock& block : blocks) all.push_back(&block);
    if (!deposit.add(all, workers, {})) qFatal("stopped");
    return deposit.layer(0);
}

glm::vec3 irradianceAt(const GridLayer& layer, std::size_t vertex, GridRemap remap, glm::vec3 n)
{
    std::vector<glm::vec3> kept(remapSize(remap));
    keepForRemap(remap, layer.vectors[vertex], kept);
    return remapIrradiance(remap, kept, n);
}

const std::vector<glm::vec3>& normals()
{
    static const std::vector<glm::vec3> all{{1, 0, 0},
                                            {0, -1, 0},
                                            {0, 0, 1},
                                            glm::normalize(glm::vec3(1, 1, 0)),
                                            glm::normalize(glm::vec3(1, -1, 1)),
                                            glm::normalize(glm::vec3(-2, 1, 0.5f))};
    return all;
}

} // namespace

Q_DECLARE_METATYPE(lightloom::GridEstimator)
Q_DECLARE_METATYPE(lightloom::GridRemap)

class GridDepositTest : public QObject {
    Q_OBJECT

    static double closedForm(GridEstimator estimator, GridRemap remap, glm::vec3 n)
    {
        const glm::dvec3 a = glm::abs(glm::dvec3(n));
        const double printed = a.x * a.x * a.x + a.y * a.y * a.y + a.z * a.z * a.z;
        return (estimator == GridEstimator::paper ? 2.0 / 3.0 : 1.0) * (remap == GridRemap::paper ? printed : 1.0);
    }

private Q_SLOTS:
    void evenLightHasItsClosedForm_data()
    {
        QTest::addColumn<GridEstimator>("estimator");
        QTest::addColumn<GridRemap>("remap");
        for (const GridEstimator e : {GridEstimator::crossings, GridEstimator::tracks, GridEstimator::paper}) {
            for (const GridRemap r : {GridRemap::joined, GridRemap::harmonic, GridRemap::flux, GridRemap::paper}) {
                QTest::addRow("%s %s", kGridEstimatorNames[std::size_t(e)].data(),
                              kGridRemapNames[std::size_t(r)].data())
                    << e << r;
            }
        }
    }
    void evenLightHasItsClosedForm()
    {
        QFETCH(GridEstimator, estimator);
        QFETCH(GridRemap, remap);
        const auto grid = emptyGrid();
        static std::map<GridEstimator, std::vector<GridLayer>> made;
        if (!made.contains(estimator)) {
            for (std::uint64_t seed = 1; seed <= 8; ++seed)
                made[estimator].push_back(deposited(grid, evenLight(grid->lattice, 500'000, seed), estimator));
        }
        // vertices by the number of the grid's borders they lie on: faces and cells there are cut to parts
        for (int borders = 0; borders <= 3; ++borders) {
            for (const glm::vec3 n : normals()) {
                RunningMean mean;
                for (const GridLayer& layer : made[estimator]) {
                    RunningMean over;
                    for (std::size_t i = 0; i < grid->lattice.vertexCount(); ++i) {
                        const glm::ivec3 v = grid->lattice.vertex(i);
                        int on = 0;
                        for (int axis = 0; axis < 3; ++axis) on += v[axis] == 0 || v[axis] == grid->lattice.cells[axis];
                        if (on == borders) over.add(double(irradianceAt(layer, i, remap, n).x));
                    }
                    mean.add(over.mean());
                }
                const double expected = closedForm(estimator, remap, n);
                // eight independent runs tell their own spread; cutting small cosines off takes eps^2 / 3
                const double allowed = 6.0 * mean.standardError() + 1e-3;
                QVERIFY2(std::abs(mean.mean() - expected) <= allowed && allowed <= 0.04,
                         qPrintable(QString("%1 borders, normal %2 %3 %4: %5 +- %6 instead of %7")
                                        .arg(borders)
                                        .arg(double(n.x))
                                        .arg(double(n.y))
                                        .arg(double(n.z))
                                        .arg(mean.mean())
                                        .arg(mean.standardError())
                                        .arg(expected)));
            }
        }
    }

    void printedFormsTogetherOnTheDiagonal() // what RR-6983 gives as it stands
    {
        const glm::vec3 diagonal = glm::normalize(glm::vec3(1.0f));
        QVERIFY(std::abs(closedForm(GridEstimator::paper, GridRemap::paper, diagonal) - 0.3849) <= 1e-4);
    }

    void smoothLightIsExact() // exact vectors in, so that only the fit is asked
    {
        // radiance 1 + d . w: I_delta = pi delta (of the 1) + 2 pi / 3 d (half of the sphere's 4 pi / 3)
        const glm::dvec3 d(0.3, -0.2, 0.4);
        IrradianceVectors vectors;
        for (std::size_t side = 0; side < 6; ++side) {
            glm::dvec3 i = 2.0 * kPiD / 3.0 * d;
            i[int(side / 2)] += side % 2 == 0 ? -kPiD : kPiD;
            vectors[side] = glm::mat3(glm::vec3(i), 2.0f * glm::vec3(i), glm::vec3(0.0f));
        }
        for (const GridRemap remap : {GridRemap::harmonic, GridRemap::joined}) {
            std::array<glm::vec3, 12> kept;
            keepForRemap(remap, vectors, kept);
            for (const glm::vec3 n : normals()) {
                const double expected = kPiD + 2.0 * kPiD / 3.0 * glm::dot(d, glm::dvec3(n));
                const glm::vec3 e = remapIrradiance(remap, kept, n);
                QVERIFY2(std::abs(double(e.x) / expected - 1.0) <= 2e-6,
                         qPrintable(QString("%1, %2").arg(double(e.x)).arg(expected)));
                QVERIFY(std::abs(double(e.y) / expected - 2.0) <= 4e-6 && e.z == 0.0f);
            }
        }
    }

    void lightFromBehindDoesNotCountOnAxes() // where a bright wall lies behind its own points
    {
        IrradianceVectors vectors{};
        for (std::size_t side = 0; side < 6; ++side) { // radiance 1 from below, nothing from above
            const int axis = int(side / 2);
            glm::vec3 i(0.0f);
            i.y = side == 3 ? 0.0f : side == 2 ? -kPi : -0.5f * kPi;
            if (axis != 1) i[axis] = side % 2 == 0 ? -0.5f * kPi : 0.5f * kPi;
            vectors[side] = glm::mat3(i, i, i);
        }
        std::array<glm::vec3, 12> kept;
        keepForRemap(GridRemap::joined, vectors, kept);
        QCOMPARE(remapIrradiance(GridRemap::joined, kept, {0, 1, 0}).x, 0.0f);
        QVERIFY(std::abs(remapIrradiance(GridRemap::joined, kept, {0, -1, 0}).x - kPi) <= 1e-5f);
        const glm::vec3 tilted = glm::normalize(glm::vec3(0.3f, -1.0f, 0.5f)); // sees (1 + cos) / 2 of it
        const double seen = 0.5 * kPiD * (1.0 - double(tilted.y));
        QVERIFY(std::abs(double(remapIrradiance(GridRemap::joined, kept, tilted).x) / seen - 1.0) <= 0.05);
    }

    void distantLampIsExactInThePrintedRemap()
    {
        const glm::vec3 toLight = glm::normalize(glm::vec3(0.5f, 0.7f, -0.3f));
        IrradianceVectors vectors{};
        for (std::size_t side = 0; side < 6; ++side) {
            const float along = toLight[int(side / 2)] * (side % 2 == 0 ? -1.0f : 1.0f);
            if (along > 0.0f) vectors[side] = glm::mat3(toLight, toLight, toLight);
        }
        std::array<glm::vec3, 18> kept;
        keepForRemap(GridRemap::paper, vectors, kept);
        for (const glm::vec3 n : {glm::normalize(glm::vec3(1, 2, -1)), glm::normalize(glm::vec3(3, 1, -0.1f))})
            QVERIFY(std::abs(remapIrradiance(GridRemap::paper, kept, n).y - glm::dot(n, toLight)) <= 1e-6f);
    }

    void oneSegmentCountsOnce()
    {
        const auto grid = emptyGrid({2, 2, 2}, glm::vec3(1.0f));
        const glm::vec3 low = grid->lattice.lowest;
        std::vector<SegmentBlock> blocks(1);
        // along x through the middle vertices' faces and to the border, which it ends on: planes 1 and 2, not 0
        blocks[0].segments.push_back({low + glm::vec3(0.0f, 1.0f, 1.0f), {1, 0, 0}, glm::vec3(6.0f), 2.0f});
        for (const GridEstimator e : {GridEstimator::crossings, GridEstimator::paper}) {
            const GridLayer layer = deposited(grid, blocks, e);
            for (int x = 0; x <= 2; ++x) {
                const glm::mat3& lit = layer.vectors[grid->lattice.index({x, 1, 1})][0];
                QCOMPARE(lit[0], glm::vec3(x == 0 ? 0.0f : -6.0f, 0.0f, 0.0f));
            }
        }
        const GridLayer tracks = deposited(grid, blocks, GridEstimator::tracks);
        // a way of 1 through the middle cell of 1 m3; of 1/2 through border cells of 1/2 m3
        for (int x = 0; x <= 2; ++x)
            QVERIFY(std::abs(tracks.vectors[grid->lattice.index({x, 1, 1})][0][0].x + 6.0f) <= 1e-4f);
    }

    void noLightIsDarkAndFinite()
    {
        const auto grid = emptyGrid();
        for (const GridEstimator e : {GridEstimator::crossings, GridEstimator::tracks, GridEstimator::paper}) {
            const GridLayer layer = deposited(grid, std::vector<SegmentBlock>(3), e);
            for (const IrradianceVectors& v : layer.vectors) QVERIFY(v == IrradianceVectors{});
        }
    }

    void endlessWaysLeaveTheGrid()
    {
        const auto grid = emptyGrid({4, 4, 4}, glm::vec3(1.0f));
        const glm::vec3 from = grid->lattice.lowest + glm::vec3(0.5f, 2.1f, 1.9f);
        std::vector<SegmentBlock> blocks(1);
        blocks[0].segments.push_back({from, {1, 0, 0}, glm::vec3(1.0f), PhotonSegment::kEndless});
        const GridLayer layer = deposited(grid, blocks, GridEstimator::crossings);
        for (int x = 1; x <= 4; ++x) QCOMPARE(layer.vectors[grid->lattice.index({x, 2, 2})][0][0].x, -1.0f);
    }

    void threadsChangeNoBit()
    {
        const auto grid = emptyGrid({9, 8, 7}, glm::vec3(0.3f));
        const auto blocks = evenLight(grid->lattice, 30'000, 5);
        for (const GridEstimator e : {GridEstimator::crossings, GridEstimator::tracks, GridEstimator::paper}) {
            const GridLayer one = deposited(grid, blocks, e, 1), five = deposited(grid, blocks, e, 5);
            QVERIFY(one.vectors == five.vectors && one.variance == five.variance);
        }
    }

    void varianceIsThatOfRuns()
    {
        const auto grid = emptyGrid();
        const std::size_t middle = grid->lattice.index({1, 2, 1});
        for (const GridEstimator e : {GridEstimator::crossings, GridEstimator::tracks, GridEstimator::paper}) {
            RunningMean value, stated;
            for (std::uint64_t seed = 1; seed <= 200; ++seed) {
                const GridLayer layer = deposited(grid, evenLight(grid->lattice, 2000, seed), e);
                const glm::mat3& up = layer.vectors[middle][3];
                value.add(double(kLumaR * up[0].y + kLumaG * up[1].y));
                stated.add(double(layer.variance[middle][3]));
            }
            const double ratio = stated.mean() / value.variance(); // a variance of 200 numbers is good to 10 %
            QVERIFY2(std::abs(ratio - 1.0) <= 0.5, qPrintable(QString("stated %1 of the true variance").arg(ratio)));
        }
    }
};

QTEST_APPLESS_MAIN(GridDepositTest)
#include "tst_grid_deposit.moc"
