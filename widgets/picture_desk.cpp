// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/picture_desk.h"
#include "core/compare/legend.h"
#include "widgets/viewport.h"
#include <cmath>

namespace lightloom {

namespace {

constexpr int kAskDelayMs = 150; ///< without a change until a picture is begun
constexpr int kSamples = 16;     ///< camera rays per pixel

} // namespace

PictureDesk::PictureDesk(Viewport* viewport, QObject* parent) : QObject(parent), viewport_(viewport)
{
    delay_.setSingleShot(true);
    delay_.setInterval(kAskDelayMs);
    connect(&delay_, &QTimer::timeout, this, &PictureDesk::ask);
    connect(&worker_, &PictureWorker::shown, this, &PictureDesk::take, Qt::QueuedConnection);
    connect(
        &worker_, &PictureWorker::workedOn, this,
        [this](std::uint64_t serial, double part) {
            if (serial != serial_) return;
            part_ = part;
            Q_EMIT stateChanged();
        },
        Qt::QueuedConnection);
    connect(viewport_, &Viewport::viewMoved, this, &PictureDesk::viewChanged);
}

bool PictureDesk::isOfVoxels() const { return viewport_->mode() == ViewMode::lightcuts; }

bool PictureDesk::isWanted() const
{
    return viewport_->mode() == ViewMode::photonMap || (isOfVoxels() && show_.lookup != VoxelLookup::field);
}

bool PictureDesk::isDone() const
{
    if (!isWanted() || !picture_.problem.isEmpty()) return true;
    const bool isFull = picture_.view && picture_.block == 1 && picture_.view->direct.width == viewport_->pixels().x;
    return isFull && picture_.view->isWhole;
}

std::shared_ptr<const VoxelField> PictureDesk::voxels() const
{
    return std::dynamic_pointer_cast<const VoxelField>(view_.snapshot.field);
}

void PictureDesk::forget()
{
    view_ = {};
    field_.reset();
    worker_.cancel();
    viewChanged();
}

void PictureDesk::setView(const BakeView& view)
{
    if (view.photons == view_.photons && view.snapshot.field == view_.snapshot.field) return;
    view_ = view;
    field_.reset();
    viewChanged();
}

void PictureDesk::setShow(const VoxelShow& show)
{
    if (show == show_) return;
    show_ = show;
    if (!isOfVoxels()) return;
    field_.reset();
    worker_.cancel();
    viewChanged();
    Q_EMIT fieldChanged(); // until there is a picture it is the voxels' own light again
}

void PictureDesk::setBaking(bool isBaking)
{
    isBaking_ = isBaking;
    hold();
    Q_EMIT stateChanged();
}

void PictureDesk::coverChanged() { hold(); }

/// Errors are judged from the same field, so that it is made first.
void PictureDesk::hold()
{
    const bool isCovered = viewport_->showsErrors() && !viewport_->wipe();
    worker_.setHeld(isBaking_ || (isCovered && field_));
}

void PictureDesk::modeChanged()
{
    if (serial_ != 0 && isAskedOfVoxels_ != isOfVoxels()) {
        field_.reset();
        viewChanged();
    } else if (isWanted() && serial_ == 0) {
        ask();
    } else if (!isWanted() && serial_ != 0 && !picture_.view) {
        serial_ = 0; // nobody looks: it need not go on
        worker_.cancel();
    }
}

/// What there is shows another view: it goes at once, and a new one is asked for when things rest.
void PictureDesk::viewChanged()
{
    serial_ = 0;
    picture_ = {};
    part_ = 0.0;
    viewport_->setMadePicture(nullptr);
    viewport_->setCuts(nullptr);
    hold();
    if (isWanted()) delay_.start();
    Q_EMIT stateChanged();
}

void PictureDesk::ask()
{
    const bool isThere = isOfVoxels() ? voxels() != nullptr : view_.photons != nullptr;
    if (!isWanted() || !isThere || !view_.rays || !view_.lights || viewport_->isEmpty()) return;
    const glm::ivec2 size = viewport_->pixels();
    ViewJob job;
    job.camera = viewport_->camera().camera();
    job.width = size.x;
    job.height = size.y;
    job.indirect = ViewJob::Indirect::field;
    job.samples = kSamples;
    isAskedOfVoxels_ = isOfVoxels();
    PictureQuestion question{nullptr, nullptr, show_, view_.rays, view_.lights, std::move(job)};
    if (isAskedOfVoxels_)
        question.voxels = voxels();
    else
        question.photons = view_.photons;
    serial_ = worker_.ask(std::move(question));
    Q_EMIT stateChanged();
}

void PictureDesk::take(const MadePicture& picture)
{
    if (picture.serial != serial_) return;
    picture_ = picture;
    if (picture.view) viewport_->setMadePicture(picture.view);
    viewport_->setCuts(picture.cuts);
    Q_EMIT stateChanged();
    if (!picture.field || picture.field == field_) return;
    field_ = picture.field;
    hold();
    Q_EMIT fieldChanged();
}

void PictureDesk::showCuts(bool on)
{
    if (on == cutsShown_) return;
    cutsShown_ = on;
    viewport_->setCutsShown(on);
    Q_EMIT stateChanged();
}

std::optional<HeatmapStyle> PictureDesk::cutScale() const
{
    if (!cutsShown_ || !hasCuts() || !picture_.cuts) return {};
    HeatmapStyle scale;
    scale.kind = ErrorKind::absolute;
    scale.top = picture_.cuts->top();
    scale.unit = LegendUnit::plain;
    return scale;
}

QString PictureDesk::stateText() const { return isOfVoxels() ? voxelText() : photonText(); }

QString PictureDesk::voxelText() const
{
    if (show_.lookup == VoxelLookup::field) return tr("Voxel field: each voxel's light, interpolated");
    const QString name = show_.lookup == VoxelLookup::samples ? tr("Sample voxels") : tr("Lightcuts");
    if (!voxels()) return tr("%1: waits for the bake").arg(name);
    if (isBaking_ && !picture_.view) return tr("%1: the voxel field until the bake is done").arg(name);
    if (!picture_.problem.isEmpty()) return tr("%1: %2").arg(name, picture_.problem);
    if (serial_ == 0) return tr("%1: the voxel field until the view rests").arg(name);
    if (!picture_.view) return tr("%1: the first blocks of pixels").arg(name);
    if (cutsShown_ && picture_.cuts) return cutText();
    if (picture_.block > 1) return tr("%1: %2").arg(name, blockText());
    return tr("%1: %2 of %3 rays per pixel").arg(name).arg(picture_.view->samples).arg(kSamples);
}

QString PictureDesk::cutText() const
{
    const QString text = tr("Clusters in a cut: mean %L1, in 99 % of pixels up to %L2, most %L3")
                             .arg(std::lround(picture_.cuts->mean))
                             .arg(picture_.cuts->p99)
                             .arg(picture_.cuts->most);
    return picture_.block > 1 ? tr("%1\n%2").arg(text, blockText()) : text;
}

QString PictureDesk::blockText() const
{
    const QString text = tr("in blocks of %1 pixels").arg(picture_.block);
    return part_ > 0.0 ? tr("%1, next %2 %").arg(text).arg(100.0 * part_, 0, 'f', 0) : text;
}

QString PictureDesk::photonText() const
{
    if (!view_.photons) return tr("Photon map: waits for photons");
    if (isBaking_ && !picture_.view) return tr("Photon map: waits for the bake");
    if (!picture_.problem.isEmpty()) return tr("Photon map: %1").arg(picture_.problem);
    if (serial_ == 0) return tr("Photon map: begins when the view rests");
    if (!picture_.view) return tr("Photon map: Christensen's cache %1 %").arg(100.0 * picture_.filled, 0, 'f', 0);
    std::uint64_t points = 0;
    const auto& map = dynamic_cast<const PhotonMapField&>(*picture_.field);
    for (const auto& layer : map.layers()) points += layer.cache ? layer.cache->values().lux.size() : 0;
    return tr("Photon map: nearest of %L1 kept, %2 of %3 rays per pixel")
        .arg(points)
        .arg(picture_.view->samples)
        .arg(kSamples);
}

} // namespace lightloom
