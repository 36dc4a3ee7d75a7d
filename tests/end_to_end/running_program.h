#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

namespace touchtrace::testing {

/// `touchtrace ARGUMENTS`, started through the shell and still running; killed by the destructor.
/// stdout and stderr go to the file `log`.
class RunningProgram {
 public:
  RunningProgram(const std::string& arguments, const std::filesystem::path& log) {
    const std::string command = std::string("exec ") + TOUCHTRACE_PROGRAM + " " + arguments + " >" +
                                log.string() + " 2>&1 </dev/null";
    process_ = fork();
    if (process_ != 0) return;
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  ~RunningProgram() {
    if (!ended_) signal(SIGKILL), wait();
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void signal(int number) const { kill(process_, number); }

  /// Waits for the end. Returns the exit code, or 128 + the signal that ended it.
  int wait() {
    if (!ended_) waitpid(process_, &status_, 0), ended_ = true;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }

  /// Polls until `has_happened()` or the end of the program. Returns whether it happened first.
  template <class Event>
  bool wait_for(Event has_happened) {
    while (!has_happened()) {
      if (waitpid(process_, &status_, WNOHANG) == process_) return ended_ = true, false;
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    return true;
  }

  /// Whether the program has a file open.
  bool has_open(const std::filesystem::path& file) const {
    std::error_code gone;  // files are closed and the program ends while this looks
    const auto descriptors = "/proc/" + std::to_string(process_) + "/fd";
    for (std::filesystem::directory_iterator entry(descriptors, gone), end; !gone && entry != end;
         entry.increment(gone)) {
      std::error_code closed;
      if (std::filesystem::read_symlink(entry->path(), closed) == file) return true;
    }
    return false;
  }

 private:
  pid_t process_;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace touchtrace::testing
