#pragma once

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "pipeline/acquire/transport/transport.h"
#include "pipeline/cli/commands.h"

namespace touchtrace {

/// Process that runs a function, with stdout to a descriptor; killed by the destructor and with its
/// parent. OpenCL is used in such processes only, for it does not survive a fork.
class Child {
 public:
  explicit Child(const std::function<int()>& run, int standard_output = -1) : process_(fork()) {
    if (process_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (standard_output >= 0) dup2(standard_output, STDOUT_FILENO);
    _exit(run());
  }
  ~Child() {
    if (process_ > 0) signal(SIGKILL), wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void signal(int number) const { kill(process_, number); }

  /// Waits until the process has a file open, or 60 s.
  void wait_until_open(const std::filesystem::path& file) const {
    namespace fs = std::filesystem;
    const auto descriptors = fs::path("/proc") / std::to_string(process_) / "fd";
    for (const double end_s = monotonic_s() + 60.0; monotonic_s() < end_s; usleep(10'000)) {
      std::error_code closed;  // files are closed while this looks
      for (const auto& entry : fs::directory_iterator(descriptors, closed))
        if (fs::read_symlink(entry.path(), closed) == file) return;
    }
  }
  /// Returns the exit code; -1: ended by a signal.
  int wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void require_success(const char* what) {
    if (wait() != 0) throw failure(std::string(what) + " failed", "see its message above");
  }

 private:
  pid_t process_;
};

/// Runs `touchtrace ARGUMENTS --quiet` in this process; returns its exit code.
inline int run_touchtrace(std::vector<std::string> arguments) {
  std::vector<const char*> argv{"touchtrace"};
  for (const auto& argument : arguments) argv.push_back(argument.c_str());
  argv.push_back("--quiet");
  return cli::run_command_line(cli::touchtrace_program(), static_cast<int>(argv.size()),
                               argv.data());
}

}  // namespace touchtrace
