// SPDX-License-Identifier: Apache-2.0
// Claims: sortOn sorts any list, the same on any number of threads; selectNth splits where sorting would; both end soon
// after a stop.
#include "core/base/ordering.h"
#include "core/base/rng.h"
#include <QtTest>
#include <atomic>
#include <cstdint>

using namespace lightloom;

namespace {

struct Item {
    std::uint32_t key, number;
    bool operator==(const Item&) const = default;
};

bool before(const Item& a, const Item& b) { return a.key != b.key ? a.key < b.key : a.number < b.number; }

std::vector<Item> list(const QString& kind, std::size_t count)
{
    std::vector<Item> items(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        Rng rng(7, 0, i);
        const auto random = static_cast<std::uint32_t>(rng.bits());
        const std::uint32_t key = kind == "rising"    ? i
                                  : kind == "falling" ? static_cast<std::uint32_t>(count) - i
                                  : kind == "one key" ? 5
                                  : kind == "few"     ? random % 3
                                  : kind == "organ"   ? std::min(i, static_cast<std::uint32_t>(count) - i)
                                                      : random;
        items[i] = {key, i};
    }
    return items;
}

/// Compares, and asks for a stop at the given comparison; counts those that follow.
struct Stopping {
    std::stop_source* source;
    std::atomic<std::uint64_t>* calls;
    std::uint64_t at;
    bool operator()(const Item& a, const Item& b) const
    {
        if (calls->fetch_add(1, std::memory_order_relaxed) + 1 == at) source->request_stop();
        return before(a, b);
    }
};

} // namespace

class OrderingTest : public QObject {
    Q_OBJECT

    static void kinds()
    {
        QTest::addColumn<QString>("kind");
        for (const char* kind : {"random", "rising", "falling", "one key", "few", "organ"}) QTest::newRow(kind) << kind;
    }

private Q_SLOTS:
    void sortsAnyList_data() { kinds(); }
    void sortsAnyList()
    {
        QFETCH(QString, kind);
        for (const std::size_t count : {0u, 1u, 2u, 16383u, 16384u, 16385u, 32768u, 81'921u, 300'000u}) {
            auto expected = list(kind, count);
            std::sort(expected.begin(), expected.end(), before);
            for (const int threads : {1, 2, 5}) {
                Workers workers(threads);
                auto items = list(kind, count);
                QVERIFY(sortOn(workers, {}, items, before));
                QVERIFY2(items == expected, qPrintable(QString("%1 on %2 threads").arg(count).arg(threads)));
            }
        }
    }

    void selectsAtAnyPlace_data() { kinds(); }
    void selectsAtAnyPlace()
    {
        QFETCH(QString, kind);
        const std::size_t count = 1'200'000; // long enough for our own steps
        auto sorted = list(kind, count);
        std::sort(sorted.begin(), sorted.end(), before);
        for (const std::size_t nth : {std::size_t(0), std::size_t(1000), count / 2, count - 1}) {
            auto items = list(kind, count);
            const auto place = items.begin() + static_cast<std::ptrdiff_t>(nth);
            QVERIFY(selectNth(items.begin(), place, items.end(), before, {}));
            QVERIFY2(*place == sorted[nth], qPrintable(QString("place %1").arg(nth)));
            for (auto i = items.begin(); i < place; ++i) QVERIFY(before(*i, *place));
            for (auto i = place + 1; i < items.end(); ++i) QVERIFY(before(*place, *i));
            std::sort(items.begin(), items.end(), before);
            QVERIFY2(items == sorted, "values were lost");
        }
    }

    void selectsAmongEquals() // an order that is not total: only keys are split
    {
        const auto byKey = [](const Item& a, const Item& b) { return a.key < b.key; };
        for (const char* kind : {"one key", "few"}) {
            auto items = list(kind, 1'200'000);
            const auto place = items.begin() + 600'000;
            QVERIFY(selectNth(items.begin(), place, items.end(), byKey, {}));
            for (auto i = items.begin(); i < place; ++i) QVERIFY(i->key <= place->key);
            for (auto i = place; i < items.end(); ++i) QVERIFY(place->key <= i->key);
        }
    }

    void aStopEndsBothSoon()
    {
        const std::size_t count = 3'000'000;
        for (const std::uint64_t at : {1ull, 1'000'000ull, 20'000'000ull, 45'000'000ull}) { // runs, then merges
            Workers workers(2);
            std::stop_source source;
            std::atomic<std::uint64_t> calls = 0;
            auto items = list("random", count);
            QVERIFY(!sortOn(workers, source.get_token(), items, Stopping{&source, &calls, at}));
            const std::uint64_t after = calls - at; // each thread may end its piece: 16384 values, 17 comparisons each
            QVERIFY2(after <= 2 * 16384 * 25, qPrintable(QString("%1 comparisons after %2").arg(after).arg(at)));
        }
        for (const std::uint64_t at : {1ull, 1'000'000ull}) {
            std::stop_source source;
            std::atomic<std::uint64_t> calls = 0;
            auto items = list("random", count);
            const auto place = items.begin() + 1'500'000;
            QVERIFY(!selectNth(items.begin(), place, items.end(), Stopping{&source, &calls, at}, source.get_token()));
            QVERIFY2(calls - at <= 1'000'000, qPrintable(QString("%1 comparisons later").arg(calls - at)));
        }
    }
};

QTEST_APPLESS_MAIN(OrderingTest)
#include "tst_ordering.moc"
