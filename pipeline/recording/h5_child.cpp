#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <fstream>

#include "pipeline/recording/h5_file.h"

namespace touchtrace::h5 {
namespace {

constexpr rlim_t max_extra_memory_bytes = rlim_t{4} << 30;
constexpr rlim_t max_cpu_s = 60;
constexpr unsigned max_wall_s = 120;
constexpr const char* damaged_hint = "copy or record the file again";

enum class Outcome : char { success = 's', error = 'e' };

/// Address space in use, which the mappings of a device or a sanitizer can make large.
rlim_t address_space_bytes() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

void limit(decltype(RLIMIT_AS) resource, rlim_t value) {
  const rlimit bound{value, value};
  setrlimit(resource, &bound);
}

void confine_child() {
  limit(RLIMIT_AS, address_space_bytes() + max_extra_memory_bytes);
  limit(RLIMIT_CPU, max_cpu_s);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  std::signal(SIGALRM, SIG_DFL);
  alarm(max_wall_s);
  const int null_device = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(null_device, STDOUT_FILENO);
  dup2(null_device, STDERR_FILENO);
}

std::string message_of(const std::function<void()>& read) {
  try {
    read();
    return {static_cast<char>(Outcome::success)};
  } catch (const Error& error) {
    return static_cast<char>(Outcome::error) + std::string(error.what()) + '\0' + error.hint();
  } catch (const std::bad_alloc&) {
    return static_cast<char>(Outcome::error) +
           std::string("reading the file needs too much memory") + '\0' + damaged_hint;
  } catch (const std::exception& error) {
    return static_cast<char>(Outcome::error) + std::string(error.what()) + '\0' + damaged_hint;
  }
}

[[noreturn]] void run_child(int pipe_end, const std::function<void()>& read) {
  confine_child();
  const std::string message = message_of(read);
  const auto written = ::write(pipe_end, message.data(), message.size());
  _exit(written == static_cast<ssize_t>(message.size()) ? 0 : 1);
}

std::string read_all(int pipe_end) {
  std::string text;
  char buffer[4096];
  for (ssize_t count; (count = ::read(pipe_end, buffer, sizeof buffer)) != 0;) {
    if (count > 0)
      text.append(buffer, static_cast<std::size_t>(count));
    else if (errno != EINTR)
      break;
  }
  return text;
}

void wait_for(pid_t child) {
  while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void throw_error_of(const std::filesystem::path& path, const std::string& message) {
  if (message.empty())
    throw data_error(fmt::format("{} is damaged: reading it crashed or took more than {} s",
                                 path.string(), max_cpu_s),
                     damaged_hint);
  if (message[0] == static_cast<char>(Outcome::success)) return;
  const auto end = message.find('\0');
  throw data_error(message.substr(1, end - 1), message.substr(end + 1));
}

}  // namespace

void run_in_child(const std::filesystem::path& path, const std::function<void()>& read) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw failure(fmt::format("cannot create a pipe: {}", std::strerror(errno)),
                  "close other programs");
  const pid_t child = fork();
  if (child == 0) run_child(ends[1], read);
  close(ends[1]);
  const std::string message = child > 0 ? read_all(ends[0]) : std::string();
  close(ends[0]);
  if (child < 0)
    throw failure(fmt::format("cannot start a process: {}", std::strerror(errno)),
                  "close other programs");
  wait_for(child);
  throw_error_of(path, message);
}

}  // namespace touchtrace::h5
