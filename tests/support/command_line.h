#pragma once

#include <string>
#include <vector>

#include "pipeline/cli/commands.h"

namespace touchtrace::testing {

/// Runs `touchtrace ARGUMENTS --quiet` in this process. Returns the exit code.
inline int run_touchtrace(std::vector<std::string> arguments) {
  arguments.emplace_back("--quiet");
  std::vector<const char*> argv{"touchtrace"};
  for (const auto& argument : arguments) argv.push_back(argument.c_str());
  return cli::run_command_line(cli::touchtrace_program(), static_cast<int>(argv.size()),
                               argv.data());
}

}  // namespace touchtrace::testing
