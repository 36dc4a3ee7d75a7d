#include "engine/base/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

std::atomic<bool> interrupt_requested{false};

void on_signal(int signal_number) {
  if (interrupt_requested.exchange(true)) _exit(128 + signal_number);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

bool interrupted() noexcept { return interrupt_requested.load(std::memory_order_relaxed); }

void clear_interrupt() noexcept { interrupt_requested = false; }

void throw_if_interrupted() {
  if (interrupted())
    throw Error(ExitCode::interrupted, "interrupted", "run the same command again");
}

}  // namespace touchtrace
