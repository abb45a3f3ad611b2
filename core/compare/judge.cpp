// SPDX-License-Identifier: Apache-2.0
#include "core/compare/judge.h"
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
                         const std::function<void(double)>& progress)
{
    Judge judge;
    for (const ProbeRow& row : rows) judge.points.push_back(inScene(at.rays->scene(), row));
    const KeptReference kept =
        store.illuminance(*at.rays, *at.lights, {}, judge.points, job, ReferenceMatch::asGood, workers, stop, progress);
    if (kept.result.finished < judge.points.size()) {
        return Error{Error::Kind::cancelled, "interrupted before the reference was done"};
    }
    for (const ProbeLight& light : kept.result.probes) {
        judge.reference.push_back(static_cast<double>(luminance(light.indirect)));
        judge.standardError.push_back(static_cast<double>(luminance(light.indirectError)));
    }
    return finished(std::move(judge));
}

ErrorSplit splitError(std::span<const double> e1, std::span<const double> e2, const Judge& judge)
{
    assert(e1.size() == judge.reference.size() && e2.size() == judge.reference.size());
    double differences = 0, products = 0;
    for (std::size_t i = 0; i < e1.size(); ++i) {
        const double r = judge.reference[i];
        differences += (e1[i] - e2[i]) * (e1[i] - e2[i]);
        products += (e1[i] - r) * (e2[i] - r);
    }
    const double scale = 1.0 / (static_cast<double>(e1.size()) * judge.mean * judge.mean);
    const double shared = scale * products - judge.noise * judge.noise;
    return {std::sqrt(0.5 * scale * differences), std::sqrt(std::max(0.0, shared))};
}

} // namespace lightloom
