// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

namespace lightloom {

enum class LogLevel { debug, info, warning, error };

/// Where one-line events go. Core prints nothing: whoever calls passes a sink, or none.
using LogSink = std::function<void(LogLevel, const std::string&)>;

inline void log(const LogSink& sink, LogLevel level, const std::string& line)
{
    if (sink) sink(level, line);
}

} // namespace lightloom
