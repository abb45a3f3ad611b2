// SPDX-License-Identifier: Apache-2.0
// Claim: the default length of paths cuts off less than a thousandth of the light, at the highest albedo that scenes
// may have. At 64 bounces a closed room of albedo .98 lost more than a quarter.
#include "core/params/bake_params.h"
#include "core/scene/analytic_scenes.h"
#include "core/trace/photon_tracer.h"
#include "tests/light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

class PathDepthTest : public QObject {
    Q_OBJECT

    /// Share of the light that ended because its path was long enough.
    static double cutOff(float rho, int depth)
    {
        const LitScene lit(furnaceBox(rho));
        Workers workers;
        const PhotonJob job{0, 1, 40'000, depth};
        const auto paths = tracePhotons(*lit.rays, *lit.lights, job, workers, {});
        return paths->ledger.terminated.x / paths->ledger.emitted.x;
    }

private Q_SLOTS:
    void theDefaultLosesLittle()
    {
        for (const float rho : {0.8f, 0.98f, kLargestAlbedo}) {
            const double cut = cutOff(rho, BakeParams{}.pathDepth);
            QVERIFY2(cut <= 1e-3, qPrintable(QString("albedo %1: %2").arg(double(rho)).arg(cut)));
        }
    }

    void aShortOneLosesWhatItShould() // rho^(depth - 1) is still under way
    {
        for (const int depth : {64, 128}) {
            const double share = std::pow(0.98, depth - 1), found = cutOff(0.98f, depth);
            const double error = std::sqrt(share * (1.0 - share) / 40'000);
            QVERIFY2(std::abs(found - share) <= 4.9 * error, qPrintable(QString("%1 of %2").arg(found).arg(share)));
        }
    }
};

QTEST_APPLESS_MAIN(PathDepthTest)
#include "tst_path_depth.moc"
