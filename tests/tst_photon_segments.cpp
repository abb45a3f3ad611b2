// SPDX-License-Identifier: Apache-2.0
// Claims: segments are the ways of the photons that a photon map stores, and those that leave the scene; the same bits
// on any number of threads and whichever blocks are asked for together.
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/trace/photon_segments.h"
#include "light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

std::vector<SegmentBlock> traced(const LitScene& lit, const PhotonJob& job, int threads = 2)
{
    Workers workers(threads);
    std::vector<SegmentBlock> blocks(segmentBlocks(job.count));
    if (!traceSegments(*lit.rays, *lit.lights, job, 0, blocks, workers, {})) qFatal("stopped");
    return blocks;
}

bool isSame(const PhotonSegment& a, const PhotonSegment& b)
{
    return a.from == b.from && a.travel == b.travel && a.flux == b.flux && a.length == b.length;
}

bool isSame(const SegmentBlock& a, const SegmentBlock& b)
{
    return std::ranges::equal(a.segments, b.segments, [](const auto& x, const auto& y) { return isSame(x, y); });
}

} // namespace

class PhotonSegmentsTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void segmentsEndAtStoredPhotons_data()
    {
        QTest::addColumn<QString>("name");
        QTest::newRow("open front") << "cornell";
        QTest::newRow("two lamps") << "two_rooms";
        QTest::newRow("mirrors and glass") << "caustic_ring";
    }
    void segmentsEndAtStoredPhotons()
    {
        QFETCH(QString, name);
        const LitScene lit(*sampleScene(name.toStdString()));
        const PhotonJob job{0, 3, 10'000, 64};
        Workers workers(2);
        const auto photons = tracePhotons(*lit.rays, *lit.lights, job, workers, {});
        const auto blocks = traced(lit, job);
        std::size_t i = 0, endless = 0;
        std::uint64_t shot = 0, rays = 0;
        for (const SegmentBlock& block : blocks) {
            for (const PhotonSegment& s : block.segments) {
                if (s.length == PhotonSegment::kEndless) {
                    ++endless;
                    continue;
                }
                // in the order in which they are stored; dark glass may end a photon at the surface, unstored
                const bool isPhoton = i < photons->photons.size() && photons->photons[i].toLight == -s.travel;
                if (!isPhoton && name == "caustic_ring") continue;
                QVERIFY2(isPhoton, qPrintable(QString("segment %1 ends at no photon").arg(i)));
                const Photon& p = photons->photons[i++];
                const float off = glm::length(s.from + s.length * s.travel - p.position);
                QVERIFY2(off <= 1e-5f * lit.scene->bounds.diagonal(), qPrintable(QString("%1 m off").arg(double(off))));
                if (name != "caustic_ring") QVERIFY(p.flux == s.flux); // glass takes from it on the way
            }
            shot += block.counts.shot, rays += block.counts.rays;
        }
        QCOMPARE(i, photons->photons.size());
        QCOMPARE(shot, job.count);
        QCOMPARE(rays, photons->rays);
        if (name == "cornell") QVERIFY2(endless > 500, "the box is open in front");
        if (name == "two_rooms") QVERIFY2(endless == 0, "the rooms are closed");
    }

    void blocksAndThreadsChangeNoBit()
    {
        const LitScene lit(*sampleScene("cornell"));
        const PhotonJob job{0, 1, 20'000, 64};
        const auto all = traced(lit, job, 1), again = traced(lit, job, 5);
        QVERIFY(all.size() == 5 &&
                std::ranges::equal(all, again, [](const auto& a, const auto& b) { return isSame(a, b); }));
        Workers workers(2);
        std::vector<SegmentBlock> some(2);
        some[0].segments.resize(17); // memory from before
        QVERIFY(traceSegments(*lit.rays, *lit.lights, job, 3, some, workers, {}));
        QVERIFY(isSame(some[0], all[3]) && isSame(some[1], all[4]));
    }

    void stopsAndDarkness()
    {
        const LitScene dark(pointSourceRoom()); // black walls: nothing is indirect
        for (const SegmentBlock& block : traced(dark, {0, 1, 5000, 64})) QVERIFY(block.segments.empty());
        std::stop_source source;
        source.request_stop();
        Workers workers(1);
        std::vector<SegmentBlock> blocks(2);
        QVERIFY(!traceSegments(*dark.rays, *dark.lights, {0, 1, 5000, 64}, 0, blocks, workers, source.get_token()));
    }
};

QTEST_APPLESS_MAIN(PhotonSegmentsTest)
#include "tst_photon_segments.moc"
