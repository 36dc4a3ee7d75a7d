#include <fmt/core.h>
#include <fmt/ranges.h>

#include <map>

#include "engine/base/version.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/help.h"

namespace touchtrace::cli {
namespace {

struct GenerateOptions {
  std::string format;
};

void describe(OptionSet& set, GenerateOptions& o) {
  set.input("format", o.format, "man: manual page; bash, zsh: completion of the command line")
      .choices = {"man", "bash", "zsh"};
}

/// A command with its listed options.
struct Described {
  const Command* command;
  std::vector<Option> options;
};

std::vector<Described> describe_all(const Program& program, CommonValues& values) {
  std::vector<Described> all;
  for (const auto& group : program.groups)
    for (const auto& command : group.commands)
      all.push_back({&command, describe_options(command, values).all});
  return all;
}

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  for (auto at = text.find(old); at != std::string::npos; at = text.find(old, at + by.size()))
    text.replace(at, old.size(), by);
  return text;
}

/// Escapes a text for man(1): backslashes, hyphens that a user may copy, and leading dots.
std::string roff(const std::string& text) {
  const std::string escaped = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  return escaped.starts_with('.') || escaped.starts_with('\'') ? "\\&" + escaped : escaped;
}

std::string man_entry(const Option& option) {
  const auto value = option.default_text.empty() ? "" : " [" + option.default_text + "]";
  return fmt::format(".TP\n.B {}\n{}\n", roff(signature(option)), roff(option.help + value));
}

std::string man_of(const std::string& program, const Described& described) {
  const auto& [command, options] = described;
  std::string text =
      fmt::format(".SS {}\n{}.\n.PP\n.B {}\n", roff(command->name), roff(command->summary),
                  roff(usage_line(program, *command, options)));
  for (const Option& option : options)
    if (option.group != "Common") text += man_entry(option);
  text += ".PP\nExamples:\n.PP\n.nf\n";
  for (const auto& example : command->examples) text += roff(example) + "\n";
  return text + ".fi\n";
}

std::string man_page(const Program& program, const std::vector<Described>& all) {
  std::string text = fmt::format(
      ".TH TOUCHTRACE 1 \"\" \"touchtrace {}\"\n.SH NAME\ntouchtrace \\- predict the motion of "
      "hand "
      "and object from touch\n.SH SYNOPSIS\n.B touchtrace\n.I COMMAND\n[OPTIONS]\n"
      ".SH DESCRIPTION\n{}\n.SH COMMANDS\n",
      version, roff(program.summary));
  std::map<std::string, std::string> common;
  for (const auto& described : all) {
    text += man_of(program.name, described);
    for (const Option& option : described.options)
      if (option.group == "Common") common[option.name] = man_entry(option);
  }
  text += ".SH COMMON OPTIONS\nEach command accepts those that affect it.\n";
  for (const auto& [name, entry] : common) text += entry;
  return text + fmt::format(".SH EXIT STATUS\n{}\n", roff(exit_codes));
}

std::string labels_of(const std::vector<Option>& options) {
  std::vector<std::string> labels;
  for (const Option& option : options)
    if (!option.positional) labels.push_back(option.label());
  return fmt::format("{}", fmt::join(labels, " "));
}

std::string names_of(const std::vector<Described>& all) {
  std::vector<std::string> names;
  for (const auto& described : all) names.push_back(described.command->name);
  return fmt::format("{}", fmt::join(names, " "));
}

/// Words of a choice after an option, else the options, else files.
std::string bash_completion(const std::vector<Described>& all) {
  std::string text = fmt::format(
      "_touchtrace() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} words=\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ] || {{ [ \"$COMP_CWORD\" -eq 2 ] && [ \"$previous\" = help ]; "
      "}}; "
      "then\n"
      "    words='{} help --help --version --list'\n"
      "  else\n"
      "    case \"${{COMP_WORDS[1]}} $previous\" in\n",
      names_of(all));
  for (const auto& [command, options] : all)
    for (const Option& option : options)
      if (!option.choices.empty() && !option.positional)
        text += fmt::format("      '{} {}') words='{}' ;;\n", command->name, option.label(),
                            fmt::join(option.choices, " "));
  text += "    esac\n    if [ -z \"$words\" ]; then\n      case \"${COMP_WORDS[1]}\" in\n";
  for (const auto& [command, options] : all) {
    std::string words = labels_of(options);
    for (const Option& option : options)
      if (option.positional && !option.choices.empty())
        words += fmt::format(" {}", fmt::join(option.choices, " "));
    text += fmt::format("        {}) words='{}' ;;\n", command->name, words);
  }
  return text +
         "      esac\n    fi\n  fi\n"
         "  # shellcheck disable=SC2207\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
         "}\n"
         "complete -o default -F _touchtrace touchtrace\n";
}

/// Escapes a text for a description in a single-quoted _arguments specification.
std::string zsh(const std::string& text) {
  std::string escaped = replaced(text, "'", "'\\''");
  for (const char* special : {"[", "]", ":"})
    escaped = replaced(escaped, special, "\\" + std::string(special));
  return escaped;
}

std::string zsh_specification(const Option& option) {
  const std::string values =
      option.choices.empty() ? "_files" : fmt::format("({})", fmt::join(option.choices, " "));
  if (option.positional)
    return fmt::format("'{}:{}:{}'", option.is_list() ? "*" : "", option.name, values);
  const std::string flag =
      fmt::format("{}{}[{}]", option.is_list() ? "*" : "", option.label(), zsh(option.help));
  return option.is_flag() ? fmt::format("'{}'", flag)
                          : fmt::format("'{}:{}:{}'", flag, option.name, values);
}

std::string zsh_completion(const std::vector<Described>& all) {
  std::string text = "#compdef touchtrace\n\nlocal -a commands\ncommands=(\n";
  for (const auto& described : all)
    text += fmt::format("  '{}:{}'\n", described.command->name, zsh(described.command->summary));
  text +=
      "  'help:describe a command'\n)\n\n"
      "if (( CURRENT == 2 )); then\n  _describe command commands\n  return\nfi\n\n"
      "shift words\n(( CURRENT-- ))\ncase $words[1] in\n"
      "  help)\n    _describe command commands\n    ;;\n";
  for (const auto& [command, options] : all) {
    text += fmt::format("  {})\n    _arguments", command->name);
    for (const Option& option : options) text += " \\\n      " + zsh_specification(option);
    text += "\n    ;;\n";
  }
  return text + "esac\n";
}

ExitCode run(const GenerateOptions& options, const Invocation&) {
  const std::string format = options.format;  // describing the commands resets their options
  CommonValues values;
  const auto all = describe_all(touchtrace_program(), values);
  if (format == "man")
    fmt::print("{}", man_page(touchtrace_program(), all));
  else
    fmt::print("{}", format == "bash" ? bash_completion(all) : zsh_completion(all));
  return ExitCode::done;
}

}  // namespace

Command generate_command() {
  return make_command<GenerateOptions>(
      "generate", "print a manual page or a shell completion",
      {"touchtrace generate man > touchtrace.1", ". <(touchtrace generate bash)",
       "touchtrace generate zsh > ~/.zfunc/_touchtrace"},
      run, {.json = false});
}

}  // namespace touchtrace::cli
