#include "pipeline/cli/help.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "engine/base/text.h"

namespace touchtrace::cli {
namespace {

constexpr std::size_t line_width = 88;
constexpr std::size_t max_signature = 30;

/// Breaks a text at spaces; lines after the first start with `indent` spaces.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::string result;
  std::size_t column = indent;
  for (const auto& word : split_text(text, ' ')) {
    if (!result.empty() && column + 1 + word.size() > line_width) {
      result += "\n" + std::string(indent, ' ') + word;
      column = indent + word.size();
    } else {
      result += (result.empty() ? "" : " ") + word;
      column += word.size() + 1;
    }
  }
  return result;
}

/// Two columns; a left side that is wider than `width` has a line of its own.
std::string row(const std::string& left, const std::string& right, std::size_t width) {
  const std::size_t indent = width + 4;
  std::string text = "  " + left;
  text += left.size() > width ? "\n" + std::string(indent, ' ')
                              : std::string(indent - text.size(), ' ');
  return text + wrapped(right, indent) + "\n";
}

std::string sentence(std::string summary) {
  summary[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(summary[0])));
  return summary + ".";
}

std::string description(const Option& option) {
  std::string text = option.help;
  if (option.required && !option.positional) text += " (required)";
  if (!option.default_text.empty()) text += " [" + option.default_text + "]";
  return text;
}

std::string options_text(const std::vector<Option>& options) {
  std::size_t width = 0;
  for (const Option& option : options)
    if (const auto size = signature(option).size(); size <= max_signature)
      width = std::max(width, size);
  std::string text, group;
  for (const Option& option : options) {
    if (option.group != group) text += (group = option.group) + ":\n";
    text += row(signature(option), description(option), width);
  }
  return text;
}

OptionSet describe_common(const Command& command, CommonValues& values, bool has_own_options) {
  OptionSet set;
  set.group("Common");
  if (has_own_options)
    set.text("config", values.configuration_file,
             "TOML file with options as keys of a table named after the command; flags win over it")
        .value("FILE");
  if (command.common.device)
    set.text("device", values.invocation.device,
             "OpenCL device: number, type or part of its name, see `touchtrace devices`")
        .value("DEVICE");
  if (command.common.json)
    set.flag("json", values.invocation.json, "print one JSON document on stdout");
  if (command.common.overwrite)
    set.flag("overwrite", values.invocation.overwrite, "replace existing output files");
  if (command.common.quiet) set.flag("quiet", values.quiet, "no progress on stderr");
  set.flag("help", values.help, "print this help");
  return set;
}

}  // namespace

CommandOptions describe_options(const Command& command, CommonValues& values) {
  CommandOptions options;
  command.describe(options.own);
  options.all = options.own.options();
  const auto common = describe_common(command, values, !options.all.empty());
  options.all.insert(options.all.end(), common.options().begin(), common.options().end());
  return options;
}

std::string signature(const Option& option) {
  const std::string more = option.is_list() && option.count == 0 ? "..." : "";
  if (option.positional) return option.placeholder + more;
  if (option.name == "help") return "-h,--help";
  const std::string label = (option.name == "output" ? "-o," : "") + option.label();
  return option.is_flag() ? label : label + " " + option.placeholder + more;
}

std::string usage_line(const std::string& program, const Command& command,
                       const std::vector<Option>& options) {
  std::string positional, required;
  for (const Option& option : options) {
    const std::string text = option.positional
                                 ? option.placeholder + (option.is_list() ? "..." : "")
                                 : option.label() + " " + option.placeholder;
    if (option.positional)
      positional += option.required ? " " + text : " [" + text + "]";
    else if (option.required)
      required += " " + text;
  }
  return fmt::format("{} {}{}{} [OPTIONS]", program, command.name, positional, required);
}

std::string help_text(const Program& program) {
  std::string text =
      fmt::format("{}\n\nUsage: {} COMMAND [OPTIONS]\n", wrapped(program.summary, 0), program.name);
  for (const auto& group : program.groups) {
    text += "\n" + group.heading + ":\n";
    for (const auto& command : group.commands) text += row(command.name, command.summary, 12);
  }
  return text + fmt::format(
                    "\n`{0} help COMMAND` describes a command, `{0} --version` prints versions,\n"
                    "`{0} --list` prints the commands. Without a command: this help, exit code 2.\n"
                    "{1}\n",
                    program.name, exit_codes);
}

std::string help_text(const std::string& program, const Command& command) {
  CommonValues values;
  const auto options = describe_options(command, values).all;
  std::string text = fmt::format("{}\n\nUsage: {}\n\n{}", wrapped(sentence(command.summary), 0),
                                 usage_line(program, command, options), options_text(options));
  text += "\nExamples:\n";
  for (const auto& example : command.examples) text += "  " + example + "\n";
  return text + exit_codes + "\n";
}

std::string list_text(const Program& program) {
  std::string text;
  for (const auto& group : program.groups)
    for (const auto& command : group.commands)
      text += fmt::format("{:<13} {}\n", command.name, command.summary);
  return text;
}

}  // namespace touchtrace::cli
