// SPDX-License-Identifier: Apache-2.0
#include "app/cli/commands.h"
#include "app/cli/progress.h"
#include <filesystem>
#include <fmt/format.h>

namespace lightloom::cli {

int fail(const Error& error)
{
    logLine(LogLevel::error, error.message);
    switch (error.kind) {
    case Error::Kind::badInput:
    case Error::Kind::notFound:
    case Error::Kind::unsupported:
        return kBadInput;
    case Error::Kind::outOfMemory:
        return kWouldNotFit;
    case Error::Kind::cancelled:
        return kInterrupted;
    case Error::Kind::io:
        break;
    }
    return kFailed;
}

int failWriting(const Error& error)
{
    logLine(LogLevel::error, error.message);
    return error.kind == Error::Kind::outOfMemory ? kWouldNotFit : kFailed;
}

Result<Done> checkOutput(const std::string& output)
{
    namespace fs = std::filesystem;
    const fs::path path(output);
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) {
        return Error{Error::Kind::io, fmt::format("cannot write {}: it is a folder", output)};
    }
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, ignored)) {
        return Error{Error::Kind::io, fmt::format("cannot write {}: there is no folder {}", output, folder.string())};
    }
    return Done{};
}

} // namespace lightloom::cli
