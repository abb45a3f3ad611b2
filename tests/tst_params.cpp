// SPDX-License-Identifier: Apache-2.0
// Claim: parameters are described once. Every member of BakeParams stands in kParams, text survives a round trip, and
// what does not fit is refused with a line that names key, value and range.
#include "core/params/param_text.h"
#include <QtTest>
#include <set>

using namespace lightloom;

class ParamsTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void tableCoversTheStruct()
    {
        // Setting every table entry to another value must change every byte that differs between two structs: the
        // number of members is counted by aggregate size, so a member without an entry shows as unchanged bytes.
        std::size_t bytes = 0;
        for (const ParamSpec& spec : kParams) {
            bytes += std::visit([](auto member) { return sizeof(std::declval<BakeParams&>().*member); }, spec.field);
        }
        const std::size_t padding = sizeof(BakeParams) - bytes;
        QVERIFY2(bytes <= sizeof(BakeParams) && padding < alignof(BakeParams),
                 qPrintable(QString("table %1 bytes, struct %2").arg(bytes).arg(sizeof(BakeParams))));
    }

    void keysAreUniqueAndDescribed()
    {
        std::set<std::string_view> keys;
        for (const ParamSpec& spec : kParams) {
            QVERIFY2(keys.insert(spec.key).second, spec.key.data());
            QVERIFY(!spec.label.empty() && spec.help.size() > 20 && spec.methods != 0);
            const double value = paramValue({}, spec);
            QVERIFY2(value >= spec.least && value <= spec.most, spec.key.data());
            if (spec.isChoice()) QCOMPARE(spec.most, static_cast<double>(spec.choices.size() - 1));
        }
    }

    void textRoundTrip()
    {
        for (const ParamSpec& spec : kParams) {
            for (const double value : {spec.least, spec.most, paramValue({}, spec)}) {
                const Result<BakeParams> set = with({}, spec.key, value);
                QVERIFY2(static_cast<bool>(set), spec.key.data());
                const Result<BakeParams> again = withText({}, spec.key, paramText(*set, spec));
                QVERIFY2(static_cast<bool>(again), paramText(*set, spec).c_str());
                QVERIFY2(*again == *set, spec.key.data());
            }
        }
    }

    void wrongValuesAreRefused_data()
    {
        QTest::addColumn<QString>("assignment");
        QTest::addColumn<QString>("mention");
        QTest::newRow("too big") << "vdl.count=9"
                                 << "1 to 8";
        QTest::newRow("fraction of a whole") << "vdl.count=2.5"
                                             << "2.5";
        QTest::newRow("nan") << "gather.radius=nan"
                             << "nan";
        QTest::newRow("text") << "photons=many"
                              << "many";
        QTest::newRow("trailing") << "photons=10x"
                                  << "10x";
        QTest::newRow("no key") << "photon=1"
                                << "there is no parameter";
        QTest::newRow("no equals") << "photons"
                                   << "NAME=VALUE";
        QTest::newRow("choice") << "vdl.form=printed"
                                << "corrected, paper";
        QTest::newRow("empty") << "photons="
                               << "photons";
    }
    void wrongValuesAreRefused()
    {
        QFETCH(QString, assignment);
        QFETCH(QString, mention);
        const Result<BakeParams> result = withAssignment({}, assignment.toStdString());
        QVERIFY(!result);
        QVERIFY2(QString::fromStdString(result.error().message).contains(mention), result.error().message.c_str());
    }

    void stagesTellWhatToRedo()
    {
        BakeParams a, b;
        QVERIFY(!firstDifference(a, b, Method::lightOctree));
        b.vdlCount = 7;
        QCOMPARE(*firstDifference(a, b, Method::lightOctree), Stage::fit);
        QVERIFY(!firstDifference(a, b, Method::reference));
        b.photonCount += 1;
        QCOMPARE(*firstDifference(a, b, Method::lightOctree), Stage::shoot);
        QVERIFY(stageKey(a, Stage::shoot, Method::lightOctree) != stageKey(b, Stage::shoot, Method::lightOctree));
        b.photonCount = a.photonCount;
        QCOMPARE(stageKey(a, Stage::shoot, Method::lightOctree), stageKey(b, Stage::shoot, Method::lightOctree));
    }

    void presetsAreValid()
    {
        for (std::size_t m = 0; m < kMethodNames.size(); ++m) {
            const auto method = static_cast<Method>(m);
            for (const std::string_view name : kPresetNames) {
                const Result<BakeParams> params = preset(name, method);
                QVERIFY(static_cast<bool>(params) && static_cast<bool>(checkTogether(*params)));
            }
            QVERIFY(!preset("best", method));
            QVERIFY(*preset("preview", method) == defaultParams(method));
        }
        QVERIFY(defaultParams(Method::lightOctree) == BakeParams{});
    }

    void theBoxIsOfUseWithAFinerGridAlone()
    {
        BakeParams params;
        const auto isUsed = [&](const char* key) { return isOfUse(params, *findParam(key)); };
        QVERIFY(isUsed("grid.nest") && !isUsed("grid.nest.fine") && !isUsed("grid.nest.low.x"));
        params.gridNest = GridNest::automatic;
        QVERIFY(isUsed("grid.nest.fine") && !isUsed("grid.nest.high.z"));
        params.gridNest = GridNest::box;
        QVERIFY(isUsed("grid.nest.fine") && isUsed("grid.nest.low.x") && isUsed("grid.nest.high.z"));
    }

    void presetsFollowTheMethod()
    {
        QVERIFY(defaultParams(Method::irradianceGrid).photonCount > defaultParams(Method::lightOctree).photonCount);
        for (const Method from : {Method::lightOctree, Method::irradianceGrid, Method::photonMap}) {
            for (const Method to : {Method::lightOctree, Method::irradianceGrid}) {
                for (const std::string_view name : kPresetNames) {
                    const BakeParams was = *preset(name, from), becomes = *preset(name, to);
                    QVERIFY2(paramsFor(was, from, to) == becomes, name.data());
                    BakeParams edited = was, wanted = becomes;
                    edited.gridShift = wanted.gridShift = 0.5f; // what was edited stays, the rest follows
                    edited.gatherCount = wanted.gatherCount = 77;
                    QVERIFY2(paramsFor(edited, from, to) == wanted, name.data());
                    edited.photonCount = wanted.photonCount = 123'456;
                    QVERIFY2(paramsFor(edited, from, to) == wanted, name.data());
                }
            }
        }
    }
};

QTEST_APPLESS_MAIN(ParamsTest)
#include "tst_params.moc"
