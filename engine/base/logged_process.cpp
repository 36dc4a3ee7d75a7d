#include "engine/base/logged_process.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

#include "engine/base/error.h"

namespace touchtrace {
namespace {

using Clock = std::chrono::steady_clock;
constexpr const char* this_program = "/proc/self/exe";
constexpr auto patience = std::chrono::seconds(10);

Error not_started(const std::string& what) {
  return failure(fmt::format("cannot start {}: {}", what, std::strerror(errno)),
                 "check the disk and the limits of processes and open files (ulimit -a)");
}

/// Open file, closed by the destructor.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags)
      : number_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (number_ < 0) throw not_started(path.string());
  }
  ~Descriptor() { close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

/// Becomes the program, in the new process. Only async-signal-safe calls.
[[noreturn]] void become(char* const* arguments, int input, int output, int log, pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);
  dup2(input, STDIN_FILENO), dup2(output, STDOUT_FILENO), dup2(log, STDERR_FILENO);
  close_range(STDERR_FILENO + 1, ~0U, 0);
  execv(this_program, arguments);
  _exit(127);
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

LoggedProcess::LoggedProcess(const std::vector<std::string>& arguments,
                             const std::filesystem::path& output, const std::filesystem::path& log)
    : start_(Clock::now()) {
  std::vector<std::string> texts{this_program};
  texts.insert(texts.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (auto& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  const int write_new = O_WRONLY | O_CREAT | O_TRUNC;
  const Descriptor input_file("/dev/null", O_RDONLY), output_file(output, write_new),
      log_file(log, write_new);
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0)
    become(pointers.data(), input_file.number(), output_file.number(), log_file.number(), parent);
  if (process_ < 0) throw not_started(this_program);
}

LoggedProcess::~LoggedProcess() {
  if (process_ == 0) return;
  interrupt();
  for (const auto end = Clock::now() + patience; Clock::now() < end && !poll();)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  if (process_ == 0) return;
  kill(process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<ChildResult> LoggedProcess::poll() {
  int status = 0;
  rusage usage{};
  if (process_ == 0) return {};
  const pid_t ended = wait4(process_, &status, WNOHANG, &usage);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return {};
  process_ = 0;
  ChildResult result;
  if (ended > 0 && WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (ended > 0 && WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  result.wall_seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  result.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  return result;
}

void LoggedProcess::interrupt() {
  if (process_ > 0 && !interrupted_) kill(process_, SIGINT);
  interrupted_ = true;
}

}  // namespace touchtrace
