// SPDX-License-Identifier: Apache-2.0
#include "core/compare/live_compare.h"
#include <algorithm>
#include <cassert>

namespace lightloom {
namespace {

constexpr int kRoughly = 4;          ///< a rough picture is smaller by this, each way
constexpr int kRoughSamples = 16;    ///< at most; time ends it sooner
constexpr int kFieldSamples = 8;     ///< two even sets: edges are as smooth as they show
constexpr int kBlocks[] = {2, 4, 8}; ///< of a costly field's rough pictures, the last one first
constexpr double kFirstSlice = 0.25, kLastSlice = 2.0,
                 kGrows = 0.1;         ///< seconds; a slice may take a tenth of all before
constexpr int kBeforeCostly = 16;      ///< rays per pixel: before that a costly field's errors are lost in noise
constexpr double kWorthKeeping = 10.0; ///< seconds

ReferenceStore storeBeside(const std::filesystem::path& scene)
{
    return scene.empty() ? ReferenceStore() : ReferenceStore(scene);
}

} // namespace

LiveCompare::LiveCompare(CompareQuestion question)
    : question_(std::move(question)), store_(storeBeside(question_.sceneFile))
{
    ReferenceStore::FoundView found =
        store_.findPicture(*question_.rays, question_.mix, question_.job, ReferenceMatch::asGood);
    if (found.kept.wasStored) {
        reference_ = std::make_shared<const View>(std::move(found.kept.result));
        wasStored_ = true;
        return;
    }
    fine_.emplace(question_.rays, question_.lights, question_.mix, nullptr, question_.job, std::move(found.state));
}

bool LiveCompare::showRough(Workers& workers, const std::stop_token& stop)
{
    ViewJob small = question_.job;
    small.width = std::max(1, small.width / kRoughly);
    small.height = std::max(1, small.height / kRoughly);
    small.samples = kRoughSamples;
    ProgressiveView rough(question_.rays, question_.lights, question_.mix, nullptr, small);
    View view = rough.advance(kFirstSlice, workers, stop);
    if (stop.stop_requested()) return false;
    reference_ = std::make_shared<const View>(std::move(view));
    isRough_ = true;
    return true;
}

bool LiveCompare::advanceReference(Workers& workers, const std::stop_token& stop)
{
    if (isWhole()) return true;
    if (!reference_ && fine_->state().pixels.empty()) return showRough(workers, stop);
    const double seconds = std::clamp(kGrows * fine_->seconds(), kFirstSlice, kLastSlice);
    View view = fine_->advance(seconds, workers, stop);
    seconds_ = fine_->seconds();
    if (view.samples == 0 || (stop.stop_requested() && !view.isWhole)) return false;
    reference_ = std::make_shared<const View>(std::move(view));
    isRough_ = false;
    if (reference_->isWhole) {
        store_.keepPicture(*question_.rays, question_.mix, question_.job, *reference_, fine_->state());
        fine_.reset(); // a hundred bytes a pixel
    }
    return true;
}

void LiveCompare::keepPart() const
{
    if (isWhole() || !fine_ || fine_->seconds() < kWorthKeeping) return;
    View part; // only whether it is whole counts
    store_.keepPicture(*question_.rays, question_.mix, question_.job, part, fine_->state());
}

void LiveCompare::setField(std::shared_ptr<const IndirectField> field)
{
    fields_.clear();
    judged_.reset();
    isCostly_ = field && field->isCostly();
    if (!field) return;
    ViewJob job = question_.job;
    job.indirect = ViewJob::Indirect::field;
    job.samples = kFieldSamples;
    job.withDirect = false;
    const auto add = [&] { fields_.emplace_back(question_.rays, question_.lights, question_.mix, field, job); };
    add();
    if (!isCostly_) return;
    job.samples = 1;
    for (const int block : kBlocks) {
        job.block = block;
        add();
    }
}

bool LiveCompare::wantsField() const
{
    if (!reference_ || isRough_ || fields_.empty() || fields_.front().isWhole()) return false;
    // its last picture takes a minute, which the reference would stand still
    const bool isDear = fields_.size() == 1 && isCostly_;
    return !isDear || isWhole() || reference_->samples >= kBeforeCostly;
}

bool LiveCompare::advanceField(Workers& workers, const std::stop_token& stop, const std::function<void(double)>& told)
{
    assert(!fields_.empty());
    if (reflectance_.pixels.empty()) {
        reflectance_ = mattReflectance(*question_.rays, fields_.front().job(), workers, stop);
        if (reflectance_.pixels.empty()) return false;
    }
    ProgressiveView& making = fields_.back();
    View view = making.advance(kFirstSlice, workers, stop, [&](double part) {
        if (told) told(std::min(1.0, part * making.job().samples)); // shown after one camera ray per pixel
    });
    if (view.samples == 0 || (stop.stop_requested() && !view.isWhole)) return false;
    judged_ = std::make_shared<const View>(std::move(view));
    block_ = making.job().block;
    if (fields_.size() > 1) fields_.pop_back();
    return true;
}

std::optional<Result<ViewError>> LiveCompare::error(ErrorKind kind) const
{
    if (!judged_ || !reference_ || isRough_) return {};
    return viewError(*judged_, *reference_, kind, reflectance_);
}

} // namespace lightloom
