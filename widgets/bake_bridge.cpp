// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/bake_bridge.h"
#include "core/bake/solver_for.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/trace/photon_segments.h"
#include "core/voxel/voxel_advice.h"
#include "widgets/background.h"
#include <algorithm>
#include <thread>

namespace lightloom {

namespace {

constexpr std::uint64_t kNoisePoints = 1000; ///< as many as the command line asks, the same ones

std::shared_ptr<const std::vector<SurfacePoint>> noisePointsOf(const SceneProducts& scene, BakeProducts& products)
{
    using Points = std::vector<SurfacePoint>;
    if (auto kept = products.find<Points>(scene.sceneKey)) return kept;
    auto points =
        std::make_shared<const Points>(samplePoints(*scene.rays, *scene.lights, *scene.reach, kNoisePoints, 1));
    products.keep(scene.sceneKey, points);
    return points;
}

/// The photon map of a bake that is under way; null if it is not all there.
std::shared_ptr<const PhotonMapField> photonsOf(const BakeJob& job, const SceneProducts& scene, BakeProducts& products)
{
    const std::optional<PhotonProducts> kept = keptPhotons(job, scene, products);
    if (!kept) return nullptr;
    return photonMapField(job.params, job.scene->bounds, kept->area, kept->maps, job.mix);
}

QStringList adviceOn(const BakeView& view, const Scene& scene)
{
    QStringList lines;
    const auto* field = dynamic_cast<const VoxelField*>(view.snapshot.field.get());
    if (!field) return lines;
    const VoxelAdvice advice =
        voxelAdvice(*view.rays, *view.reach, *view.noisePoints, *field, view.params.voxelDirections);
    for (const std::string& line : adviceLines(advice, scene)) lines += QString::fromStdString(line);
    return lines;
}

/// A lamp's photons that a grid's snapshot was made from; 0: no grid.
std::uint64_t photonsBehind(const Snapshot& snapshot, const WorkCounters& counters)
{
    if (!snapshot.field || snapshot.field->method() != "irradiance-grid") return 0;
    if (!snapshot.isRough) return counters.photonsPerGroup;
    return std::min(counters.photonsPerGroup, kSegmentBlock << snapshot.level); // IvgSolver: after 2^level blocks
}

} // namespace

/// Each job by the method that it was posted for, all on the same products.
class BakeBridge::Solvers final : public Solver {
public:
    explicit Solvers(BakeBridge& bridge) : bridge_(bridge) {}
    Result<Done> bake(const BakeJob& job, BakeProducts& products, BakeControl& control) override
    {
        return solverFor(bridge_.methodOf(job.serial))->bake(job, products, control);
    }

private:
    BakeBridge& bridge_;
};

BakeBridge::BakeBridge(QObject* parent) : QObject(parent)
{
    std::thread starter([this] { // bake threads inherit its priority; the UI thread's must stay as it is
        lowerPriority(kBakeNice);
        workers_ = std::make_unique<Workers>();
        session_ = std::make_unique<BakeSession>(
            *workers_, std::make_unique<Solvers>(*this),
            BakeSession::Sinks{[this](Snapshot snapshot) { publish(std::move(snapshot)); },
                               [this](Progress progress) { Q_EMIT progressed(progress); },
                               [this](std::uint64_t serial, const Result<Done>& outcome) {
                                   const bool isCancelled = !outcome && outcome.error().kind == Error::Kind::cancelled;
                                   const QString error = outcome || isCancelled
                                                             ? QString()
                                                             : QString::fromStdString(outcome.error().message);
                                   Q_EMIT finished(serial, error, isCancelled, session_->products().counters);
                               }});
    });
    starter.join();
}

BakeBridge::~BakeBridge() { session_->end(); } // while the session and the signals that it uses exist

std::uint64_t BakeBridge::start(Method method, BakeJob job, bool urgent)
{
    std::lock_guard lock(mutex_); // the worker must not publish before the serial's scene is known
    job_ = job;
    serial_ = session_->post(std::move(job), urgent);
    methods_[serial_] = method;
    return serial_;
}

Method BakeBridge::methodOf(std::uint64_t serial)
{
    std::lock_guard lock(mutex_); // `start` has noted it by then
    methods_.erase(methods_.begin(), methods_.find(serial));
    return methods_.at(serial);
}

void BakeBridge::cancel() { session_->cancel(); }
void BakeBridge::setPaused(bool paused) { session_->setPaused(paused); }

void BakeBridge::setLook(Look look)
{
    std::lock_guard lock(mutex_);
    look_ = std::move(look);
}

void BakeBridge::publish(Snapshot snapshot)
{
    BakeView view;
    view.snapshot = std::move(snapshot);
    Look look;
    BakeJob job;
    {
        std::lock_guard lock(mutex_);
        look = look_;
        if (serial_ == view.snapshot.serial) job = job_;
    }
    view.photonsPerLamp = photonsBehind(view.snapshot, session_->products().counters);
    view.cpuSeconds = allCpuSeconds(session_->products().counters.stages);
    // the solver made these for the same scene, so that this only finds them; a newer job will publish its own
    view.params = job.params;
    if (job.scene) {
        BakeControl control(*workers_, {});
        const ReachWanted reach = view.snapshot.isRough ? ReachWanted::quick : ReachWanted::exact;
        const Result<SceneProducts> found = sceneProducts(job, session_->products(), control, reach);
        if (found) {
            view.rays = found->rays;
            view.lights = found->lights;
            view.reach = found->reach;
            // a rough picture must not wait, and says nothing of the bake's noise
            if (!view.snapshot.isRough) {
                view.noisePoints = noisePointsOf(*found, session_->products());
                view.photons = photonsOf(job, *found, session_->products());
                view.advice = adviceOn(view, *job.scene);
            }
        }
    }
    Q_EMIT shown(withLook(std::move(view), look));
}

} // namespace lightloom
