// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/atlas_desk.h"
#include "widgets/background.h"
#include "widgets/viewport.h"

namespace lightloom {

namespace {

constexpr int kTexels = 1024; ///< a side

Result<std::shared_ptr<const AtlasDraw>> unwrap(const RayScene& rays, const LightSampler& lights,
                                                const std::stop_token& stop)
try {
    lowerPriority(kCompareNice);
    Workers workers;
    const FlushDenormals flush;
    const auto reach = LightReach::find(rays, lights, workers, stop);
    if (!reach) return Error{Error::Kind::cancelled, "unwrapping was cancelled"};
    AtlasOptions options;
    options.size = kTexels;
    const Result<std::shared_ptr<const Atlas>> atlas = makeAtlas(rays, *reach, options, workers, stop);
    if (!atlas) return atlas.error();
    return makeAtlasDraw(rays, **atlas);
} catch (const std::bad_alloc&) {
    return Error{Error::Kind::outOfMemory, "not enough memory to unwrap the scene"};
}

QString lineAbout(const AtlasReport& report)
{
    return AtlasDesk::tr("Atlas: %1 charts, %2 texels per metre, %3 % used, mean stretch %4")
        .arg(report.charts)
        .arg(report.texelsPerMetre, 0, 'g', 3)
        .arg(100.0 * report.utilisation, 0, 'f', 0)
        .arg(report.stretch.meanAnisotropy(), 0, 'f', 2);
}

} // namespace

AtlasDesk::AtlasDesk(Viewport* viewport, QObject* parent) : QObject(parent), viewport_(viewport)
{
    pool_.setMaxThreadCount(1);
}

AtlasDesk::~AtlasDesk()
{
    stop_.request_stop();
    pool_.waitForDone();
}

void AtlasDesk::forget()
{
    stop_.request_stop();
    ++serial_;
    rays_.reset();
    reach_.reset();
    isAsked_ = false;
    viewport_->setAtlas(nullptr);
}

void AtlasDesk::setView(const BakeView& view)
{
    // what light reaches is known roughly only with a first picture, and an atlas takes longer than that anyway
    if (!view.rays || view.reach == reach_ || view.snapshot.isRough) return;
    if (reach_) forget(); // a lamp shines where none did
    reach_ = view.reach;
    rays_ = view.rays;
    lights_ = view.lights;
    modeChanged();
}

void AtlasDesk::modeChanged()
{
    if (viewport_->mode() == ViewMode::atlas && rays_ && lights_ && !isAsked_) ask();
}

void AtlasDesk::ask()
{
    isAsked_ = true;
    Q_EMIT began();
    stop_ = std::stop_source();
    const std::uint64_t serial = ++serial_;
    pool_.start([this, serial, rays = rays_, lights = lights_, stop = stop_.get_token()] {
        const Result<std::shared_ptr<const AtlasDraw>> done = unwrap(*rays, *lights, stop);
        QMetaObject::invokeMethod(
            this,
            [this, serial, done] {
                if (serial != serial_) return; // of the scene before
                if (!done) {
                    if (done.error().kind != Error::Kind::cancelled) {
                        Q_EMIT failed(QString::fromStdString(done.error().message));
                    }
                    return;
                }
                viewport_->setAtlas(*done);
                Q_EMIT made(lineAbout((*done)->report));
            },
            Qt::QueuedConnection);
    });
}

} // namespace lightloom
