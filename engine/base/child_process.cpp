#include "engine/base/child_process.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include "engine/base/error.h"
#include "engine/base/interrupt.h"

namespace touchtrace {
namespace {

constexpr const char* this_program = "/proc/self/exe";
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Error not_started(int error) {
  return failure(fmt::format("cannot start {}: {}", this_program, std::strerror(error)),
                 "check the limits of processes and open files (ulimit -a)");
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (auto& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

std::vector<std::string> environment_with(const std::map<std::string, std::string>& changes) {
  std::vector<std::string> result;
  for (char** entry = environ; *entry; ++entry) {
    const std::string text(*entry);
    if (!changes.contains(text.substr(0, text.find('=')))) result.push_back(text);
  }
  for (const auto& [name, value] : changes) result.push_back(name + "=" + value);
  return result;
}

/// RAII wrapper of posix_spawn_file_actions_t.
class FileActions {
 public:
  FileActions() { posix_spawn_file_actions_init(&actions_); }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;

  /// Makes descriptor `file` a duplicate of `source`.
  void redirect(int file, int source) { posix_spawn_file_actions_adddup2(&actions_, source, file); }
  void discard(int file) {
    posix_spawn_file_actions_addopen(&actions_, file, "/dev/null", O_WRONLY, 0);
  }
  /// Closes all but standard input and outputs. HDF5's files are inherited otherwise, and stay
  /// locked as long as the process or one that it starts runs.
  void close_others() { posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1); }
  const posix_spawn_file_actions_t* get() const { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_;
};

/// Starts this executable. Returns 0 or an errno value.
int spawn_self(pid_t& process, std::vector<std::string> arguments,
               const std::map<std::string, std::string>& changes, FileActions& actions) {
  actions.close_others();
  arguments.insert(arguments.begin(), this_program);
  auto environment = environment_with(changes);
  return posix_spawn(&process, this_program, actions.get(), nullptr, pointers(arguments).data(),
                     pointers(environment).data());
}

/// Child process with a pipe from its stdout. The destructor kills it if it has not been waited
/// for.
class Child {
 public:
  Child(const std::vector<std::string>& arguments,
        const std::map<std::string, std::string>& changes) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw not_started(errno);
    output_ = ends[0];
    FileActions actions;
    actions.redirect(STDOUT_FILENO, ends[1]);
    const int error = spawn_self(process_, arguments, changes, actions);
    close(ends[1]);
    if (error == 0) return;
    close(output_);
    throw not_started(error);
  }
  ~Child() {
    close(output_);
    if (process_ > 0) kill(process_, SIGKILL), wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Reads stdout to its end. Returns false if nothing is printed for `silence_s`.
  bool read_all(std::string& text, double silence_s) const {
    auto last = Clock::now();
    std::array<char, 4096> buffer;
    while (seconds_since(last) < silence_s) {
      throw_if_interrupted();
      pollfd ready{output_, POLLIN, 0};
      if (poll(&ready, 1, 100) <= 0) continue;
      const auto count = read(output_, buffer.data(), buffer.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return true;
      text.append(buffer.data(), static_cast<std::size_t>(count));
      last = Clock::now();
    }
    return false;
  }
  void terminate() const { kill(process_, SIGKILL); }
  int wait() {
    int status = 0;
    while (wait4(process_, &status, 0, &usage_) < 0 && errno == EINTR) {
    }
    process_ = 0;
    return status;
  }
  /// Valid after wait().
  double cpu_seconds() const {
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(usage_.ru_utime) + seconds(usage_.ru_stime);
  }

 private:
  pid_t process_ = 0;
  int output_ = -1;
  rusage usage_{};
};

}  // namespace

std::string ChildResult::ending() const {
  if (timed_out) return "hangs";
  return signal ? fmt::format("ended by signal {} ({})", signal, strsignal(signal))
                : fmt::format("ended with exit code {}", exit_code);
}

ChildResult run_self(const std::vector<std::string>& arguments,
                     const std::map<std::string, std::string>& environment, double silence_s) {
  const auto start = Clock::now();
  Child child(arguments, environment);
  ChildResult result;
  result.timed_out = !child.read_all(result.output, silence_s);
  if (result.timed_out) child.terminate();
  const int status = child.wait();
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  result.wall_seconds = seconds_since(start);
  result.cpu_seconds = child.cpu_seconds();
  return result;
}

BackgroundProcess::BackgroundProcess(const std::vector<std::string>& arguments,
                                     std::string_view input) {
  const int file = memfd_create("input", MFD_CLOEXEC);
  if (file < 0) return;
  FileActions actions;
  actions.redirect(STDIN_FILENO, file);
  actions.discard(STDOUT_FILENO), actions.discard(STDERR_FILENO);
  if (write(file, input.data(), input.size()) == static_cast<ssize_t>(input.size()) &&
      lseek(file, 0, SEEK_SET) == 0 && spawn_self(process_, arguments, {}, actions) != 0)
    process_ = 0;
  close(file);
}

BackgroundProcess::~BackgroundProcess() {
  if (process_ == 0) return;
  kill(process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

}  // namespace touchtrace
