#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "engine/base/error.h"

namespace touchtrace::testing {

/// Exit code of `write` in a child process whose files may not exceed `max_bytes`, like a full
/// disk. 0: success.
template <class Write>
int exit_code_on_small_disk(rlim_t max_bytes, Write write) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit bound{max_bytes, max_bytes};
    setrlimit(RLIMIT_FSIZE, &bound);
    std::signal(SIGXFSZ, SIG_IGN);
    try {
      write();
    } catch (const Error& error) {
      _exit(static_cast<int>(error.code()));
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace touchtrace::testing
