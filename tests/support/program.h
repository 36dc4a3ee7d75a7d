#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>

namespace touchtrace::testing {

struct ProgramResult {
  int exit_code;
  std::string output;  ///< stdout and stderr, unless the arguments redirect one
};

/// Runs `touchtrace ARGUMENTS` in a shell. `prefix`: put before the program, such as environment
/// variables.
inline ProgramResult run_program(const std::string& arguments, const std::string& prefix = "") {
  const std::string command = prefix + TOUCHTRACE_PROGRAM + " " + arguments + " 2>&1 </dev/null";
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return {-1, "popen failed"};
  ProgramResult result{-1, {}};
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    result.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace touchtrace::testing
