// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stop_token>
#include <thread>

namespace lightloom::cli {

/// Ctrl-C asks for a clean stop; a second one ends the program at once, as if nothing had caught it. One object per
/// program. The handler only writes to a pipe: `request_stop` itself takes locks and must not run inside a signal.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;
    [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

private:
    std::stop_source source_;
    std::jthread watcher_;
};

} // namespace lightloom::cli
