// SPDX-License-Identifier: Apache-2.0
#include "core/base/memory_use.h"
#include <cstdio>
#include <memory>
#include <unistd.h>

namespace lightloom {
namespace {

struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Closer>;

} // namespace

bool resetPeakMemory()
{
    const File file(std::fopen("/proc/self/clear_refs", "w"));
    return file && std::fputs("5", file.get()) >= 0 && std::fflush(file.get()) == 0;
}

std::uint64_t peakMemoryBytes()
{
    const File file(std::fopen("/proc/self/status", "r"));
    char line[256];
    unsigned long long kib = 0;
    while (file && std::fgets(line, sizeof line, file.get())) {
        if (std::sscanf(line, "VmHWM: %llu kB", &kib) == 1) return kib * 1024;
    }
    return 0;
}

double machineMemoryBytes()
{
    return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

} // namespace lightloom
