// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/photon_desk.h"
#include "widgets/viewport.h"

namespace lightloom {

namespace {

constexpr int kAskDelayMs = 150; ///< without a change until a picture is begun
constexpr int kSamples = 16;     ///< camera rays per pixel

} // namespace

PhotonDesk::PhotonDesk(Viewport* viewport, QObject* parent) : QObject(parent), viewport_(viewport)
{
    delay_.setSingleShot(true);
    delay_.setInterval(kAskDelayMs);
    connect(&delay_, &QTimer::timeout, this, &PhotonDesk::ask);
    connect(&worker_, &PhotonWorker::shown, this, &PhotonDesk::take, Qt::QueuedConnection);
    connect(viewport_, &Viewport::viewMoved, this, &PhotonDesk::viewChanged);
}

bool PhotonDesk::isWanted() const { return viewport_->mode() == ViewMode::photonMap; }

void PhotonDesk::forget()
{
    view_ = {};
    field_.reset();
    worker_.cancel();
    viewChanged();
}

void PhotonDesk::setView(const BakeView& view)
{
    if (view.photons == view_.photons) return;
    view_ = view;
    field_.reset();
    viewChanged();
}

void PhotonDesk::setBaking(bool isBaking)
{
    isBaking_ = isBaking;
    worker_.setHeld(isBaking);
    Q_EMIT stateChanged();
}

void PhotonDesk::modeChanged()
{
    if (isWanted() && serial_ == 0) {
        ask();
    } else if (!isWanted() && serial_ != 0 && !picture_.view) {
        serial_ = 0; // nobody looks: it need not go on
        worker_.cancel();
    }
}

/// What there is shows another view: it goes at once, and a new one is asked for when things rest.
void PhotonDesk::viewChanged()
{
    serial_ = 0;
    picture_ = {};
    viewport_->setPhotonPicture(nullptr);
    if (isWanted()) delay_.start();
    Q_EMIT stateChanged();
}

void PhotonDesk::ask()
{
    if (!isWanted() || !view_.photons || !view_.rays || !view_.lights || viewport_->isEmpty()) return;
    const glm::ivec2 size = viewport_->pixels();
    ViewJob job;
    job.camera = viewport_->camera().camera();
    job.width = size.x;
    job.height = size.y;
    job.indirect = ViewJob::Indirect::field;
    job.samples = kSamples;
    serial_ = worker_.ask({view_.photons, view_.rays, view_.lights, std::move(job)});
    Q_EMIT stateChanged();
}

void PhotonDesk::take(const PhotonPicture& picture)
{
    if (picture.serial != serial_) return;
    picture_ = picture;
    if (picture.view) viewport_->setPhotonPicture(picture.view);
    Q_EMIT stateChanged();
    if (!picture.field || picture.field == field_) return;
    field_ = picture.field;
    Q_EMIT fieldChanged();
}

QString PhotonDesk::stateText() const
{
    if (!view_.photons) return tr("Photon map: waits for photons");
    if (isBaking_ && !picture_.view) return tr("Photon map: waits for the bake");
    if (!picture_.problem.isEmpty()) return tr("Photon map: %1").arg(picture_.problem);
    if (serial_ == 0) return tr("Photon map: begins when the view rests");
    if (!picture_.view) return tr("Photon map: Christensen's cache %1 %").arg(100.0 * picture_.filled, 0, 'f', 0);
    std::uint64_t points = 0;
    for (const auto& layer : picture_.field->layers()) points += layer.cache ? layer.cache->values().lux.size() : 0;
    return tr("Photon map: nearest of %L1 kept, %2 of %3 rays per pixel")
        .arg(points)
        .arg(picture_.view->samples)
        .arg(kSamples);
}

} // namespace lightloom
