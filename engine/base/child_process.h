#pragma once

#include <sys/types.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

struct ChildResult {
  int exit_code = -1;      ///< -1 if ended by a signal or not known
  int signal = 0;          ///< that ended it
  bool timed_out = false;  ///< killed because it printed nothing for too long
  std::string output;      ///< stdout
  double wall_seconds = 0.0, cpu_seconds = 0.0;

  bool succeeded() const { return exit_code == 0; }
  /// "ended by signal 11 (Segmentation fault)"
  std::string ending() const;
};

/// Runs this executable again with `arguments` and with `environment` added to its own, and waits
/// for it. Kills it if it prints nothing to stdout for `silence_s` or on an interrupt. stderr is
/// shared. Throws failure if it cannot be started.
ChildResult run_self(const std::vector<std::string>& arguments,
                     const std::map<std::string, std::string>& environment, double silence_s);

/// Runs this executable again in the background, without output. The destructor kills it if it is
/// still running. If it cannot be started, nothing happens.
class BackgroundProcess {
 public:
  /// `input`: its stdin.
  BackgroundProcess(const std::vector<std::string>& arguments, std::string_view input);
  ~BackgroundProcess();
  BackgroundProcess(const BackgroundProcess&) = delete;
  BackgroundProcess& operator=(const BackgroundProcess&) = delete;

 private:
  pid_t process_ = 0;  ///< 0: not started
};

}  // namespace touchtrace
