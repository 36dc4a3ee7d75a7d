#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace touchtrace {

/// Progress with time left, on stderr, once the work has taken a second.
///
/// A terminal gets one line that rewrites itself; a file gets a line every ten seconds.
/// Every call of `advance` also honours Ctrl-C (throw_if_interrupted). Thread-safe.
class Progress {
 public:
  Progress(std::string what, std::uint64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(std::uint64_t count = 1, const std::string& note = {});
  double seconds() const;

  /// No progress is printed from now on (`--quiet`).
  static void silence();

 private:
  void print(double now_s, const std::string& note);

  std::mutex mutex_;
  std::string what_;
  std::uint64_t total_, done_ = 0;
  std::chrono::steady_clock::time_point start_;
  double next_print_s_ = 1.0;
  bool terminal_, printed_ = false;
};

}  // namespace touchtrace
