// SPDX-License-Identifier: Apache-2.0
// Claims: the arrays that textures are made from hold what the grid holds, within a half float, for every form and
// however bright the light; the compressed form keeps lengths and the sum's direction; slabs fit the smallest textures
// that OpenGL 3.3 promises for every grid of usual size.
#include "bake_helpers.h"
#include "core/ivg/grid_gpu.h"
#include "core/ivg/ivg_solver.h"
#include "core/scene/sample_scenes.h"
#include "shaders/common.h"
#include <QtTest>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr float kHalfStep = 1.0f / 2048.0f; ///< largest relative error of rounding to a half

struct Texels {
    const GpuGrid& gpu;
    [[nodiscard]] glm::vec4 at(int slab, std::size_t vertex) const
    {
        const glm::ivec3 size = gpu.size(),
                         at = gpu.lattice.vertex(vertex) +
                              gpu.lattice.vertices() * glm::ivec3(slab % gpu.slabs.x, slab / gpu.slabs.x % gpu.slabs.y,
                                                                  slab / (gpu.slabs.x * gpu.slabs.y));
        const std::uint16_t* half = gpu.light.data() + 4 * std::size_t((at.z * size.y + at.y) * size.x + at.x);
        return {shader::halfValue(half[0]), shader::halfValue(half[1]), shader::halfValue(half[2]),
                shader::halfValue(half[3])};
    }
    /// Number `index` of those that stand one after the other from `slab` on.
    [[nodiscard]] float number(int slab, int index, std::size_t vertex) const
    {
        return at(slab + index / 4, vertex)[index % 4];
    }
};

/// |is - wanted| within two roundings, or what a half cannot tell from nothing.
bool isNear(float is, float wanted) { return std::abs(is - wanted) <= 2.1f * kHalfStep * std::abs(wanted) + 1e-7f; }

} // namespace

class GridGpuTest : public QObject {
    Q_OBJECT
    std::shared_ptr<const IrradianceGrid> grid_;

private Q_SLOTS:
    void initTestCase()
    {
        BakeParams params;
        params.gridSize = 10;
        params.photonCount = 20'000;
        IvgSolver solver;
        BakeProducts products;
        const Baked baked = runSolver(solver, {share(cornellBox()), params, {}}, products, 2);
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        grid_ = std::dynamic_pointer_cast<const IrradianceGrid>(baked.field);
        QVERIFY(grid_);
    }

    void arraysHoldTheGrid_data()
    {
        QTest::addColumn<int>("remap");
        QTest::addColumn<int>("filter");
        QTest::addColumn<float>("gain");
        for (int remap = 0; remap < 4; ++remap) {
            for (int filter = 0; filter < 3; ++filter)
                QTest::addRow("remap %d, filter %d", remap, filter) << remap << filter << 1.0f;
        }
        QTest::newRow("1e7 times as bright") << 0 << 0 << 1e7f;
        QTest::newRow("1e-9 times as bright") << 0 << 1 << 1e-9f;
    }
    void arraysHoldTheGrid()
    {
        QFETCH(int, remap);
        QFETCH(int, filter);
        QFETCH(float, gain);
        const auto mixed = std::dynamic_pointer_cast<const IrradianceGrid>(
            grid_->withMix(Mix(grid_->layers().size(), glm::vec3(gain))));
        const auto grid = mixed->withShow({GridRemap(remap), GridFilter(filter), 0.5f});
        const Result<GpuGrid> made = makeGpuGrid(*grid);
        QVERIFY(made);
        const Texels texels{*made};
        const float scale = made->scale;
        QCOMPARE(std::exp2(std::round(std::log2(scale))), scale); // a power of two: it costs no bits
        const std::size_t size = remapSize(grid->show().remap);
        const bool hasSides = made->sideTexels > 0;
        std::size_t wrong = 0, known = 0;
        for (std::size_t v = 0; v < made->lattice.vertexCount(); ++v) {
            const auto kept = grid->keptAt(v);
            const auto check = [&](float is, float value, float trust) {
                // below the halves' normal range only absolute steps are kept
                wrong += isNear(is, value * trust / scale) || std::abs(value * trust / scale) < 6.2e-5f ? 0 : 1;
            };
            for (int d = 0; d < 6 && hasSides; ++d) {
                const float trust = grid->trust(v, std::size_t(d / 2));
                for (int j = 0; j < made->sideTexels; ++j) {
                    const glm::vec4 texel = texels.at(d * made->sideTexels + j, v);
                    for (int c = 0; c < 3; ++c) check(texel[c], kept[std::size_t(d * made->sideTexels + j)][c], trust);
                    wrong += isNear(texel.w, trust) ? 0 : 1;
                }
                if (!made->hasSlopes) continue;
                const glm::vec4 slope = texels.at(6 * made->sideTexels + made->sharedTexels + d, v);
                for (int c = 0; c < 3; ++c) check(slope[c], grid->slopes(v)[std::size_t(d)][c], trust);
            }
            if (made->sharedTexels > 0) {
                const std::size_t first = hasSides ? 6 : 0;
                const float trust = grid->trust(v, hasSides ? 3 : 0);
                for (std::size_t k = first; k < size; ++k) {
                    for (int c = 0; c < 3; ++c)
                        check(texels.number(6 * made->sideTexels, 3 * int(k - first) + c, v), kept[k][c], trust);
                }
                const float is = texels.number(6 * made->sideTexels, 3 * int(size - first), v);
                wrong += isNear(is, trust) ? 0 : 1;
            }
            float most = 0.0f;
            for (std::size_t part = 0; part < remapParts(grid->show().remap).size(); ++part)
                most = std::max(most, grid->trust(v, part));
            QCOMPARE(made->sight[4 * v + 3] != 0, most > 0.0f);
            known += most > 0.0f ? 1 : 0;
        }
        QCOMPARE(wrong, std::size_t(0));
        QCOMPARE(known, made->openVertices);
        QVERIFY(known > 500);
        const bool isBright = std::ranges::any_of(made->light, [](std::uint16_t h) {
            return std::abs(shader::halfValue(h)) > 16384.0f; // and none is infinite: those would be wrong above
        });
        QVERIFY(isBright);
        QCOMPARE(made->places.empty(), !(made->hasSlopes && filter == 1));
    }

    void compressedKeepsLengthsAndTheSumsDirection()
    {
        const auto grid = grid_->withShow({GridRemap::paper, GridFilter::trilinear, 0.5f});
        const Result<GpuGrid> made = makeGpuGrid(*grid, GridPacking::compressed);
        QVERIFY(made);
        QCOMPARE(made->slabCount(), 12); // the paper's 12 textures
        const Texels texels{*made};
        for (std::size_t v = 0; v < made->lattice.vertexCount(); ++v) {
            const auto kept = grid->keptAt(v);
            for (std::size_t d = 0; d < 6; ++d) {
                const float trust = grid->trust(v, d / 2);
                glm::vec3 sum(0.0f);
                const glm::vec4 lengths = texels.at(int(2 * d), v), direction = texels.at(int(2 * d + 1), v);
                for (int c = 0; c < 3; ++c) {
                    const glm::vec3 one(kept[3 * d][c], kept[3 * d + 1][c], kept[3 * d + 2][c]);
                    sum += one;
                    QVERIFY(isNear(lengths[c] * made->scale, glm::length(one) * trust) || glm::length(one) < 1e-2f);
                }
                if (glm::length(sum) * trust <= 0.0f) continue;
                const glm::vec3 is(direction.x, direction.y, direction.z);
                QVERIFY(glm::length(is / trust - sum / glm::length(sum)) <= 3.0f * kHalfStep);
            }
        }
        QVERIFY(!makeGpuGrid(*grid_, GridPacking::compressed)); // of joined
    }

    void slabsFit()
    {
        for (const glm::ivec3 n :
             {glm::ivec3(33), glm::ivec3(49, 20, 49), glm::ivec3(65, 30, 65), glm::ivec3(3, 90, 3)}) {
            for (const int count : {7, 12, 17, 18}) {
                const glm::ivec3 box = slabBox(n, count), size = box * n;
                QVERIFY(box.x * box.y * box.z >= count);
                QVERIFY2(std::max({size.x, size.y, size.z}) <= 256, qPrintable(QString("%1 %2").arg(n.x).arg(count)));
            }
        }
        QCOMPARE(slabBox(glm::ivec3(10), 1), glm::ivec3(1));
    }
};

QTEST_APPLESS_MAIN(GridGpuTest)
#include "tst_grid_gpu.moc"
