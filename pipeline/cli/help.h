#pragma once

#include <string>
#include <vector>

#include "pipeline/cli/command.h"

namespace touchtrace::cli {

inline constexpr const char* exit_codes =
    "Exit codes: 0 done, 1 failed, 2 usage, 3 data or quality gate, 4 no device, 130 interrupted";

/// Values of the common options while a command line is parsed.
struct CommonValues {
  Invocation invocation;
  std::string configuration_file;
  bool quiet = false, help = false;
};

struct CommandOptions {
  OptionSet own;
  std::vector<Option> all;  ///< own, then the common ones that apply to the command
};

/// Resets and describes the options of a command. `values` must outlive them.
CommandOptions describe_options(const Command& command, CommonValues& values);

/// Command by its name. Throws usage_error.
const Command& find_command(const Program& program, const std::string& name);

/// Sets the options of a command from its arguments and checks them. Throws usage_error.
OptionSet parse_options(const Program& program, const Command& command,
                        const std::vector<std::string>& arguments, CommonValues& values);

/// "-o,--output FILE" or "RECORDING", as the help lists it.
std::string signature(const Option& option);

/// "touchtrace label RECORDING --calibration PATH --output FILE [OPTIONS]"
std::string usage_line(const std::string& program, const Command& command,
                       const std::vector<Option>& options);

/// Help of a program: its commands by group.
std::string help_text(const Program& program);
/// Help of a command: usage, options by group, examples, exit codes.
std::string help_text(const std::string& program, const Command& command);

/// One line per command: name and summary.
std::string list_text(const Program& program);

}  // namespace touchtrace::cli
