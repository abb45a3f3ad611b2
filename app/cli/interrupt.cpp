// SPDX-License-Identifier: Apache-2.0
#include "app/cli/interrupt.h"
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <unistd.h>

namespace lightloom::cli {
namespace {

int pipeEnds[2] = {-1, -1}; // a signal handler sees nothing but globals
constexpr char kStop = 's', kQuit = 'q';

extern "C" void onInterrupt(int)
{
    const int saved = errno;
    static_cast<void>(!::write(pipeEnds[1], &kStop, 1));
    errno = saved;
}

} // namespace

Interrupt::Interrupt()
{
    if (::pipe2(pipeEnds, O_CLOEXEC) != 0) return; // no descriptors left: Ctrl-C then kills, as without us
    watcher_ = std::jthread([this] {
        char what = 0;
        while (true) {
            const ssize_t got = ::read(pipeEnds[0], &what, 1);
            if (got < 0 && errno == EINTR) continue;
            if (got != 1 || what == kQuit) return;
            source_.request_stop();
        }
    });
    struct sigaction action {};
    action.sa_handler = onInterrupt;
    action.sa_flags = SA_RESTART | SA_RESETHAND; // RESETHAND: the second one meets the default and kills
    ::sigaction(SIGINT, &action, nullptr);
}

Interrupt::~Interrupt()
{
    if (!watcher_.joinable()) return;
    struct sigaction action {};
    action.sa_handler = SIG_DFL;
    ::sigaction(SIGINT, &action, nullptr);
    static_cast<void>(!::write(pipeEnds[1], &kQuit, 1));
    watcher_.join();
    ::close(pipeEnds[0]);
    ::close(pipeEnds[1]);
}

} // namespace lightloom::cli
