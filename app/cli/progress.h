// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "app/cli/commands.h"
#include "core/field/bake_control.h"
#include <chrono>
#include <mutex>

namespace lightloom::cli {

/// Everything that goes to stderr while a command runs: log lines and progress (a bar on a terminal, JSON lines for
/// programs, or nothing). A bar is wiped before anything else is written. Any thread may call. One per program.
class Reporter {
public:
    struct Options {
        ProgressStyle progress = ProgressStyle::automatic; ///< automatic: a bar if stderr is a terminal, else nothing
        LogLevel least = LogLevel::info;
        bool quiet = false; ///< errors only, no progress
    };
    explicit Reporter(Options options);
    ~Reporter(); ///< wipes the bar
    Reporter(const Reporter&) = delete;
    Reporter& operator=(const Reporter&) = delete;

    /// One line: control characters become spaces. JSON style: {"log":"warning","text":"..."}.
    void log(LogLevel level, const std::string& line);
    /// `fraction` of the whole command, 0 to 1; `remainingSeconds` negative: estimated here from the time so far.
    /// JSON style: {"progress":0.25,"stage":"fit","remaining_seconds":3.1}.
    void progress(std::string_view stage, double fraction, double remainingSeconds = -1);
    /// What BakeControl tells.
    void progress(const Progress& p) { progress(stageName(p.stage), p.fraction, p.remainingSeconds); }
    void wipe();

private:
    using Clock = std::chrono::steady_clock;
    [[nodiscard]] double remaining(double fraction) const;
    void drawBar(std::string_view stage, double fraction, double remainingSeconds);
    void wipeLocked();

    Options options_;
    bool colour_;
    std::mutex mutex_;
    Clock::time_point began_ = Clock::now(), last_{};
    std::size_t barLength_ = 0; // characters of the bar on screen; 0: none
    double told_ = -1;
};

/// Through the program's Reporter, or plainly to stderr where there is none (yet, or any more).
void logLine(LogLevel level, const std::string& line);

/// Text fit for one terminal line: control characters (line ends, escapes) become spaces.
[[nodiscard]] std::string oneLine(std::string text);

/// True if stderr is a terminal that may be coloured (NO_COLOR unset, TERM not dumb).
[[nodiscard]] bool stderrTakesColour();

} // namespace lightloom::cli
