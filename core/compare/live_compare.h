// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/progressive_view.h"
#include "core/compare/reference_store.h"
#include "core/compare/view_error.h"
#include <filesystem>
#include <optional>

namespace lightloom {

/// A picture to be path traced: camera and size, and the lamps' mix.
struct CompareQuestion {
    std::shared_ptr<const RayScene> rays;
    std::shared_ptr<const LightSampler> lights;
    Mix mix;
    ViewJob job;                     ///< by paths, without a target
    std::filesystem::path sceneFile; ///< its references are kept beside it; empty: nowhere
};

/// A reference picture that grows while one looks, and how far a bake is off it. Works a slice at a time, for whoever
/// has other things to do in between. What is found whole on disk is not traced again; what is done is kept. One thread
/// at a time.
class LiveCompare {
public:
    /// Looks on disk: up to some hundred milliseconds for a large picture.
    explicit LiveCompare(CompareQuestion question);

    /// Goes on with the reference for a quarter of a second, more when it is fine already: first a rough picture of a
    /// quarter of the width, then the whole one. Nothing to do once it is whole. False: stopped, nothing new to show.
    bool advanceReference(Workers& workers, const std::stop_token& stop);
    [[nodiscard]] bool isWhole() const { return reference_ && !isRough_ && reference_->isWhole; }
    [[nodiscard]] bool wasStored() const { return wasStored_; }
    [[nodiscard]] double seconds() const { return seconds_; } ///< spent in this run
    /// The newest picture, never changed afterwards. Null: none yet. Of a quarter of the size while `isRough`.
    [[nodiscard]] const std::shared_ptr<const View>& reference() const { return reference_; }
    [[nodiscard]] bool isRough() const { return isRough_; }
    /// A picture that was begun is kept on disk if it took long enough to be worth it; a whole one is kept anyway.
    void keepPart() const;

    /// Judges `field` (under its own mix) from now on; null: nothing. A costly one first in blocks of pixels that get
    /// smaller, so that errors show within seconds.
    void setField(std::shared_ptr<const IndirectField> field);
    /// The field's picture still has to be made (finer); it waits for a reference, a costly one's last picture for 16
    /// camera rays per pixel of it.
    [[nodiscard]] bool wantsField() const;
    [[nodiscard]] int block() const { return block_; } ///< ViewJob::block of the picture that is judged
    /// A slice of the field's picture. False: stopped. `told` hears often, from any thread, which part is done of what
    /// is shown next: that of a costly field's picture without blocks takes a minute.
    bool advanceField(Workers& workers, const std::stop_token& stop, const std::function<void(double part)>& told = {});
    /// Nothing while there are no pictures of both. Error: as `viewError`.
    [[nodiscard]] std::optional<Result<ViewError>> error(ErrorKind kind) const;

private:
    bool showRough(Workers& workers, const std::stop_token& stop);

    CompareQuestion question_;
    ReferenceStore store_;
    std::optional<ProgressiveView> fine_;
    std::vector<ProgressiveView> fields_; ///< pictures of the field that are still to be made, the finest first
    std::shared_ptr<const View> reference_, judged_;
    FloatImage reflectance_;
    double seconds_ = 0;
    int block_ = 1;
    bool isRough_ = false, wasStored_ = false, isCostly_ = false;
};

} // namespace lightloom
