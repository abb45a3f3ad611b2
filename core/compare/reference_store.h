// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/render_view.h"
#include "core/compare/cache_folders.h"
#include "core/trace/reference.h"

namespace lightloom {

/// What a stored reference must be to be taken for one that would be traced now.
enum class ReferenceMatch {
    sameBits, ///< traced for the same job: bit for bit what tracing now would give
    asGood    ///< same scene, probes or camera, seed; at least as many paths, or errors as low as the target asks
};

/// A reference and where it came from.
template<class T>
struct Kept {
    T result;                   ///< not all of it after a stop: then kept to go on with
    bool wasStored = false;     ///< found whole: nothing was traced
    std::uint64_t resumed = 0;  ///< paths or camera rays that an earlier run had traced, of a result not found whole
    std::filesystem::path file; ///< where it is kept; empty: nowhere
};
using KeptReference = Kept<ReferenceResult>;
using KeptView = Kept<View>;

/// References of one scene's file, kept on disk (CacheFolders), so that comparing is quick the second time. An entry is
/// found by what it depends on (the scene's hash, instruction set, mix, probes or camera, seed), checked against a
/// SHA-256 and written whole or not at all; a damaged one is logged in one line and traced anew. A reference with fewer
/// paths is gone on with, not begun anew. What cannot be read or written costs a log line and time, never the result.
class ReferenceStore {
public:
    ReferenceStore() = default; ///< keeps and finds nothing: everything is traced
    /// With `resume` the runs that were stopped are gone on with; else they are begun anew.
    explicit ReferenceStore(const std::filesystem::path& sceneFile, LogSink log = {}, bool resume = true)
        : folders_(sceneFile, std::move(log)), resume_(resume)
    {
    }

    /// The reference for `points`: found, or traced now (`continueReference`) and kept, also where it was stopped.
    [[nodiscard]] KeptReference illuminance(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                            const std::vector<ProbePoint>& points, const ReferenceJob& job,
                                            ReferenceMatch match, Workers& workers, const std::stop_token& stop,
                                            const std::function<void(double fraction)>& progress = {}) const;

    /// The picture that `job` asks for, by paths (asserted).
    [[nodiscard]] KeptView picture(const RayScene& rays, const LightSampler& lights, const Mix& mix, const ViewJob& job,
                                   ReferenceMatch match, Workers& workers, const std::stop_token& stop,
                                   const std::function<void(double fraction)>& progress = {}) const;

    /// `picture` in its parts, for whoever traces in slices. What is kept of it: the picture if it was found whole,
    /// else a state to go on with (empty: from nothing).
    struct FoundView {
        KeptView kept;
        ViewState state;
    };
    [[nodiscard]] FoundView findPicture(const RayScene& rays, const Mix& mix, const ViewJob& job,
                                        ReferenceMatch match) const;
    /// Keeps what `state` holds of `job`, `view` being its picture: whole, or to go on with. Gives where; "": nowhere.
    std::filesystem::path keepPicture(const RayScene& rays, const Mix& mix, const ViewJob& job, const View& view,
                                      const ViewState& state) const;

    [[nodiscard]] const std::vector<std::filesystem::path>& folders() const { return folders_.list(); }

private:
    CacheFolders folders_;
    bool resume_ = true;
};

} // namespace lightloom
