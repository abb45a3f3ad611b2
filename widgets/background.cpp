// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/background.h"
#ifdef __linux__
#include <sys/resource.h>
#include <unistd.h>
#endif

namespace lightloom {

void lowerPriority([[maybe_unused]] int nice)
{
#ifdef __linux__
    // here a thread has its own nice value and hands it on to threads it starts
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), nice);
#endif
}

} // namespace lightloom
