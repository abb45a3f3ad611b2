// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/compare_desk.h"
#include "core/base/memory_use.h"
#include "widgets/compare_panel.h"
#include "widgets/legend_strip.h"
#include "widgets/viewport.h"
#include "widgets/wipe_handle.h"
#include <QAction>
#include <QSignalBlocker>

namespace lightloom {

namespace {

constexpr int kAskDelayMs = 400;         ///< without a change until a reference is begun
constexpr double kBytesPerPixel = 700.0; ///< sums, layers, discs of photons
constexpr double kShareOfMemory = 0.5;   ///< of the machine's; the bake and the window need some, too

QString captionOf(const ViewError& error)
{
    switch (error.kind) {
    case ErrorKind::absolute:
        return QObject::tr("|Error| of the indirect illuminance");
    case ErrorKind::difference:
        return QObject::tr("Error of the indirect light, of its mean\nblue: too dark, red: too bright");
    case ErrorKind::relative:
        break;
    }
    return QObject::tr("|Error| of the indirect light, of its mean");
}

/// The map shows the reference's noise rather than the bake's errors. While there is no telling of its noise it is
/// large.
bool isMostlyNoise(const ViewError& error)
{
    const double all = error.metrics.relRmse;
    return !(error.noise > 0.0) || 2.0 * error.noise * error.noise > all * all;
}

HeatmapStyle scaleOf(const ViewError& error)
{
    HeatmapStyle scale;
    scale.kind = error.kind;
    scale.top = error.top;
    scale.unit = error.kind == ErrorKind::absolute ? LegendUnit::lux : LegendUnit::percent;
    return scale;
}

} // namespace

CompareDesk::CompareDesk(const Parts& parts, QObject* parent) : QObject(parent), parts_(parts)
{
    delay_.setSingleShot(true);
    delay_.setInterval(kAskDelayMs);
    connect(&delay_, &QTimer::timeout, this, &CompareDesk::ask);
    connect(&worker_, &CompareWorker::shown, this, qOverload<const ReferencePicture&>(&CompareDesk::take),
            Qt::QueuedConnection);
    connect(&worker_, &CompareWorker::judged, this, qOverload<const ErrorPicture&>(&CompareDesk::take),
            Qt::QueuedConnection);
    connect(
        &worker_, &CompareWorker::judging, this,
        [this](std::uint64_t serial, double part) {
            if (serial != serial_) return;
            judgedPart_ = part;
            tellLegend();
        },
        Qt::QueuedConnection);
    connect(parts_.viewport, &Viewport::viewMoved, this, &CompareDesk::viewChanged);
    connect(parts_.panel, &ComparePanel::qualityEdited, this, &CompareDesk::viewChanged);
    connect(parts_.reference, &QAction::toggled, this, &CompareDesk::turn);
    connect(parts_.wipe, &QAction::toggled, this, [this](bool on) {
        parts_.viewport->setWipe(on ? std::optional(parts_.handle->part()) : std::nullopt);
        parts_.handle->setVisible(on);
        parts_.handle->raise();
        if (!on) return;
        parts_.handle->setFocus(); // so that the arrow keys move it
        if (!cutsShown_) wantReference();
    });
    connect(parts_.handle, &WipeHandle::moved, this, [this](float part) {
        if (parts_.wipe->isChecked()) parts_.viewport->setWipe(part);
    });
    tellNames();
}

void CompareDesk::setScene(const QString& file)
{
    file_ = file;
    view_ = {};
    worker_.judge({}, shown_.value_or(ErrorKind::relative));
    viewChanged();
}

void CompareDesk::setMix(const Mix& mix)
{
    if (mix == mix_) return;
    mix_ = mix;
    view_.snapshot.field.reset(); // under the old one; the same light under the new one will come
    worker_.judge({}, shown_.value_or(ErrorKind::relative));
    viewChanged();
}

void CompareDesk::lampsMoved()
{
    view_ = {};
    worker_.judge({}, shown_.value_or(ErrorKind::relative));
    viewChanged();
}

void CompareDesk::setView(const BakeView& view)
{
    const bool isFirst = !view_.rays && view.rays;
    const bool isOfOtherLamps = view_.rays && view.rays && view.rays != view_.rays;
    BakeView next = view;
    if (!next.rays) next.rays = view_.rays, next.lights = view_.lights; // an overtaken bake's picture brings none
    if (next.snapshot.field != view_.snapshot.field) forgetErrors();
    view_ = std::move(next);
    worker_.judge(view_, shown_.value_or(ErrorKind::relative));
    if (isOfOtherLamps) viewChanged(); // what was asked meanwhile was of a step of the drag
    if (isFirst && parts_.reference->isChecked()) delay_.start();
    tellNames();
}

void CompareDesk::setBaking(bool isBaking)
{
    isBaking_ = isBaking;
    worker_.setHeld(isBaking);
    tellState();
}

void CompareDesk::showErrors(std::optional<ErrorKind> kind)
{
    shown_ = kind;
    parts_.viewport->setErrorsShown(kind.has_value());
    if (kind && error_ && error_->kind != *kind) { // a map of another kind would pass for this one
        error_.reset();
        parts_.viewport->setErrors(nullptr);
    }
    if (kind) {
        worker_.judge(view_, *kind);
        wantReference();
    }
    tellLegend();
    tellNames();
}

void CompareDesk::modeChanged()
{
    if (parts_.viewport->mode() == ViewMode::reference) wantReference();
    tellLegend();
    tellNames();
}

/// Errors need the question, too: a picture that stayed when tracing was stopped comes back from disk.
void CompareDesk::wantReference()
{
    if (!picture_ || (shown_ && serial_ == 0)) parts_.reference->setChecked(true);
}

/// Errors of another bake must not stand beside this one's light.
void CompareDesk::forgetErrors()
{
    error_.reset();
    parts_.viewport->setErrors(nullptr);
    parts_.panel->forgetErrors();
    tellLegend();
}

/// What was computed is of another view: it goes at once, and a new one is asked for when things rest.
void CompareDesk::viewChanged()
{
    serial_ = 0;
    problem_.clear();
    picture_.reset();
    parts_.viewport->setReference(nullptr);
    forgetErrors();
    worker_.cancel();
    if (parts_.reference->isChecked()) delay_.start();
    tellState();
    tellNames();
}

void CompareDesk::turn(bool on)
{
    if (on) {
        ask();
    } else {
        delay_.stop();
        serial_ = 0; // what is there stays until the view changes
        worker_.cancel();
    }
    tellState();
}

void CompareDesk::ask()
{
    if (!view_.rays || !view_.lights || parts_.viewport->isEmpty()) return; // a first light will ask
    const glm::ivec2 size = glm::max(parts_.viewport->pixels() / parts_.panel->shrink(), glm::ivec2(1));
    const double bytes = kBytesPerPixel * size.x * size.y;
    problem_ =
        bytes <= kShareOfMemory * machineMemoryBytes()
            ? QString()
            : tr("A reference of this size needs %1 GiB; choose a smaller one").arg(bytes / (1 << 30), 0, 'f', 1);
    if (!problem_.isEmpty()) return tellState();
    ViewJob job;
    job.camera = parts_.viewport->camera().camera();
    job.width = size.x;
    job.height = size.y;
    job.indirect = ViewJob::Indirect::paths;
    job.samples = parts_.panel->samples();
    CompareQuestion question{view_.rays, view_.lights, mix_, std::move(job),
                             std::filesystem::path(file_.toStdString())};
    serial_ = worker_.ask(std::move(question));
    tellState();
}

bool CompareDesk::isTracing() const
{
    const bool isDone = picture_ && !picture_->isRough && picture_->view->isWhole;
    return parts_.reference->isChecked() && problem_.isEmpty() && !isDone;
}

void CompareDesk::tellState()
{
    if (isTracing() != wasTracing_) Q_EMIT tracing(wasTracing_ = !wasTracing_);
    if (!parts_.reference->isChecked()) {
        parts_.panel->showState(picture_ ? tr("Stopped; the picture stays until the view changes") : tr("Off"));
    } else if (!problem_.isEmpty()) {
        parts_.panel->showState(problem_);
    } else if (isBaking_) {
        parts_.panel->showState(tr("Waits for the bake"));
    } else if (picture_) {
        parts_.panel->show(*picture_);
    } else {
        parts_.panel->showState(tr("Begins when the view rests"));
    }
    tellLegend();
}

void CompareDesk::tellLegend()
{
    const bool isReference = parts_.viewport->mode() == ViewMode::reference;
    const ViewMode mode = parts_.viewport->mode();
    const bool isMade = mode == ViewMode::photonMap || mode == ViewMode::lightcuts;
    const bool isNoteAlone = !note_.isEmpty() && !shown_ && !isReference && !isMade;
    parts_.legend->setVisible(shown_ || isReference || isMade || isNoteAlone);
    if (isNoteAlone) return parts_.legend->show(noteScale_, note_);
    if (isMade && !shown_) {
        const bool isMarked = !note_.isEmpty() && !pictureScale_;
        parts_.legend->show(isMarked ? noteScale_ : pictureScale_,
                            isMarked ? tr("%1\n%2").arg(note_, pictureState_) : pictureState_);
    } else if (shown_ && error_) {
        QString caption = captionOf(*error_);
        if (errorBlock_ > 1) {
            caption += tr("\nin blocks of %1 pixels so far").arg(errorBlock_);
            if (judgedPart_ > 0.0) caption += tr(", next %1 %").arg(100.0 * judgedPart_, 0, 'f', 0);
        }
        if (isMostlyNoise(*error_)) caption += tr("\nmostly noise of the reference so far");
        parts_.legend->show(scaleOf(*error_), caption);
    } else if (shown_ || !picture_) {
        parts_.legend->show({}, tr("Light of the bake meanwhile. Reference: %1").arg(parts_.panel->stateText()));
    } else {
        parts_.legend->show({}, tr("Reference: %1").arg(parts_.panel->stateText()));
    }
}

void CompareDesk::showNote(const QString& text, const std::optional<HeatmapStyle>& scale)
{
    note_ = text;
    noteScale_ = scale;
    tellLegend();
}

void CompareDesk::showPictureState(const QString& text, const std::optional<HeatmapStyle>& scale)
{
    pictureState_ = text;
    pictureScale_ = scale;
    tellLegend();
}

void CompareDesk::showCuts(bool on)
{
    cutsShown_ = on;
    if (!on && parts_.wipe->isChecked()) wantReference();
    tellNames();
}

void CompareDesk::take(const ReferencePicture& picture)
{
    if (picture.serial != serial_) return;
    picture_ = picture;
    parts_.viewport->setReference(picture.view);
    tellState();
    tellNames();
    Q_EMIT referenceShown();
}

void CompareDesk::take(const ErrorPicture& picture)
{
    const bool isOther =
        picture.error && ((shown_ && picture.error->kind != *shown_) || picture.snapshot.field != view_.snapshot.field);
    if (picture.serial != serial_ || isOther) return;
    if (picture.isGivenUp) {
        problem_ = picture.problem;
        tellState();
    }
    error_ = picture.error;
    errorBlock_ = picture.block;
    judgedPart_ = 0.0;
    parts_.viewport->setErrors(error_);
    parts_.panel->show(picture, fullName(view_));
    tellLegend();
    Q_EMIT errorsShown();
}

void CompareDesk::tellNames()
{
    QString left = cutsShown_ ? tr("Cut sizes") : shown_ ? tr("Error") : tr("Reference");
    if (cutsShown_) {
        // known as soon as there is a picture
    } else if (!picture_) {
        left += tr(": not yet");
    } else if (!shown_ && picture_->noise >= 0.0) {
        left += tr(", noise %1 %").arg(100.0 * picture_->noise, 0, 'f', 1);
    }
    const ViewMode mode = parts_.viewport->mode();
    QString right = fullName(view_);
    if (mode == ViewMode::atlas) right = tr("Atlas of %1").arg(right);
    if (mode == ViewMode::colours) right = tr("Colours of %1").arg(right);
    if (mode == ViewMode::photonMap) right = tr("Photon map");
    if (mode == ViewMode::direct) right = tr("Direct light");
    if (mode == ViewMode::plain) right = tr("Plain");
    parts_.handle->setNames(left, right);
}

} // namespace lightloom
