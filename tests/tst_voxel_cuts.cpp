// SPDX-License-Identifier: Apache-2.0
// Claims: a bake of voxels looked up by lightcuts gives what a gather through the scene finds, on surfaces and in
// mid-air; samples are right in the mean; a picture asks once for all that a pixel shows of a surface, and is the same
// to the bit however it is sliced, and tells the size of each cut; parameters choose the lookup, and ends of gathers
// never pay for it.
#include "bake_helpers.h"
#include "core/bake/packed_octree.h"
#include "core/bake/progressive_view.h"
#include "core/bake/view_eye.h"
#include "core/base/units.h"
#include "core/compare/cut_map.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/scene/shapes.h"
#include "core/trace/direct_light.h"
#include "core/trace/final_gather.h"
#include "core/voxel/voxel_cuts.h"
#include "core/voxel/voxel_solver.h"
#include "light_helpers.h"
#include "view_helpers.h"
#include <algorithm>
#include <atomic>
#include <numeric>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// Counts how often it is asked.
class Counted final : public IndirectField {
public:
    explicit Counted(std::shared_ptr<const IndirectField> field) : field_(std::move(field)) {}
    [[nodiscard]] bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override
    {
        ++asked;
        return field_->lookup(p, n, lux);
    }
    [[nodiscard]] bool isCostly() const override { return true; }
    [[nodiscard]] std::shared_ptr<const IndirectField> withMix(Mix mix) const override
    {
        return std::make_shared<Counted>(field_->withMix(std::move(mix)));
    }
    [[nodiscard]] std::string_view method() const override { return field_->method(); }
    [[nodiscard]] std::size_t memoryBytes() const override { return field_->memoryBytes(); }
    mutable std::atomic<std::uint64_t> asked = 0;

private:
    std::shared_ptr<const IndirectField> field_;
};

ViewJob pictureOf(const Scene& scene)
{
    ViewJob job;
    job.camera = scene.cameras.front();
    job.width = 64, job.height = 48, job.samples = 8, job.directSamples = 8;
    job.indirect = ViewJob::Indirect::field;
    return job;
}

} // namespace

class VoxelCutsTest : public QObject {
    Q_OBJECT

    std::shared_ptr<const Scene> scene_ = share(*sampleScene("cornell"));
    BakeParams params_, asked_; ///< as they are for now; as the bake's
    SceneProducts at_;
    std::shared_ptr<const IndirectField> field_; ///< plain
    Workers workers_{2};

    [[nodiscard]] std::shared_ptr<const IndirectField> shown(VoxelLookup lookup)
    {
        params_.voxelLookup = lookup;
        return *shownField(field_, params_, at_.lights);
    }
    [[nodiscard]] glm::vec3 gathered(glm::vec3 p, glm::vec3 n) const
    {
        Rng rng(1, hashName("gathered"), 0);
        const CachedIndirect cached = [this](glm::vec3 q, glm::vec3 m, glm::vec3& lux) {
            return field_->lookup(q, m, lux);
        };
        return gatherIndirect(*at_.rays, *at_.lights, {}, cached, p, n, 4096, 4, rng);
    }

private Q_SLOTS:
    void initTestCase()
    {
        params_.voxelSize = 48;
        params_.voxelDirections = 256;
        asked_ = params_;
        VoxelSolver solver;
        BakeProducts products;
        const BakeJob job{scene_, params_, {}};
        const Baked baked = runSolver(solver, job, products);
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        field_ = baked.field;
        BakeControl quiet(workers_, {});
        at_ = *sceneProducts(job, products, quiet);
    }

    void parametersChooseTheLookup()
    {
        QVERIFY(shown(VoxelLookup::field) == field_);
        const auto cuts = shown(VoxelLookup::lightcuts);
        QVERIFY(cuts->isCostly() && !field_->isCostly());
        const glm::vec3 p = facePoints(*scene_, 1, 1)[0].position, n = facePoints(*scene_, 1, 1)[0].normal;
        glm::vec3 quick, plain, fine;
        QVERIFY(cuts->lookupQuick(p, n, quick) && field_->lookup(p, n, plain) && cuts->lookup(p, n, fine));
        QVERIFY(quick == plain && fine != plain);
    }

    void cutsAreWhatAGatherFinds()
    {
        const auto cuts = shown(VoxelLookup::lightcuts);
        RunningMean off, squares;
        for (const SurfacePoint& point : samplePoints(*at_.rays, *at_.lights, *at_.reach, 60, 3)) {
            const float wanted = luminance(gathered(point.position, point.normal));
            const auto error = double(luminance(cuts->irradiance(point.position, point.normal)) / wanted - 1.0f);
            off.add(error), squares.add(error * error);
        }
        qInfo("mean %+.4f, rms %.4f over %d places", off.mean(), std::sqrt(squares.mean()), int(off.count()));
        QVERIFY(std::abs(off.mean()) <= 0.015 && std::sqrt(squares.mean()) <= 0.05);
        const glm::vec3 middle = scene_->bounds.centre() + glm::vec3(0.0f, 0.15f, 0.0f);
        for (const glm::vec3 n : {glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(0.6f, 0, 0.8f)}) {
            glm::vec3 lux;
            QVERIFY(cuts->lookup(middle, n, lux));
            QVERIFY(std::abs(luminance(lux) / luminance(gathered(middle, n)) - 1.0f) <= 0.05f);
        }
    }

    void lampsInTheCut() // joined at a root: the lamp's part is exact direct light, the rest what a cut alone finds
    {
        params_ = asked_;
        params_.voxelLamps = 256;
        const auto field = shown(VoxelLookup::lightcuts);
        const auto& cuts = dynamic_cast<const VoxelCuts&>(*field);
        RunningMean direct, others, all;
        for (const SurfacePoint& point : samplePoints(*at_.rays, *at_.lights, *at_.reach, 60, 3)) {
            const glm::vec3 p = point.position, n = point.normal;
            Rng rng(1, 2, 3);
            const float exact = luminance(directIlluminance(*at_.rays, *at_.lights, {}, p, n, 4096, rng)),
                        alone = luminance(field->irradiance(p, n)), whole = exact + alone;
            const Lightcut joined = cuts.joinedAt(p, n);
            const float lamps = luminance(joined.fromLamps), rest = luminance(joined.illuminance) - lamps;
            direct.add(std::pow(double((lamps - exact) / whole), 2.0));
            others.add(std::pow(double((rest - alone) / whole), 2.0));
            all.add(double((lamps + rest) / whole - 1.0f));
        }
        qInfo("off by %.4f (lamps), %.4f (others) of all light, mean %+.4f", std::sqrt(direct.mean()),
              std::sqrt(others.mean()), all.mean());
        QVERIFY(std::sqrt(direct.mean()) <= 1.6 * double(params_.voxelThreshold));
        QVERIFY(std::sqrt(others.mean()) <= 1.6 * double(params_.voxelThreshold));
        QVERIFY(std::abs(all.mean()) <= 0.5 * double(params_.voxelThreshold));
        params_ = asked_;
    }

    void
    picturesWithLampsInTheCut() // are those with shadow rays to lamps, apart from noise; direct light by direct light
    {
        params_ = asked_;
        ViewJob job = pictureOf(*scene_);
        job.directSamples = 64;
        View views[2];
        for (const int lamps : {0, 256}) {
            params_.voxelLamps = lamps;
            const auto field = shown(VoxelLookup::lightcuts);
            views[lamps > 0] = renderView(*at_.rays, *at_.lights, {}, field.get(), job, workers_, {});
        }
        for (const auto image : {&View::direct, &View::indirect}) {
            double squares = 0.0, difference = 0.0, sum = 0.0, count = 0.0;
            for (std::size_t i = 0; i < (views[0].*image).pixels.size(); ++i) {
                const auto a = double(luminance((views[0].*image).pixels[i])),
                           b = double(luminance((views[1].*image).pixels[i]));
                if (a > 1000.0) continue; // the lamp itself
                squares += (b - a) * (b - a), difference += b - a, sum += a, count += 1.0;
            }
            qInfo("rms %.4f, mean %+.4f", std::sqrt(squares / count) / (sum / count), difference / sum);
            QVERIFY(std::sqrt(squares / count) <= 0.1 * sum / count);
            QVERIFY(std::abs(difference) <= 0.01 * sum);
        }
        params_ = asked_;
    }

    void wideLobesAreLitByCuts_data()
    {
        QTest::addColumn<float>("roughness");
        QTest::addColumn<bool>("isWide");
        QTest::newRow("narrow, by rays") << 0.35f << false;
        QTest::newRow("wide") << 0.5f << true;
        QTest::newRow("wider") << 0.8f << true;
    }
    void wideLobesAreLitByCuts() // a small plate of metal in a room: as paths see it, and counted
    {
        QFETCH(float, roughness);
        QFETCH(bool, isWide);
        SceneBuilder builder("plate");
        builder.add("Room", boxMesh({-1, 0, -1}, {1, 2, 1}, Facing::in),
                    builder.addMaterial("grey", {0.7f, 0.5f, 0.4f}));
        builder.add("Red", quadMesh({-0.99f, 0, -1}, {0, 2, 0}, {0, 0, 2}),
                    builder.addMaterial("red", {0.8f, 0.1f, 0.1f}));
        builder.add("Plate", quadMesh({-0.15f, 0.05f, -0.15f}, {0, 0, 0.3f}, {0.3f, 0, 0}),
                    builder.addMetal("metal", glm::vec3(0.9f), roughness));
        builder.addPoint("Lamp", {0.3f, 1.6f, 0.2f}, glm::vec3(100.0f));
        builder.addCamera("close", {0.3f, 0.35f, 0.0f}, {0.0f, 0.05f, 0.0f}, 20.0f);
        const auto scene = share(builder.finish());
        BakeParams p = asked_;
        p.voxelSize = 32;
        VoxelSolver solver;
        BakeProducts products;
        const BakeJob bake{scene, p, {}};
        const Baked baked = runSolver(solver, bake, products);
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        BakeControl quiet(workers_, {});
        const SceneProducts at = *sceneProducts(bake, products, quiet);
        const auto field = *shownField(baked.field, p, at.lights);
        ViewJob job = pictureOf(*scene);
        job.width = 16, job.height = 12, job.samples = 64;
        job.withDirect = false;
        const View cuts = renderView(*at.rays, *at.lights, {}, field.get(), job, workers_, {});
        const auto pixels = cuts.indirect.pixels.size();
        QCOMPARE(cuts.glossByCut, isWide ? pixels : 0u);
        QCOMPARE(cuts.glossByRays, isWide ? 0u : pixels);
        job.indirect = ViewJob::Indirect::paths;
        job.samples = 1024;
        const View paths = renderView(*at.rays, *at.lights, {}, nullptr, job, workers_, {});
        glm::dvec3 found(0.0), wanted(0.0);
        double squares = 0.0;
        for (std::size_t i = 0; i < pixels; ++i) {
            found += glm::dvec3(cuts.indirect.pixels[i]), wanted += glm::dvec3(paths.indirect.pixels[i]);
            squares += std::pow(double(luminance(cuts.indirect.pixels[i] - paths.indirect.pixels[i])), 2.0);
        }
        const glm::dvec3 ratio = found / wanted;
        const double mean = double(luminance(glm::vec3(wanted))) / double(pixels);
        qInfo("%.3f %.3f %.3f of what paths see, rms %.3f", ratio.x, ratio.y, ratio.z,
              std::sqrt(squares / double(pixels)) / mean);
        for (int c = 0; c < 3; ++c) QVERIFY(std::abs(ratio[c] - 1.0) <= 0.04);
        QVERIFY(std::sqrt(squares / double(pixels)) <= 0.1 * mean);
    }

    void samplesAreRightInTheMean() // places share their draws, so that only seeds tell
    {
        const std::vector<SurfacePoint> points = samplePoints(*at_.rays, *at_.lights, *at_.reach, 60, 4);
        params_.voxelThreshold = 0.005f;
        params_.voxelLights = 2048;
        const auto cuts = shown(VoxelLookup::lightcuts);
        RunningMean overSeeds;
        for (params_.seed = 1; params_.seed <= 12; ++params_.seed) {
            const auto samples = shown(VoxelLookup::samples);
            RunningMean off;
            for (const SurfacePoint& point : points) {
                const float lux = luminance(cuts->irradiance(point.position, point.normal));
                off.add(double(luminance(samples->irradiance(point.position, point.normal)) / lux - 1.0f));
            }
            overSeeds.add(off.mean());
        }
        const double error = std::sqrt(overSeeds.variance() / double(overSeeds.count()));
        qInfo("mean %+.4f, standard error %.4f", overSeeds.mean(), error);
        QVERIFY(error <= 0.01 && std::abs(overSeeds.mean()) <= 3.0 * error + 0.005); // .005: the cuts' own
        params_ = asked_;
    }

    void mixesScale()
    {
        const auto cuts = shown(VoxelLookup::lightcuts), half = cuts->withMix({glm::vec3(0.5f)});
        QVERIFY(half->isCostly());
        for (const FacePoint& point : facePoints(*scene_, 40, 5)) {
            const glm::vec3 a = cuts->irradiance(point.position, point.normal),
                            b = half->irradiance(point.position, point.normal);
            QVERIFY(glm::length(0.5f * a - b) <= 1e-4f * glm::length(a) + 1e-6f);
        }
    }

    void picturesAskOncePerSurfaceAndPixel()
    {
        const ViewJob job = pictureOf(*scene_);
        const auto pixels = std::uint64_t(job.width) * std::uint64_t(job.height);
        const Counted counted(field_);
        const View shared = renderView(*at_.rays, *at_.lights, {}, &counted, job, workers_, {});
        qInfo("asked %.2f times a pixel of %d samples", double(counted.asked) / double(pixels), job.samples);
        QVERIFY(counted.asked <= 2 * pixels);
        const View each = renderView(*at_.rays, *at_.lights, {}, field_.get(), job, workers_, {});
        RunningMean difference, light;
        for (std::size_t i = 0; i < pixels; ++i) {
            difference.add(double(std::abs(luminance(shared.indirect.pixels[i] - each.indirect.pixels[i]))));
            light.add(double(luminance(each.indirect.pixels[i])));
        }
        // a pixel of so small a picture covers half a voxel: its middle is not its mean
        qInfo("differs by %.4f of the mean", difference.mean() / light.mean());
        QVERIFY(difference.mean() <= 0.02 * light.mean());
    }

    void slicesAreTheSameToTheBit()
    {
        ViewJob job = pictureOf(*scene_);
        job.width = 32, job.height = 24;
        const auto cuts = shown(VoxelLookup::lightcuts);
        Workers five(5);
        const View whole = renderView(*at_.rays, *at_.lights, {}, cuts.get(), job, five, {});
        ProgressiveView view(at_.rays, at_.lights, {}, cuts, job);
        View shown;
        int slices = 0;
        for (; !view.isWhole() && slices < 100; ++slices) shown = view.advance(0.0, workers_, {});
        QVERIFY(slices > 2 && sameBits(whole, shown));
        QCOMPARE(shown.cutSizes, whole.cutSizes);
    }

    void picturesTellTheSizesOfTheirCuts()
    {
        ViewJob job = pictureOf(*scene_);
        job.samples = 1;
        const auto cuts = std::dynamic_pointer_cast<const VoxelCuts>(shown(VoxelLookup::lightcuts));
        const View view = renderView(*at_.rays, *at_.lights, {}, cuts.get(), job, workers_, {});
        const CutMap map = cutMap(view);
        QCOMPARE(map.sizes.values.size(), std::size_t(job.width * job.height));
        const Lens lens(job);
        std::vector<int> found;
        for (int y = 0; y < job.height; ++y) {
            for (int x = 0; x < job.width; ++x) {
                glm::vec3 origin, travel;
                lens.ray(x, y, glm::vec2(0.5f), origin, travel);
                Hit hit;
                int nodes = 0;
                if (at_.rays->intersect(origin, travel, 1e30f, hit) &&
                    surfaceAt(*at_.rays, hit).diffuse != glm::vec3(0.0f)) // lamps and metals ask for no light
                    nodes = cuts->cutAt(hit.position, hit.facing()).nodes;
                QCOMPARE(int(map.sizes.values[std::size_t(y * job.width + x)]), nodes);
                if (nodes > 0) found.push_back(nodes);
            }
        }
        std::ranges::sort(found);
        qInfo("mean %.0f, p99 %d, most %d", map.mean, map.p99, map.most);
        QCOMPARE(map.pixels, found.size());
        QCOMPARE(map.most, found.back());
        QVERIFY(map.top() >= 0.5f * float(map.p99));
        const auto within = std::ranges::count_if(found, [&](int n) { return n <= map.p99; });
        const auto below = std::ranges::count_if(found, [&](int n) { return n < map.p99; });
        QVERIFY(100 * within >= 99 * std::ssize(found) && 100 * below < 99 * std::ssize(found));
        QVERIFY(std::abs(map.mean - std::accumulate(found.begin(), found.end(), 0.0) / double(found.size())) <= 1e-9);
        job.block = 8; // a rough picture has one cut for all of a block
        const View rough = renderView(*at_.rays, *at_.lights, {}, cuts.get(), job, workers_, {});
        for (std::size_t i = 0; i < 8; ++i) QCOMPARE(rough.cutSizes[i], rough.cutSizes[0]);
        const View plain = renderView(*at_.rays, *at_.lights, {}, field_.get(), job, workers_, {});
        QVERIFY(plain.cutSizes.empty() && cutMap(plain).sizes.values.empty() && cutMap(plain).pixels == 0);
        const auto samples = shown(VoxelLookup::samples);
        job.width = job.height = 8;
        QVERIFY(renderView(*at_.rays, *at_.lights, {}, samples.get(), job, workers_, {}).cutSizes.empty());
        params_ = asked_;
    }
};

QTEST_APPLESS_MAIN(VoxelCutsTest)
#include "tst_voxel_cuts.moc"
