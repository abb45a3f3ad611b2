// SPDX-License-Identifier: Apache-2.0
// Claims about the ground everything stands on: workers run each block once whatever happens, random streams are
// independent and reproducible, samplers follow their densities, files appear whole or not at all.
#include "core/base/atomic_file.h"
#include "core/base/hash.h"
#include "core/base/parallel.h"
#include "core/base/rng.h"
#include "core/base/sampling.h"
#include "core/base/statistics.h"
#include <QTemporaryDir>
#include <QtTest>
#include <atomic>
#include <csignal>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>

using namespace lightloom;

class BaseTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void rankCorrelationKnowsOrder()
    {
        const std::vector<double> rising{1.0, 2.0, 30.0, 400.0, 5000.0}, falling{5.0, 4.0, 3.0, 2.0, 1.0},
            ties{1.0, 2.0, 2.0, 3.0, 4.0}, constant(5, 7.0), mixed{3.0, 1.0, 2.0, 5.0, 4.0};
        QCOMPARE(rankCorrelation(rising, rising), 1.0);
        QCOMPARE(rankCorrelation(rising, falling), -1.0);
        QVERIFY(std::abs(rankCorrelation(rising, ties) - std::sqrt(0.95)) <= 1e-12); // 9.5 / sqrt(10 * 9.5)
        QVERIFY(std::abs(rankCorrelation(rising, mixed) - 0.6) <= 1e-12);            // 1 - 6 * 8 / (5 * 24)
        QCOMPARE(rankCorrelation(rising, constant), 0.0);
    }

    void workersRunEachBlockOnce_data()
    {
        QTest::addColumn<int>("threads");
        for (const int n : {1, 2, 5}) QTest::addRow("%d threads", n) << n;
    }
    void workersRunEachBlockOnce()
    {
        QFETCH(int, threads);
        Workers workers(threads);
        QCOMPARE(workers.threadCount(), threads);
        for (const std::size_t blocks : {0u, 1u, 7u, 5000u}) {
            std::vector<std::atomic<int>> ran(blocks);
            QVERIFY(workers.run(blocks, {}, [&](std::size_t b) { ran[b]++; }));
            for (const auto& count : ran) QCOMPARE(count.load(), 1);
        }
    }

    void workersStop()
    {
        Workers workers(3);
        std::stop_source stop;
        std::atomic<int> ran = 0;
        const bool all = workers.run(100'000, stop.get_token(), [&](std::size_t) {
            if (++ran == 10) stop.request_stop();
        });
        QVERIFY(!all);
        QVERIFY2(ran < 20, qPrintable(QString("%1 blocks ran after the stop").arg(ran - 10)));
    }

    void workersPassExceptionsOn()
    {
        Workers workers(2);
        QVERIFY_EXCEPTION_THROWN(workers.run(100, {},
                                             [](std::size_t b) {
                                                 if (b == 50) throw std::bad_alloc();
                                             }),
                                 std::bad_alloc);
        std::atomic<int> ran = 0; // still usable afterwards
        QVERIFY(workers.run(10, {}, [&](std::size_t) { ran++; }));
        QCOMPARE(ran.load(), 10);
    }

    void workersTakeTurns()
    {
        Workers workers(2);
        std::atomic<int> total = 0;
        std::vector<std::thread> callers;
        for (int i = 0; i < 4; ++i) {
            callers.emplace_back([&] {
                for (int n = 0; n < 50; ++n) workers.run(20, {}, [&](std::size_t) { total++; });
            });
        }
        for (std::thread& caller : callers) caller.join();
        QCOMPARE(total.load(), 4 * 50 * 20);
    }

    void streamsAreReproducibleAndApart()
    {
        Rng a(1, hashName("lamp"), 7), b(1, hashName("lamp"), 7);
        for (int i = 0; i < 100; ++i) QCOMPARE(a.bits(), b.bits());
        // neighbouring items, streams and seeds: correlation of 100,000 pairs within 4.9 sigma of zero
        const auto correlation = [](auto make) {
            double sum = 0;
            constexpr int n = 100'000;
            for (int i = 0; i < n; ++i) {
                auto [x, y] = make(static_cast<std::uint64_t>(i));
                sum += (x - 0.5) * (y - 0.5) * 12.0;
            }
            return sum / std::sqrt(n);
        };
        const double items = correlation(
            [](std::uint64_t i) { return std::pair(Rng(1, 5, i).uniformDouble(), Rng(1, 5, i + 1).uniformDouble()); });
        const double seeds = correlation(
            [](std::uint64_t i) { return std::pair(Rng(1, 5, i).uniformDouble(), Rng(2, 5, i).uniformDouble()); });
        const double dimensions = correlation([](std::uint64_t i) {
            Rng rng(1, 5, i);
            const double x = rng.uniformDouble();
            return std::pair(x, rng.uniformDouble());
        });
        for (const double z : {items, seeds, dimensions}) QVERIFY2(std::abs(z) <= 4.9, qPrintable(QString::number(z)));
    }

    void samplersFollowTheirDensities()
    {
        RunningMean cosine, sphere, cone, triangle, disc;
        const float cosMax = std::cos(0.4f);
        for (std::uint64_t i = 0; i < 200'000; ++i) {
            Rng rng(3, 1, i);
            const float u1 = rng.uniform(), u2 = rng.uniform();
            cosine.add(sampleCosineHemisphere(u1, u2).z);      // mean of cos under cos/pi: 2/3
            sphere.add(std::pow(sampleSphere(u1, u2).x, 2.0)); // 1/3
            cone.add(sampleCone(u1, u2, cosMax).z);            // (1 + cosMax) / 2
            triangle.add(sampleTriangle(u1, u2).x);            // 1/3
            disc.add(std::pow(sampleDisc(u1, u2).x, 2.0));     // 1/4
            QVERIFY(std::abs(glm::length(sampleCosineHemisphere(u1, u2)) - 1.0f) <= 1e-5f);
        }
        const auto z = [](const RunningMean& m, double truth) { return (m.mean() - truth) / m.standardError(); };
        for (const double score : {z(disc, 0.25), z(cosine, 2.0 / 3.0), z(sphere, 1.0 / 3.0),
                                   z(cone, (1.0 + cosMax) / 2.0), z(triangle, 1.0 / 3.0)}) {
            QVERIFY2(std::abs(score) <= 4.9, qPrintable(QString::number(score)));
        }
    }

    void circlePointsAreSinesAndCosines()
    {
        for (int i = 0; i <= 1'000'000; ++i) {
            const float turns = static_cast<float>(i) * 1e-6f;
            const double angle = 2.0 * std::numbers::pi * static_cast<double>(turns);
            const glm::vec2 p = circlePoint(turns);
            QVERIFY2(std::abs(static_cast<double>(p.x) - std::cos(angle)) <= 2e-7 &&
                         std::abs(static_cast<double>(p.y) - std::sin(angle)) <= 2e-7,
                     qPrintable(QString::number(static_cast<double>(turns), 'g', 9)));
        }
    }

    void pairsOfUniformNumbersAreIndependent()
    {
        RunningMean first, second, product;
        Rng rng(11, 12, 13);
        for (int i = 0; i < 400'000; ++i) {
            const auto [a, b] = rng.uniformPair();
            QVERIFY(a >= 0.0f && a < 1.0f && b >= 0.0f && b < 1.0f);
            first.add(a), second.add(b), product.add((a - 0.5) * (b - 0.5));
        }
        QVERIFY(std::abs(first.mean() - 0.5) <= 4.9 * first.standardError());
        QVERIFY(std::abs(second.mean() - 0.5) <= 4.9 * second.standardError());
        QVERIFY(std::abs(product.mean()) <= 4.9 * product.standardError());
    }

    void framesAreOrthonormal()
    {
        for (std::uint64_t i = 0; i < 10'000; ++i) {
            Rng rng(4, 2, i);
            const glm::vec3 n = i == 0 ? glm::vec3(0, 0, -1) : sampleSphere(rng.uniform(), rng.uniform());
            const Frame f(n);
            const float worst =
                glm::max(glm::max(std::abs(glm::dot(f.tangent, f.bitangent)), std::abs(glm::dot(f.tangent, n))),
                         glm::length(glm::cross(f.tangent, f.bitangent) - n));
            QVERIFY2(worst <= 1e-5f, qPrintable(QString::number(worst)));
        }
    }

    void sha256KnowsItsTestVector()
    {
        Sha256 sum;
        sum.add("abc", 3);
        QCOMPARE(toHex(sum.finish()), std::string("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"));
    }

    void filesAreWholeOrOld()
    {
        QTemporaryDir folder;
        const std::filesystem::path path = folder.filePath("a.txt").toStdString();
        QVERIFY(static_cast<bool>(writeFile(path, std::string_view("one"))));
        ::chmod(path.c_str(), 0640);
        QVERIFY(static_cast<bool>(writeFile(path, std::string_view("two"))));
        const auto bytes = readFile(path, 100);
        QVERIFY(static_cast<bool>(bytes));
        QCOMPARE(std::string(bytes->begin(), bytes->end()), std::string("two"));
        struct stat status {};
        QCOMPARE(::stat(path.c_str(), &status), 0);
        QCOMPARE(static_cast<unsigned>(status.st_mode & 0777u), 0640u);
        QCOMPARE(QDir(folder.path()).entryList(QDir::Files).size(), 1); // no temporary left

        QVERIFY(!readFile(path, 2));                          // too long
        QVERIFY(!readFile(folder.path().toStdString(), 100)); // a folder
        QCOMPARE(readFile(path / "nothing", 100).error().kind == Error::Kind::io ||
                     readFile(path.string() + "x", 100).error().kind == Error::Kind::notFound,
                 true);
        QVERIFY(!writeFile(folder.path().toStdString(), std::string_view("x")));
        QVERIFY(!writeFile(folder.path().toStdString() + "/no/such/folder", std::string_view("x")));

        const std::string pipe = folder.filePath("pipe").toStdString();
        QCOMPARE(::mkfifo(pipe.c_str(), 0600), 0);
        QVERIFY(!readFile(pipe, 100)); // refused, not waited for
    }

    void fullDiskLosesNothing()
    {
        // a file size limit on this process stands in for a full disk: the write fails part way
        QTemporaryDir folder;
        const std::filesystem::path path = folder.filePath("b.bin").toStdString();
        QVERIFY(static_cast<bool>(writeFile(path, std::string_view("precious"))));
        struct rlimit old {};
        ::getrlimit(RLIMIT_FSIZE, &old);
        ::signal(SIGXFSZ, SIG_IGN);
        const struct rlimit small {
            100'000, old.rlim_max
        };
        ::setrlimit(RLIMIT_FSIZE, &small);
        const bool wrote = static_cast<bool>(writeFile(path, std::string(200'000, 'x')));
        ::setrlimit(RLIMIT_FSIZE, &old);
        QVERIFY(!wrote);
        QCOMPARE(QDir(folder.path()).entryList(QDir::Files).size(), 1);
        const auto bytes = readFile(path, 100);
        QVERIFY(static_cast<bool>(bytes) && bytes->size() == 8);
    }
};

QTEST_APPLESS_MAIN(BaseTest)
#include "tst_base.moc"
