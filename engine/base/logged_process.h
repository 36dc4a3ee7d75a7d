#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/child_process.h"

namespace touchtrace {

/// This executable, run again in a process group of its own with stdout and stderr in files. It is
/// killed if this process is.
class LoggedProcess {
 public:
  /// Throws failure if it cannot be started.
  LoggedProcess(const std::vector<std::string>& arguments, const std::filesystem::path& output,
                const std::filesystem::path& log);
  /// Interrupts it if it is still running, and kills it after ten seconds.
  ~LoggedProcess();
  LoggedProcess(const LoggedProcess&) = delete;
  LoggedProcess& operator=(const LoggedProcess&) = delete;

  /// Result without `output`; empty while it is running.
  std::optional<ChildResult> poll();
  /// Sends SIGINT, once.
  void interrupt();

 private:
  pid_t process_ = 0;  ///< 0: ended
  bool interrupted_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace touchtrace
