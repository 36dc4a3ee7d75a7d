#include "pipeline/cli/command_table.h"

#include "pipeline/cli/commands.h"
#include "pipeline/cli/help.h"
#include "pipeline/cli/versions.h"

namespace touchtrace::cli {

sweep::CommandTable command_table() {
  static CommonValues values;  // options point to it
  return {program_version(),
          [](const std::string& name) {
            return describe_options(find_command(touchtrace_program(), name), values).all;
          },
          [](const std::string& name, const std::vector<std::string>& arguments) {
            const Command& command = find_command(touchtrace_program(), name);
            return parse_options(touchtrace_program(), command, arguments, values).values();
          }};
}

}  // namespace touchtrace::cli
