#include <fmt/core.h>
#include <glog/logging.h>

#include <algorithm>
#include <new>
#include <string>
#include <vector>

#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "engine/cl/compiler_process.h"
#include "pipeline/cli/arguments.h"
#include "pipeline/cli/command.h"
#include "pipeline/cli/configuration.h"
#include "pipeline/cli/help.h"
#include "pipeline/cli/versions.h"

namespace touchtrace::cli {
namespace {

using Arguments = std::vector<std::string>;

// Arguments with which the program calls itself. They are not commands: nobody else needs them.
constexpr const char* compile_kernels = "compile-kernels";

std::vector<std::string> command_names(const Program& program) {
  std::vector<std::string> names;
  for (const auto& group : program.groups)
    for (const auto& command : group.commands) names.push_back(command.name);
  return names;
}

void require_given(const std::vector<Option>& options, const std::string& usage,
                   const std::string& help) {
  for (const Option& option : options)
    if (option.required && option.is_empty())
      throw usage_error(fmt::format("missing {}; usage: {}",
                                    option.positional ? option.label()
                                                      : option.label() + " " + option.placeholder,
                                    usage),
                        help);
}

}  // namespace

const Command& find_command(const Program& program, const std::string& name) {
  for (const auto& group : program.groups)
    for (const auto& command : group.commands)
      if (command.name == name) return command;
  if (const auto moved = program.moved.find(name); moved != program.moved.end())
    throw usage_error(fmt::format("'{}' moved to {}", name, moved->second.place),
                      moved->second.hint);
  throw usage_error(
      fmt::format("unknown command '{}'{}", name, did_you_mean(name, command_names(program))),
      program.name + " --help lists all commands");
}

OptionSet parse_options(const Program& program, const Command& command,
                        const std::vector<std::string>& arguments, CommonValues& values) {
  auto [own, options] = describe_options(command, values);
  const std::string help_hint = fmt::format("{} {} --help", program.name, command.name);
  const auto given = parse_arguments(arguments, options, help_hint + " lists the options");
  if (!values.configuration_file.empty())
    apply_configuration(values.configuration_file, command_names(program), command.name, options,
                        given);
  require_given(options, usage_line(program.name, command, options),
                help_hint + " describes the options");
  own.validate();
  return own;
}

namespace {

ExitCode run_command(const Program& program, const Command& command, const Arguments& arguments) {
  CommonValues values;
  values.invocation.options = parse_options(program, command, arguments, values).values();
  if (values.quiet) Progress::silence();
  return command.run(values.invocation);
}

ExitCode print(const std::string& text) {
  fmt::print("{}", text);
  return ExitCode::done;
}

bool asks_for_help(const std::string& argument) { return argument == "--help" || argument == "-h"; }

ExitCode run_program_option(const Program& program, const std::string& option) {
  if (asks_for_help(option)) return print(help_text(program));
  if (option == "--version") return print(version_text(program.name));
  if (option == "--list") return print(list_text(program));
  throw usage_error(fmt::format("unknown option '{}'{}", option,
                                did_you_mean(option, {"--help", "--version", "--list"})),
                    program.name + " --help lists all commands");
}

ExitCode dispatch(const Program& program, const Arguments& arguments) {
  if (arguments.empty()) {
    fmt::print(stderr, "{}", help_text(program));
    return ExitCode::usage;
  }
  const std::string& first = arguments.front();
  if (first == "help")
    return print(arguments.size() == 1
                     ? help_text(program)
                     : help_text(program.name, find_command(program, arguments[1])));
  if (first.starts_with('-')) return run_program_option(program, first);
  const Command& command = find_command(program, first);
  const Arguments rest(arguments.begin() + 1, arguments.end());
  if (std::any_of(rest.begin(), std::ranges::find(rest, "--"), asks_for_help))
    return print(help_text(program.name, command));
  return run_command(program, command, rest);
}

/// Runs what this program starts itself for. Returns false for the command line of a user.
bool run_as_child(const Arguments& arguments) {
  if (arguments == Arguments{compile_kernels})
    compile_from_stdin();
  else if (arguments == Arguments{print_opencl_versions})
    fmt::print("{}", opencl_versions());
  else
    return false;
  return true;
}

int report(const Program& program, ExitCode code, const std::string& problem,
           const std::string& hint) {
  fmt::print(stderr, "{}: {}\n", program.name, problem);
  if (!hint.empty()) fmt::print(stderr, "hint: {}\n", hint);
  return static_cast<int>(code);
}

}  // namespace

int run_command_line(const Program& program, int argc, const char* const* argv) {
  // Ceres logs rejected steps and failed fits, which are handled.
  FLAGS_minloglevel = google::GLOG_FATAL;
  catch_interrupts();
  try {
    const Arguments arguments(argv + std::min(argc, 1), argv + argc);
    if (run_as_child(arguments)) return 0;
    register_compiler_arguments({compile_kernels});
    const ExitCode code = dispatch(program, arguments);
    if (std::fflush(stdout) != 0) throw failure("cannot write standard output", "check the disk");
    return static_cast<int>(code);
  } catch (const Error& error) {
    return report(program, error.code(), error.what(), error.hint());
  } catch (const std::bad_alloc&) {
    return report(program, ExitCode::failed, "out of memory", "use fewer or smaller inputs");
  } catch (const std::exception& error) {
    return report(program, ExitCode::failed, error.what(), "this is a bug; please report it");
  }
}

}  // namespace touchtrace::cli
