// SPDX-License-Identifier: Apache-2.0
// Claim: a reference that grows while one looks is coarse first, ends as the plain renderer has it, survives stops, and
// is there at once the second time; a bake is judged by it as pictures are, before and after it is whole;
// one that takes long to ask in blocks of pixels first.
#include "bake_helpers.h"
#include "core/compare/live_compare.h"
#include "core/scene/sample_scenes.h"
#include "tests/view_helpers.h"
#include <QTemporaryDir>
#include <QtTest>
#include <atomic>
#include <mutex>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// Says that a lookup takes long, and counts them.
class Costly final : public IndirectField {
public:
    explicit Costly(std::shared_ptr<const IndirectField> field) : field_(std::move(field)) {}
    [[nodiscard]] bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override
    {
        ++asked;
        return field_->lookup(p, n, lux);
    }
    [[nodiscard]] bool lookupQuick(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override
    {
        return field_->lookup(p, n, lux);
    }
    [[nodiscard]] bool isCostly() const override { return true; }
    [[nodiscard]] std::shared_ptr<const IndirectField> withMix(Mix mix) const override
    {
        return std::make_shared<Costly>(field_->withMix(std::move(mix)));
    }
    [[nodiscard]] std::string_view method() const override { return field_->method(); }
    [[nodiscard]] std::size_t memoryBytes() const override { return field_->memoryBytes(); }
    mutable std::atomic<std::uint64_t> asked = 0;

private:
    std::shared_ptr<const IndirectField> field_;
};

} // namespace

class LiveCompareTest : public QObject {
    Q_OBJECT
    std::shared_ptr<const Scene> scene_ = share(*sampleScene("cornell"));
    std::shared_ptr<const RayScene> rays_ = *RayScene::build(scene_);
    std::shared_ptr<const LightSampler> lights_ = std::make_shared<LightSampler>(rays_);
    Workers workers_{2};

    [[nodiscard]] CompareQuestion question(int samples, const QString& file = {}) const
    {
        ViewJob job{scene_->cameras[0], 70, 50};
        job.indirect = ViewJob::Indirect::paths;
        job.samples = samples;
        return {rays_, lights_, {}, job, file.toStdString()};
    }
    [[nodiscard]] View plain(const ViewJob& job, const IndirectField* field = nullptr)
    {
        return renderView(*rays_, *lights_, {}, field, job, workers_, {});
    }

private Q_SLOTS:
    void itIsCoarseFirstAndEndsAsThePlainRenderer()
    {
        LiveCompare live(question(16));
        QVERIFY(!live.reference() && !live.isWhole());
        QVERIFY(live.advanceReference(workers_, {}));
        QVERIFY(live.isRough() && !live.isWhole()); // however fine it is for its size
        QCOMPARE(live.reference()->direct.width, 70 / 4);
        int slices = 0;
        while (!live.isWhole()) {
            QVERIFY(live.advanceReference(workers_, {}));
            QVERIFY(!live.isRough() && live.reference()->samples > 0);
            ++slices;
        }
        QVERIFY(slices >= 1 && live.seconds() > 0.0 && !live.wasStored());
        QVERIFY(sameBits(*live.reference(), plain(question(16).job)));
    }

    void aStopShowsNothingHalf()
    {
        LiveCompare live(question(16));
        std::stop_source stopped;
        stopped.request_stop();
        QVERIFY(!live.advanceReference(workers_, stopped.get_token()));
        QVERIFY(!live.reference());
        QVERIFY(live.advanceReference(workers_, {}));
        QVERIFY(!live.advanceReference(workers_, stopped.get_token()));
        QVERIFY(live.isRough());
        while (!live.isWhole()) QVERIFY(live.advanceReference(workers_, {}));
        QVERIFY(sameBits(*live.reference(), plain(question(16).job)));
    }

    void theSecondTimeItIsThere()
    {
        const QTemporaryDir folder;
        qputenv("XDG_CACHE_HOME", (folder.path() + "/user").toUtf8());
        const QString file = folder.filePath("cornell.glb");
        LiveCompare first(question(16, file));
        QVERIFY(!first.wasStored());
        while (!first.isWhole()) QVERIFY(first.advanceReference(workers_, {}));
        const LiveCompare again(question(16, file)), fewer(question(8, file)), more(question(32, file));
        QVERIFY(again.wasStored() && again.isWhole() && sameBits(*again.reference(), *first.reference()));
        QVERIFY(fewer.wasStored() && fewer.reference()->samples == 16); // better than asked
        QVERIFY(!more.wasStored() && !more.reference());
    }

    void aBakeIsJudgedAsPicturesAre()
    {
        BakeParams params;
        params.photonCount = 20'000;
        params.octreeDepth = 4;
        const Baked baked = bakeOctree(scene_, params);
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        LiveCompare live(question(16));
        live.setField(baked.field);
        QVERIFY(!live.wantsField()); // there is nothing to hold it against
        QVERIFY(live.advanceReference(workers_, {}));
        QVERIFY(!live.wantsField() && !live.error(ErrorKind::relative)); // a rough one is of another size
        while (!live.isWhole()) QVERIFY(live.advanceReference(workers_, {}));
        while (live.wantsField()) QVERIFY(live.advanceField(workers_, {}));

        ViewJob job = question(8).job;
        job.indirect = ViewJob::Indirect::field;
        job.withDirect = false;
        const View picture = plain(job, baked.field.get()), reference = plain(question(16).job);
        const FloatImage matt = mattReflectance(*rays_, job, workers_, {});
        for (const ErrorKind kind : {ErrorKind::relative, ErrorKind::absolute, ErrorKind::difference}) {
            const auto found = live.error(kind);
            const auto expected = viewError(picture, reference, kind, matt);
            QVERIFY(found && *found && expected);
            QVERIFY((*found)->map.values == expected->map.values);
            QCOMPARE((*found)->metrics.relRmse, expected->metrics.relRmse);
            QVERIFY(expected->metrics.relRmse > 0.01);
        }
        live.setField(nullptr);
        QVERIFY(!live.error(ErrorKind::relative) && !live.wantsField());
    }

    void aCostlyFieldIsJudgedInBlocksFirst()
    {
        BakeParams params;
        params.photonCount = 20'000;
        params.octreeDepth = 4;
        const auto field = std::make_shared<const Costly>(bakeOctree(scene_, params).field);
        LiveCompare live(question(16));
        live.setField(field);
        while (!live.isWhole()) QVERIFY(live.advanceReference(workers_, {}));
        std::vector<int> blocks;
        std::vector<std::uint64_t> asked;
        while (live.wantsField()) {
            QVERIFY(live.advanceField(workers_, {}) && live.error(ErrorKind::relative));
            blocks.push_back(live.block());
            asked.push_back(field->asked.exchange(0));
        }
        QVERIFY(blocks.size() >= 4);
        blocks.resize(4);
        QCOMPARE(blocks, (std::vector<int>{8, 4, 2, 1}));
        QVERIFY(asked[0] <= 9u * 7u && asked[1] <= 18u * 13u && asked[2] <= 35u * 25u); // once a block
        ViewJob job = question(8).job;
        job.indirect = ViewJob::Indirect::field;
        job.withDirect = false;
        const auto expected = viewError(plain(job, field.get()), *live.reference(), ErrorKind::relative);
        QVERIFY(expected && (*live.error(ErrorKind::relative))->map.values == expected->map.values);
    }

    void aCostlyFieldsLastPictureWaitsForTheReference()
    {
        BakeParams params;
        params.photonCount = 20'000;
        params.octreeDepth = 4;
        CompareQuestion asked = question(20);
        asked.job.width = 280, asked.job.height = 200; // a ray per pixel takes some time
        LiveCompare live(asked);
        live.setField(std::make_shared<const Costly>(bakeOctree(scene_, params).field));
        int rays = 0, raysBefore = 0; // per pixel of the reference, when each pixel is judged, and before
        std::vector<double> parts;
        std::mutex telling;
        const auto told = [&](double part) {
            std::lock_guard lock(telling);
            parts.push_back(part);
        };
        while (live.wantsField() || !live.isWhole()) {
            const bool isField = live.wantsField();
            const bool isDone = isField ? live.advanceField(workers_, {}, told) : live.advanceReference(workers_, {});
            QVERIFY(isDone);
            if (isField && live.block() == 1 && rays == 0) rays = live.reference()->samples;
            if (isField && live.block() > 1) raysBefore = live.reference()->samples;
        }
        qInfo("%d rays per pixel before, %d then", raysBefore, rays);
        QVERIFY(raysBefore > 0 && rays >= 16);
        QVERIFY(!parts.empty() && std::ranges::all_of(parts, [](double p) { return p > 0.0 && p <= 1.0; }));
    }
};

QTEST_APPLESS_MAIN(LiveCompareTest)
#include "tst_live_compare.moc"
