// SPDX-License-Identifier: Apache-2.0
#include "core/compare/judge.h"
#include "core/base/statistics.h"
#include "core/base/units.h"
#include <algorithm>
#include <cassert>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

/// Fills what follows from points, reference and standard errors.
Result<Judge> finished(Judge judge)
{
    if (judge.points.empty()) return Error{Error::Kind::badInput, "the reference holds no points"};
    if (const Result<Done> fine = checkFinite(judge.reference, "reference"); !fine) return fine.error();
    double sum = 0, squares = 0;
    for (const double r : judge.reference) sum += r;
    for (const double s : judge.standardError) squares += s * s;
    const auto n = static_cast<double>(judge.points.size());
    judge.mean = sum / n;
    if (!(judge.mean > 0.0)) {
        return Error{
            Error::Kind::badInput,
            fmt::format("the reference's mean is {} lx: a relative error has no meaning without indirect light",
                        judge.mean)};
    }
    judge.noise = std::sqrt(squares / n) / judge.mean;
    Sha256 sha;
    for (const ProbePoint& p : judge.points) {
        for (const glm::vec3 v : {p.position, p.normal}) sha.add(v.x).add(v.y).add(v.z);
    }
    sha.add(judge.reference);
    judge.digest = toHex(sha.finish());
    return judge;
}

} // namespace

std::vector<ProbeRow> probeRows(const SceneProducts& at, std::uint64_t count, std::uint64_t seed)
{
    std::vector<ProbeRow> rows;
    for (const SurfacePoint& point : samplePoints(*at.rays, *at.lights, *at.reach, count, seed)) {
        rows.push_back({at.rays->scene().toFile(point.position), glm::dvec3(point.normal)});
    }
    return rows;
}

Result<Judge> judgeFrom(const ProbeTable& table, const Scene& scene)
{
    if (table.points.size() != table.indirect.size()) {
        return Error{Error::Kind::badInput, "the table does not tell where its points are (x,y,z,nx,ny,nz)"};
    }
    Judge judge;
    for (const ProbeRow& row : table.points) judge.points.push_back(inScene(scene, row));
    judge.reference = luminances(table.indirect);
    // the table's errors are of direct + indirect: at least those of the indirect part
    judge.standardError = luminances(table.standardError);
    judge.standardError.resize(judge.reference.size(), 0.0);
    return finished(std::move(judge));
}

Result<Judge> traceJudge(const SceneProducts& at, const std::vector<ProbeRow>& rows, const ReferenceJob& job,
                         const ReferenceStore& store, Workers& workers, const std::stop_token& stop,
                         const std::function<void(double)>& progress, const Mix& mix)
{
    Judge judge;
    for (const ProbeRow& row : rows) judge.points.push_back(inScene(at.rays->scene(), row));
    const KeptReference kept = store.illuminance(*at.rays, *at.lights, mix, judge.points, job, ReferenceMatch::asGood,
                                                 workers, stop, progress);
    if (kept.result.finished < judge.points.size()) {
        return Error{Error::Kind::cancelled, "interrupted before the reference was done"};
    }
    for (const ProbeLight& light : kept.result.probes) {
        judge.reference.push_back(static_cast<double>(luminance(light.indirect)));
        judge.standardError.push_back(static_cast<double>(luminance(light.indirectError)));
    }
    return finished(std::move(judge));
}

SplitSquares splitSquares(std::span<const double> e1, std::span<const double> e2, const Judge& judge)
{
    assert(e1.size() == judge.reference.size() && e2.size() == judge.reference.size());
    RunningMean noise, shared;
    double variance = 0;
    const double scale = 1.0 / (judge.mean * judge.mean);
    for (std::size_t i = 0; i < e1.size(); ++i) {
        const double r = judge.reference[i], s2 = judge.standardError[i] * judge.standardError[i];
        const double half = 0.5 * (e1[i] - e2[i]) * (e1[i] - e2[i]), product = (e1[i] - r) * (e2[i] - r) - s2;
        noise.add(scale * half);
        shared.add(scale * product);
        // of (b + n1 - r) (b + n2 - r) - s^2 with noises n of variance v and the reference's r of variance s^2, which
        // both factors share: 2 b^2 (v + 2 s^2) + v^2 + 2 v s^2 + 2 s^4; `half` is v, its square three times v^2
        const double b2 = std::max(0.0, product);
        variance += scale * scale * (2.0 * b2 * (half + 2.0 * s2) + half * half / 3.0 + 2.0 * s2 * (half + s2));
    }
    const auto n = static_cast<double>(std::max<std::size_t>(e1.size(), 1));
    return {{noise.mean(), noise.standardError()}, {shared.mean(), std::sqrt(variance) / n}, shared.standardError()};
}

ErrorSplit splitError(std::span<const double> e1, std::span<const double> e2, const Judge& judge)
{
    const SplitSquares squares = splitSquares(e1, e2, judge);
    return {std::sqrt(squares.noise.value), std::sqrt(std::max(0.0, squares.systematic.value))};
}

} // namespace lightloom
