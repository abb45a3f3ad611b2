// SPDX-License-Identifier: GPL-3.0-or-later
// What the viewport lays over the picture: the reference, errors in false colour.
#include "widgets/viewport.h"

namespace lightloom {

void Viewport::setReference(std::shared_ptr<const View> picture)
{
    if (picture == reference_) return;
    const Overlay before = overlay();
    reference_ = std::move(picture);
    referenceIsNew_ = true;
    overlayChanged(before);
}

void Viewport::setMadePicture(std::shared_ptr<const View> picture)
{
    if (picture == made_) return;
    const bool before = showsMade();
    made_ = std::move(picture);
    madeIsNew_ = true;
    if (showsMade() != before) {
        news();
    } else if (before) {
        present();
    }
}

void Viewport::setErrors(std::shared_ptr<const ViewError> errors)
{
    if (errors == errors_) return;
    const Overlay before = overlay();
    errors_ = std::move(errors);
    mapIsNew_ = true;
    overlayChanged(before);
}

void Viewport::overlayChanged(Overlay before)
{
    if (overlay() != before) {
        news(); // other things show now
    } else if (before != Overlay::none) {
        present();
    }
}

void Viewport::present()
{
    presentOnly_ = sample_ > 0;
    update();
}

void Viewport::setErrorsShown(bool shown)
{
    errorsShown_ = shown;
    mapIsNew_ = true;
    changed();
}

void Viewport::setCuts(std::shared_ptr<const CutMap> cuts)
{
    if (cuts == cuts_) return;
    const Overlay before = overlay();
    cuts_ = std::move(cuts);
    mapIsNew_ |= cutsShown_;
    if (cutsShown_) overlayChanged(before);
}

void Viewport::setCutsShown(bool shown)
{
    if (shown == cutsShown_) return;
    cutsShown_ = shown;
    mapIsNew_ = true;
    changed();
}

void Viewport::setWipe(std::optional<float> part)
{
    if (part == wipe_) return;
    const bool isMove = part && wipe_; // only the edge does, and what is summed up under it stays
    wipe_ = part;
    if (isMove) {
        present();
    } else {
        changed();
    }
}

Overlay Viewport::overlay() const
{
    if (cutsShown_) return cuts_ && showsMade() ? Overlay::map : Overlay::none;
    if (errorsShown_) return errors_ ? Overlay::map : Overlay::none;
    const bool isWanted = mode_ == ViewMode::reference || wipe_;
    return isWanted && reference_ ? Overlay::picture : Overlay::none;
}

FrameView Viewport::frameNow() const
{
    FrameView frame = frame_;
    frame.eye = camera_.eye();
    frame.view = camera_.view();
    frame.projection = camera_.projection(aspect());
    frame.overlay = overlay();
    frame.wipe = wipe_.value_or(1.0f);
    frame.mode = mode_ == ViewMode::reference ? ViewMode::octree : mode_;
    frame.showsMade = showsMade();
    // covered all over: only where there are surfaces is still asked, and that is quickest so
    if (frame.showsMade || (frame.overlay != Overlay::none && !wipe_)) frame.mode = ViewMode::plain;
    return frame;
}

void Viewport::uploadComparison()
{
    if (referenceIsNew_) {
        renderer_->overlay().setPicture(!reference_           ? FloatImage()
                                        : frame_.indirectOnly ? reference_->indirect
                                                              : wholeView(*reference_));
    }
    if (madeIsNew_) {
        renderer_->overlay().setMade(!made_ ? FloatImage() : frame_.indirectOnly ? made_->indirect : wholeView(*made_));
    }
    if (mapIsNew_ && cutsShown_ && cuts_) {
        renderer_->overlay().setMap(cuts_->sizes, cuts_->top(), false);
    } else if (mapIsNew_) {
        const ViewError errors = errors_ ? *errors_ : ViewError();
        renderer_->overlay().setMap(errors.map, errors.top, errors.kind == ErrorKind::difference);
    }
    referenceIsNew_ = madeIsNew_ = mapIsNew_ = false;
}

glm::ivec2 Viewport::pixels() const
{
    const float ratio = static_cast<float>(devicePixelRatioF());
    return glm::max(glm::ivec2(glm::vec2(width(), height()) * ratio + 0.5f), glm::ivec2(1));
}

} // namespace lightloom
