// SPDX-License-Identifier: Apache-2.0
// Claims: the kd-tree finds exactly the photons that brute force finds, whatever the kernel, and in the order of their
// numbers, whatever the guess; its selections are those of sorting; K beyond the count, no photons and all photons on
// one point are survived.
#include "core/base/sampling.h"
#include "core/photonmap/least_keys.h"
#include "core/photonmap/photon_map.h"
#include <QtTest>
#include <algorithm>
#include <cstring>
#include <functional>

using namespace lightloom;

class PhotonMapTest : public QObject {
    Q_OBJECT

    static std::shared_ptr<const PhotonPaths> randomPaths(std::size_t count)
    {
        auto paths = std::make_shared<PhotonPaths>();
        for (std::size_t i = 0; i < count; ++i) {
            Rng rng(1, 2, i);
            const glm::vec3 p(rng.uniform(), rng.uniform() * 0.3f, rng.uniform() * rng.uniform());
            const float u1 = rng.uniform(), u2 = rng.uniform(), u3 = rng.uniform(), u4 = rng.uniform();
            paths->photons.push_back({p, sampleSphere(u1, u2), glm::vec3(1.0f), sampleSphere(u3, u4)});
        }
        return paths;
    }

    static std::vector<std::uint32_t> bruteForce(const PhotonMap& map, const GatherQuery& q)
    {
        std::vector<std::pair<float, std::uint32_t>> found;
        for (std::uint32_t i = 0; i < map.size(); ++i) {
            const Photon& photon = map.photon(i);
            const glm::vec3 d = photon.position - q.centre;
            const float along = d.x * q.normal.x + d.y * q.normal.y + d.z * q.normal.z;
            const float squared = d.x * d.x + d.y * d.y + d.z * d.z + (q.stretch * q.stretch - 1.0f) * along * along;
            const float cosine =
                photon.normal.x * q.normal.x + photon.normal.y * q.normal.y + photon.normal.z * q.normal.z;
            if (squared <= q.radius * q.radius && cosine > q.leastCosine) found.emplace_back(squared, i);
        }
        std::ranges::sort(found);
        if (found.size() > q.count) found.resize(q.count);
        std::vector<std::uint32_t> numbers;
        for (const auto& [squared, number] : found) numbers.push_back(number);
        std::ranges::sort(numbers);
        return numbers;
    }

private Q_SLOTS:
    void findsWhatBruteForceFinds()
    {
        for (const std::size_t count : {1u, 15u, 16u, 17u, 100u, 5000u}) {
            const auto map = PhotonMap::build(randomPaths(count));
            Gathered gathered;
            for (std::uint64_t i = 0; i < 200; ++i) {
                Rng rng(7, 8, i);
                GatherQuery q;
                q.centre = {rng.uniform(), rng.uniform() * 0.3f, rng.uniform()};
                const float u1 = rng.uniform(), u2 = rng.uniform();
                q.normal = sampleSphere(u1, u2);
                q.radius = 0.5f * rng.uniform();
                q.stretch = i % 2 ? 1.0f : 3.0f;
                q.leastCosine = i % 3 ? 0.5f : -2.0f;
                q.count = 1 + static_cast<std::uint32_t>(rng.bits() % 300);
                map->gather(q, gathered);
                std::vector<std::uint32_t> numbers = gathered.photons;
                std::ranges::sort(numbers);
                QVERIFY2(numbers == bruteForce(*map, q),
                         qPrintable(QString("query %1 of %2 photons").arg(i).arg(count)));
                QCOMPARE(gathered.isFull, numbers.size() == q.count);
                QVERIFY(gathered.radius <= q.radius);
            }
        }
    }

    void guessesChangeNothing()
    {
        const auto map = PhotonMap::build(randomPaths(5000));
        const GatherQuery q{{0.4f, 0.1f, 0.3f}, {0, 1, 0}, 0.4f, 1.0f, -2.0f, 120};
        for (const float guess : {0.0f, 1e-6f, 0.05f, 0.1f, 0.39f, 7.0f}) {
            Gathered gathered;
            gathered.expected = guess;
            map->gather(q, gathered);
            QVERIFY(gathered.isFull && gathered.photons == bruteForce(*map, q));
            QVERIFY(std::ranges::equal(gathered.keys, gathered.photons, {},
                                       [](std::uint64_t key) { return static_cast<std::uint32_t>(key); }));
        }
    }

    void guessesFarTooWideToo() // nearly all photons on a speck: what held K elsewhere holds thousands there
    {
        auto paths = std::make_shared<PhotonPaths>(*randomPaths(20'000));
        for (std::size_t i = 0; i < paths->photons.size(); ++i) {
            if (i % 20 != 0) paths->photons[i].position = glm::vec3(0.5f) + 1e-3f * paths->photons[i].position;
        }
        const auto map = PhotonMap::build(paths);
        for (const float guess : {0.0f, 1e-5f, 0.3f}) {
            for (const std::uint32_t k : {1u, 100u}) {
                Gathered gathered;
                gathered.expected = guess;
                const GatherQuery q{glm::vec3(0.5004f), {0, 1, 0}, 1.0f, 1.0f, -2.0f, k};
                map->gather(q, gathered);
                QVERIFY(gathered.isFull && gathered.photons == bruteForce(*map, q));
            }
        }
    }

    void selectsAsSortingDoes()
    {
        std::vector<std::uint64_t> work;
        for (std::uint64_t trial = 0; trial < 300; ++trial) {
            Rng rng(4, 9, trial);
            const std::size_t count = 1 + rng.bits() % 400, k = 1 + rng.bits() % count;
            std::vector<std::uint64_t> keys;
            for (std::uint64_t i = 0; i < count; ++i) {
                float squared = rng.uniform();
                if (trial % 3 == 1) squared = i % 4 == 0 ? 0.25f : 0.0f; // mostly equal
                if (trial % 3 == 2) squared = squared * squared * squared * squared * 1e-30f;
                keys.push_back(std::uint64_t(std::bit_cast<std::uint32_t>(squared)) << 32 | i);
            }
            std::vector<std::uint64_t> sorted = keys, kept = keys, parted = keys;
            std::ranges::sort(sorted);
            const std::uint64_t least = leastKey(keys.data(), count, k, work);
            QCOMPARE(least, sorted[k - 1]);
            const auto isKept = [&](std::uint64_t key) { return key <= least; };
            std::vector<std::uint64_t> wanted;
            std::ranges::copy_if(keys, std::back_inserter(wanted), isKept);
            kept.resize(keepUpTo(least, kept.data(), count));
            QVERIFY(kept == wanted && kept.size() == k);
            std::ranges::copy_if(keys, std::back_inserter(wanted), std::not_fn(isKept));
            partAt(least, parted.data(), count, work);
            QVERIFY(parted == wanted);
        }
    }

    void photonsLieInTheTreesOrder()
    {
        const auto paths = randomPaths(5000);
        const auto map = PhotonMap::build(paths);
        const std::vector<std::uint32_t> order = map->listOrder();
        for (std::uint32_t i = 0; i < order.size(); ++i) {
            QCOMPARE(map->origin(order[i]), i);
            QVERIFY(std::memcmp(&map->photon(order[i]), &paths->photons[i], sizeof(Photon)) == 0);
        }
        // from its own order the same tree comes out again
        const auto again = PhotonMap::build(std::make_shared<PhotonPaths>(map->paths()));
        for (std::uint32_t i = 0; i < order.size(); ++i) QCOMPARE(again->origin(i), i);
        double apart = 0.0;
        for (std::uint32_t i = 1; i < order.size(); ++i)
            apart += static_cast<double>(glm::distance(map->photon(i).position, map->photon(i - 1).position));
        QVERIFY(apart / 5000.0 < 0.1); // random ones are .6 apart
    }

    void survivesNothingAndOnePoint()
    {
        Gathered gathered;
        GatherQuery q;
        const auto none = PhotonMap::build(std::make_shared<PhotonPaths>());
        none->gather(q, gathered);
        QVERIFY(gathered.photons.empty() && !gathered.isFull);

        auto heap = std::make_shared<PhotonPaths>();
        heap->photons.assign(10'000, {glm::vec3(0.5f), glm::vec3(0, 1, 0), glm::vec3(1.0f), glm::vec3(0, 1, 0)});
        const auto map = PhotonMap::build(heap);
        q.centre = glm::vec3(0.5f);
        q.count = 100;
        map->gather(q, gathered);
        QCOMPARE(gathered.photons.size(), std::size_t(100));
        QCOMPARE(gathered.radius, 0.0f);
        std::ranges::sort(gathered.photons); // ties go by number
        QCOMPARE(gathered.photons.back(), 99u);
    }
};

QTEST_APPLESS_MAIN(PhotonMapTest)
#include "tst_photon_map.moc"
