#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace touchtrace {

/// Progress report with estimated time left on stderr, starting after one second: one line that is
/// updated in place on a terminal, else a line every ten seconds. Thread-safe.
class Progress {
 public:
  /// `task`: start of the line; `total`: number of steps.
  Progress(std::string task, std::uint64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Adds `count` steps. `note`: end of the line. Calls throw_if_interrupted().
  void advance(std::uint64_t count = 1, const std::string& note = {});
  /// Seconds since the construction.
  double seconds() const;

  /// Prints a line on stderr: progress of work without a known number of steps.
  static void report(const std::string& line);
  /// Prints "warning: ..." on stderr, also after silence().
  static void warn(const std::string& text);
  /// Turns off all progress reports (--quiet).
  static void silence();

 private:
  void print(double now_s, const std::string& note);

  std::mutex mutex_;
  std::string task_;
  std::uint64_t total_, done_ = 0;
  std::chrono::steady_clock::time_point start_;
  double next_print_s_ = 1.0;
  bool terminal_, printed_ = false;
};

}  // namespace touchtrace
