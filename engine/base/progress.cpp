#include "engine/base/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <utility>

#include "engine/base/interrupt.h"

namespace touchtrace {
namespace {

constexpr double terminal_period_s = 0.2, file_period_s = 10.0;
std::atomic<bool> silent{false};

std::string clock_text(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::max(0.0, seconds) + 0.5);
  return fmt::format("{}:{:02d}", whole / 60, whole % 60);
}

}  // namespace

Progress::Progress(std::string task, std::uint64_t total)
    : task_(std::move(task)),
      total_(total),
      start_(std::chrono::steady_clock::now()),
      terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (printed_ && terminal_) std::fputc('\n', stderr);
}

void Progress::report(const std::string& line) {
  if (!silent) fmt::print(stderr, "{}\n", line);
}

void Progress::warn(const std::string& text) { fmt::print(stderr, "warning: {}\n", text); }

void Progress::silence() { silent = true; }

double Progress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::advance(std::uint64_t count, const std::string& note) {
  throw_if_interrupted();
  const std::lock_guard lock(mutex_);
  done_ += count;
  total_ = std::max(total_, done_);  // if there are more steps than announced
  const double now_s = seconds();
  if (silent || now_s < next_print_s_) return;
  print(now_s, note);
  next_print_s_ = now_s + (terminal_ ? terminal_period_s : file_period_s);
}

void Progress::print(double now_s, const std::string& note) {
  const double fraction = total_ ? static_cast<double>(done_) / static_cast<double>(total_) : 0.0;
  const double left_s = fraction > 0.0 ? now_s * (1.0 - fraction) / fraction : 0.0;
  fmt::print(stderr, "{}{}: {}/{} ({:.0f} %), {} left{}{}{}", terminal_ ? "\r" : "", task_, done_,
             total_, 100.0 * fraction, clock_text(left_s), note.empty() ? "" : ", ", note,
             terminal_ ? "\x1b[K" : "\n");
  std::fflush(stderr);
  printed_ = true;
}

}  // namespace touchtrace
