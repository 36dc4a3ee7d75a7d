#pragma once

#include <sys/types.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

struct ChildResult {
  int exit_code = -1;   ///< -1 where a signal ended it
  int signal = 0;       ///< that ended it
  bool silent = false;  ///< killed after it had printed nothing for too long
  std::string output;   ///< stdout
  double wall_seconds = 0.0, cpu_seconds = 0.0;

  bool succeeded() const { return exit_code == 0; }
  /// "ended by signal 11 (Segmentation fault)"
  std::string ending() const;
};

/// Runs this very program again, with `arguments` and with `environment` put over its own, and
/// waits for its end. It is killed once it has printed nothing for `silence_s`, or when the user
/// asks to stop. stderr is shared. Throws failure if it cannot be started.
ChildResult run_self(const std::vector<std::string>& arguments,
                     const std::map<std::string, std::string>& environment, double silence_s);

/// This very program at work beside this process, silently. It is killed, unless it has ended, when
/// this goes out of scope. Nothing happens if it cannot be started.
class BackgroundProcess {
 public:
  /// `input`: what it reads from stdin.
  BackgroundProcess(const std::vector<std::string>& arguments, std::string_view input);
  ~BackgroundProcess();
  BackgroundProcess(const BackgroundProcess&) = delete;
  BackgroundProcess& operator=(const BackgroundProcess&) = delete;

 private:
  pid_t process_ = 0;  ///< 0: not started
};

}  // namespace touchtrace
