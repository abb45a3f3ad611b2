// SPDX-License-Identifier: Apache-2.0
#include "app/cli/progress.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/ioctl.h>
#include <unistd.h>

namespace lightloom::cli {
namespace {

constexpr std::array<std::string_view, 4> kLevelNames{"debug", "info", "warning", "error"};
Reporter* current = nullptr; // there is one stderr
constexpr auto kBarPeriod = std::chrono::milliseconds(100), kJsonPeriod = std::chrono::milliseconds(200);

bool isTerminal() { return isatty(STDERR_FILENO) == 1; }

std::size_t terminalWidth()
{
    winsize size{};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return known ? size.ws_col : 80;
}

void write(std::string_view text)
{
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

std::string duration(double seconds)
{
    if (seconds < 0 || !std::isfinite(seconds)) return "";
    const auto whole = static_cast<long>(std::min(seconds + 0.5, 1e7));
    if (whole < 60) return fmt::format("{} s left", whole);
    if (whole < 3600) return fmt::format("{}:{:02} min left", whole / 60, whole % 60);
    return fmt::format("{}:{:02} h left", whole / 3600, whole / 60 % 60);
}

ProgressStyle resolved(const Reporter::Options& options)
{
    if (options.quiet) return ProgressStyle::none;
    if (options.progress != ProgressStyle::automatic) return options.progress;
    return isTerminal() ? ProgressStyle::bar : ProgressStyle::none;
}

} // namespace

std::string oneLine(std::string text)
{
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
    return text;
}

bool stderrTakesColour()
{
    const char* no = std::getenv("NO_COLOR");
    const char* term = std::getenv("TERM");
    return isTerminal() && !(no && *no) && !(term && std::string_view(term) == "dumb");
}

Reporter::Reporter(Options options) : options_(options), colour_(stderrTakesColour())
{
    options_.progress = resolved(options);
    current = this;
}

Reporter::~Reporter()
{
    wipe();
    current = nullptr;
}

void logLine(LogLevel level, const std::string& line)
{
    if (current) {
        current->log(level, line);
        return;
    }
    write(fmt::format("{}: {}\n", kLevelNames[static_cast<std::size_t>(level)], oneLine(line)));
}

void Reporter::log(LogLevel level, const std::string& line)
{
    if (level < options_.least || (options_.quiet && level < LogLevel::error)) return;
    const std::string_view name = kLevelNames[static_cast<std::size_t>(level)];
    std::string text = oneLine(line);
    std::lock_guard lock(mutex_);
    wipeLocked();
    if (options_.progress == ProgressStyle::json) {
        // names in scene files need not be UTF-8: what is not becomes a replacement character
        const nlohmann::json json{{"log", name}, {"text", text}};
        text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    } else if (level >= LogLevel::warning) {
        const char* paint = level == LogLevel::error ? "\x1b[31m" : "\x1b[33m";
        text = colour_ ? fmt::format("{}{}:\x1b[0m {}", paint, name, text) : fmt::format("{}: {}", name, text);
    }
    write(text + "\n");
}

void Reporter::progress(std::string_view stage, double fraction, double remainingSeconds)
{
    if (options_.progress == ProgressStyle::none || !(fraction >= 0.0)) return;
    fraction = std::min(fraction, 1.0);
    std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    const auto period = options_.progress == ProgressStyle::bar ? kBarPeriod : kJsonPeriod;
    const bool isLast = fraction >= 1.0 && told_ < 1.0;
    if (!isLast && now - last_ < period) return;
    last_ = now;
    told_ = fraction;
    if (remainingSeconds < 0) remainingSeconds = remaining(fraction);
    if (options_.progress == ProgressStyle::bar) {
        drawBar(stage, fraction, remainingSeconds);
        return;
    }
    nlohmann::json json{{"progress", fraction}, {"stage", stage}};
    if (remainingSeconds >= 0) json["remaining_seconds"] = remainingSeconds;
    write(json.dump() + "\n");
}

double Reporter::remaining(double fraction) const
{
    const std::chrono::duration<double> elapsed = Clock::now() - began_;
    // the first moments say little about the rest
    if (fraction <= 0.02 || elapsed.count() < 0.5) return -1;
    return elapsed.count() * (1.0 - fraction) / fraction;
}

void Reporter::drawBar(std::string_view stage, double fraction, double remainingSeconds)
{
    const std::size_t width = terminalWidth();
    const std::string tail =
        fmt::format(" {:3.0f} % {:<10} {}", std::floor(100.0 * fraction), stage, duration(remainingSeconds));
    std::string line;
    if (width > tail.size() + 14) {
        const std::size_t cells = std::min<std::size_t>(width - tail.size() - 4, 40);
        const auto full = static_cast<std::size_t>(fraction * static_cast<double>(cells));
        line = '[' + std::string(full, '#') + std::string(cells - full, '.') + ']';
    }
    line += tail;
    if (line.size() > width - 1) line.resize(width - 1); // a full line would scroll
    // blanks, not an erase code: the bar also works where escapes do not
    const std::size_t leftover = barLength_ > line.size() ? barLength_ - line.size() : 0;
    write('\r' + line + std::string(leftover, ' '));
    barLength_ = line.size() + leftover;
}

void Reporter::wipeLocked()
{
    if (barLength_ == 0) return;
    write('\r' + std::string(barLength_, ' ') + '\r');
    barLength_ = 0;
}

void Reporter::wipe()
{
    std::lock_guard lock(mutex_);
    wipeLocked();
}

} // namespace lightloom::cli
