// SPDX-License-Identifier: Apache-2.0
#include "core/base/atomic_file.h"
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lightloom {
namespace fs = std::filesystem;

namespace {

Error ioError(const fs::path& path, const char* doing, int code)
{
    const auto kind = code == ENOENT ? Error::Kind::notFound : Error::Kind::io;
    return {kind, fmt::format("cannot {} {}: {}", doing, path.string(), std::strerror(code))};
}

/// Owns a file descriptor; `close` may fail (a full disk over NFS says so only then), so it is called by hand.
class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor()
    {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    [[nodiscard]] int get() const { return fd_; }
    int close() { return ::close(std::exchange(fd_, -1)); }

private:
    int fd_;
};

/// Removes the temporary file unless it has been renamed.
struct TemporaryFile {
    fs::path path;
    bool kept = false;
    ~TemporaryFile()
    {
        if (!kept) ::unlink(path.c_str());
    }
};

int writeAll(int fd, const std::uint8_t* bytes, std::size_t count)
{
    constexpr std::size_t kChunk = 64 * 1024; // a short write then tells of a full disk early
    while (count > 0) {
        const ssize_t wrote = ::write(fd, bytes, std::min(count, kChunk));
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote < 0) return errno;
        if (wrote == 0) return ENOSPC;
        bytes += wrote;
        count -= static_cast<std::size_t>(wrote);
    }
    return 0;
}

} // namespace

Result<Done> writeFile(const fs::path& asked, std::span<const std::uint8_t> bytes)
{
    // through a link the target is replaced, not the link
    std::error_code ignored;
    const fs::path resolved = fs::is_symlink(asked, ignored) ? fs::weakly_canonical(asked, ignored) : asked;
    const fs::path path = resolved.empty() ? asked : resolved;
    if (fs::is_directory(path, ignored)) return ioError(path, "write", EISDIR);

    std::string pattern = path.string() + ".XXXXXX";
    Descriptor file(::mkostemp(pattern.data(), O_CLOEXEC));
    if (file.get() < 0) return ioError(path, "write", errno);
    TemporaryFile temporary{pattern};

    struct stat old {};
    mode_t mode = 0;
    if (::stat(path.c_str(), &old) == 0) {
        mode = old.st_mode & 0777u;
    } else {
        const mode_t mask = ::umask(0);
        ::umask(mask);
        mode = 0666u & ~mask;
    }
    if (::fchmod(file.get(), mode) != 0) return ioError(path, "write", errno);
    if (const int code = writeAll(file.get(), bytes.data(), bytes.size())) return ioError(path, "write", code);
    if (::fsync(file.get()) != 0 || file.close() != 0) return ioError(path, "write", errno);
    if (::rename(pattern.c_str(), path.c_str()) != 0) return ioError(path, "write", errno);
    temporary.kept = true;

    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    const Descriptor folderFile(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (folderFile.get() >= 0) ::fsync(folderFile.get()); // some file systems cannot; the file itself is safe
    return Done{};
}

Result<Done> writeFile(const fs::path& path, std::string_view text)
{
    return writeFile(path, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

Result<std::vector<std::uint8_t>> readFile(const fs::path& path, std::uint64_t mostBytes)
{
    // O_NONBLOCK: opening a pipe nobody writes to would wait for ever
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.get() < 0) return ioError(path, "read", errno);
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) return ioError(path, "read", errno);
    if (!S_ISREG(status.st_mode)) {
        return Error{Error::Kind::badInput, fmt::format("cannot read {}: it is not a regular file", path.string())};
    }
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size > mostBytes) {
        return Error{Error::Kind::badInput,
                     fmt::format("{} has {} bytes; at most {} are read", path.string(), size, mostBytes)};
    }
    std::vector<std::uint8_t> bytes(size);
    std::size_t have = 0;
    while (have < bytes.size()) {
        const ssize_t got = ::read(file.get(), bytes.data() + have, bytes.size() - have);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return ioError(path, "read", errno);
        if (got == 0) break;
        have += static_cast<std::size_t>(got);
    }
    bytes.resize(have);
    return bytes;
}

} // namespace lightloom
