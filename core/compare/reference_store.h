// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/log.h"
#include "core/trace/reference.h"
#include <filesystem>

namespace lightloom {

/// What a stored reference must be to be taken for one that would be traced now.
enum class ReferenceMatch {
    sameBits, ///< traced for the same job: bit for bit what tracing now would give
    asGood    ///< same scene, probes, seed; at least as many paths at every probe, or errors as low as the target asks
};

/// A reference and where it came from.
struct KeptReference {
    ReferenceResult result;     ///< `result.finished` below the number of probes: stopped, and kept to go on with
    bool wasStored = false;     ///< found whole: nothing was traced
    std::uint64_t resumed = 0;  ///< paths that an earlier run had traced, not counting what was found whole
    std::filesystem::path file; ///< where it is kept; empty: nowhere
};

/// References of one scene's file, kept on disk, so that comparing is quick the second time. They lie in
/// `<scene file>.lightloom-cache/` beside the scene, or where that cannot be written in the user's cache folder
/// ($XDG_CACHE_HOME/lightloom or ~/.cache/lightloom). An entry is found by what it depends on (the scene's hash,
/// instruction set, mix, probes, seed), checked against a SHA-256 and written whole or not at all; a damaged one is
/// logged in one line and traced anew. A reference with fewer paths is gone on with, not begun anew. Beyond 1 GiB a
/// folder loses its oldest entries. What cannot be read or written costs a log line and time, never the result. Any
/// number of stores and programs may share a folder.
class ReferenceStore {
public:
    ReferenceStore() = default; ///< keeps and finds nothing: everything is traced
    /// With `resume` the runs that were stopped are gone on with; else they are begun anew.
    explicit ReferenceStore(const std::filesystem::path& sceneFile, LogSink log = {}, bool resume = true);

    /// The reference for `points`: found, or traced now (`continueReference`) and kept, also where it was stopped.
    [[nodiscard]] KeptReference illuminance(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                            const std::vector<ProbePoint>& points, const ReferenceJob& job,
                                            ReferenceMatch match, Workers& workers, const std::stop_token& stop,
                                            const std::function<void(double fraction)>& progress = {}) const;

    /// Where entries are looked for, best first; new ones go to the first that can be written.
    [[nodiscard]] const std::vector<std::filesystem::path>& folders() const { return folders_; }

private:
    template<class Visit>
    void forEntries(const std::string& prefix, const Visit& visit) const;
    [[nodiscard]] std::filesystem::path keep(const std::filesystem::path& name,
                                             std::span<const std::uint8_t> bytes) const;

    std::vector<std::filesystem::path> folders_;
    LogSink log_;
    bool resume_ = true;
};

} // namespace lightloom
