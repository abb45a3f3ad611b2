// SPDX-License-Identifier: Apache-2.0
// Claims: a bake file gives back every bit; the same bake is the same bytes on any number of threads; a damaged,
// truncated, foreign or newer file is refused with a line, never read.
#include "core/bake/bake_file.h"
#include "core/bake/vdb_seal.h"
#include "core/base/atomic_file.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "tests/bake_helpers.h"
#include <QTemporaryDir>
#include <QtTest>
#include <cstring>

using namespace lightloom;

class BakeFileTest : public QObject {
    Q_OBJECT

    std::shared_ptr<const Scene> scene_ = test::share(cornellBox());
    BakeParams params_;
    BakeInfo info_;
    std::vector<std::uint8_t> bytes_;
    test::Baked baked_;

private Q_SLOTS:
    void initTestCase()
    {
        params_.photonCount = 20'000;
        params_.octreeDepth = 5;
        info_.params = params_;
        info_.sceneHash = sceneHash(*scene_);
        info_.isa = "avx2";
        info_.program = "test";
        baked_ = test::bakeOctree(scene_, params_);
        const auto bytes = bakeBytes(*baked_.field, info_, *scene_);
        QVERIFY2(static_cast<bool>(bytes), bytes ? "" : bytes.error().message.c_str());
        bytes_ = *bytes;
    }

    void givesBackEveryBit()
    {
        const Result<BakeFile> file = bakeFromBytes(bytes_, *scene_);
        QVERIFY2(static_cast<bool>(file), file ? "" : file.error().message.c_str());
        QVERIFY(file->info.params == params_);
        QCOMPARE(file->info.isa, std::string("avx2"));
        const LightOctree &a = *baked_.octree(), &b = *file->octree;
        QVERIFY(a.geometry().cells == b.geometry().cells && a.geometry().firstEntry == b.geometry().firstEntry);
        QCOMPARE(std::memcmp(a.geometry().entries.data(), b.geometry().entries.data(),
                             a.geometry().entries.size() * sizeof(OctreeEntry)),
                 0);
        const VdlLayer &x = *a.layers()[0], &y = *b.layers()[0];
        QCOMPARE(x.count, y.count);
        QCOMPARE(std::memcmp(x.vdls.data(), y.vdls.data(), x.vdls.size() * sizeof(Vdl)), 0);
        QCOMPARE(std::memcmp(x.scalar.data(), y.scalar.data(), x.scalar.size() * sizeof(glm::vec3)), 0);
        QVERIFY(x.noise.size() == x.scalar.size() && x.noise == y.noise);
    }

    void sameBytesOnAnyThreads()
    {
        for (const int threads : {1, 5}) {
            const auto again = bakeBytes(*test::bakeOctree(scene_, params_, threads).field, info_, *scene_);
            QVERIFY(static_cast<bool>(again) && *again == bytes_);
        }
    }

    void photonMapsComeBack()
    {
        PhotonMapSolver solver;
        BakeProducts products;
        const test::Baked baked = test::runSolver(solver, {scene_, params_, {}}, products);
        BakeInfo info = info_;
        info.method = Method::photonMap;
        const auto bytes = bakeBytes(*baked.field, info, *scene_);
        QVERIFY(static_cast<bool>(bytes));
        const Result<BakeFile> file = bakeFromBytes(*bytes, *scene_);
        QVERIFY2(static_cast<bool>(file), file ? "" : file.error().message.c_str());
        const auto& map = dynamic_cast<const PhotonMapField&>(*baked.field).layers()[0].map;
        QCOMPARE(file->photons[0]->shot, map->paths().shot);
        QCOMPARE(file->photons[0]->photons.size(), map->size());
        const std::vector<std::uint32_t> order = map->listOrder();
        for (std::size_t i = 0; i < order.size(); ++i)
            QCOMPARE(std::memcmp(&file->photons[0]->photons[i], &map->photon(order[i]), sizeof(Photon)), 0);
    }

    void damageIsRefused()
    {
        for (std::size_t i = 0; i < bytes_.size(); i += 1 + bytes_.size() / 500) {
            std::vector<std::uint8_t> flipped = bytes_;
            flipped[i] ^= 0x10;
            QVERIFY2(!bakeFromBytes(flipped, *scene_), qPrintable(QString("byte %1").arg(i)));
            QVERIFY(!bakeFromBytes(std::span(bytes_).first(i), *scene_));
        }
        QVERIFY(!bakeFromBytes({}, *scene_));
    }

    void otherScenesAreRefused()
    {
        const Result<BakeFile> file = bakeFromBytes(bytes_, cavityCube(0.5f));
        QVERIFY(!file && file.error().message.find("another scene") != std::string::npos);
    }

    void sealedNonsenseIsRefused() // right checksum, no OpenVDB inside
    {
        QVERIFY(!bakeFromBytes(sealVdb("nothing that OpenVDB wrote, but longer than its header is by a good deal"),
                               *scene_));
        QVERIFY(!bakeFromBytes(sealVdb(""), *scene_));
    }

    void filesOnDisk()
    {
        QTemporaryDir folder;
        const std::filesystem::path path = folder.filePath("a.vdb").toStdString();
        QVERIFY(static_cast<bool>(writeBake(path, *baked_.field, info_, *scene_)));
        QVERIFY(static_cast<bool>(readBake(path, *scene_)));
        const Result<BakeFile> none = readBake(folder.filePath("b.vdb").toStdString(), *scene_);
        QVERIFY(!none && none.error().kind == Error::Kind::notFound);
    }
};

QTEST_APPLESS_MAIN(BakeFileTest)
#include "tst_bake_file.moc"
