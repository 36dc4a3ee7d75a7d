#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "engine/base/version.h"
#include "engine/cl/compiler_process.h"
#include "pipeline/cli/configuration.h"
#include "pipeline/cli/verb.h"

namespace touchtrace::cli {
namespace {

// What this program calls itself with to compile kernels beside itself: no verb, since it is of no
// use to anybody else.
constexpr const char* compile_kernels = "compile-kernels";

constexpr const char* exit_codes =
    "Exit codes: 0 done, 1 failed, 2 usage, 3 data or quality gate, 4 no device, 130 interrupted";

/// A verb as CLI11 sees it, with everything that must outlive the parsing.
struct Command {
  const Verb* verb;
  CLI::App* app;
  OptionSet options;
  Invocation invocation;
  std::string configuration_file;
  bool quiet = false;
};

void bind(CLI::App& app, const Option& option) {
  const std::string short_flag = option.name == "output" ? "-o," : "";
  const std::string flag = option.positional ? option.name : short_flag + "--" + option.name;
  std::visit(
      [&](auto* target) {
        using Value = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_same_v<Value, bool>)
          app.add_flag(flag, *target, option.help);
        else
          app.add_option(flag, *target, option.help)->capture_default_str();
      },
      option.target);
}

void bind_common(Command& command) {
  CLI::App& app = *command.app;
  app.add_option("--config", command.configuration_file,
                 "TOML file with keys like these flags; flags win over it");
  app.add_option("--device", command.invocation.device,
                 "OpenCL device: number, type or part of a name (see touchtrace devices)");
  app.add_flag("--json", command.invocation.json, "print one JSON document on stdout");
  app.add_flag("--overwrite", command.invocation.overwrite, "replace outputs that exist");
  app.add_flag("--quiet", command.quiet, "no progress on stderr");
}

std::string examples_text(const Verb& verb) {
  std::string text = "Examples:\n";
  for (const auto& example : verb.examples) text += "  " + example + "\n";
  return text + exit_codes;
}

std::vector<std::unique_ptr<Command>> make_commands(const Program& program, CLI::App& root) {
  std::vector<std::unique_ptr<Command>> commands;
  for (const auto& verb : program.commands) {
    auto command = std::make_unique<Command>();
    command->verb = &verb;
    command->app = root.add_subcommand(verb.name, verb.summary);
    command->app->footer(examples_text(verb));
    verb.describe(command->options);
    for (const auto& option : command->options.options()) bind(*command->app, option);
    bind_common(*command);
    commands.push_back(std::move(command));
  }
  return commands;
}

std::vector<std::string> flag_names(const Command& command) {
  std::vector<std::string> names{"config", "device", "json", "overwrite", "quiet"};
  for (const auto& name : command.options.names()) names.push_back(name);
  return names;
}

/// The flags that were given, so that the configuration file does not change them.
std::vector<std::string> given(const Command& command) {
  std::vector<std::string> names;
  for (const auto& option : command.options.options()) {
    const auto* flag =
        command.app->get_option_no_throw(option.positional ? option.name : "--" + option.name);
    if (flag && flag->count() > 0) names.push_back(option.name);
  }
  return names;
}

ExitCode run(Command& command) {
  if (command.quiet) Progress::silence();
  if (!command.configuration_file.empty())
    apply_configuration(command.configuration_file, command.verb->name, command.options,
                        given(command));
  command.options.validate();
  command.invocation.options = command.options.values();
  return command.verb->run(command.invocation);
}

std::string first_unknown(const Command& command) {
  const auto rest = command.app->remaining();
  return rest.empty() ? std::string() : rest.front();
}

/// Unknown flags and verbs get a suggestion; CLI11 alone would not make one.
[[noreturn]] void throw_usage(const CLI::ParseError& error,
                              const std::vector<std::unique_ptr<Command>>& commands, int argc,
                              const char* const* argv) {
  for (const auto& command : commands) {
    const std::string unknown = command->app->parsed() ? first_unknown(*command) : "";
    if (!unknown.empty())
      throw usage_error(
          fmt::format("{} does not know '{}'", command->verb->name, unknown),
          suggestion(unknown.substr(unknown.find_first_not_of('-') == std::string::npos
                                        ? 0
                                        : unknown.find_first_not_of('-')),
                     flag_names(*command)));
  }
  std::vector<std::string> names;
  for (const auto& command : commands) names.push_back(command->verb->name);
  if (argc > 1 && std::ranges::find(names, argv[1]) == names.end())
    throw usage_error(fmt::format("there is no verb '{}'", argv[1]), suggestion(argv[1], names));
  throw usage_error(error.what(), "see touchtrace --help");
}

ExitCode dispatch(const Program& program, int argc, const char* const* argv) {
  if (argc == 2 && std::string_view(argv[1]) == compile_kernels) {
    compile_from_stdin();
    return ExitCode::done;
  }
  offer_compiler_process({compile_kernels});
  CLI::App root{program.summary, program.name};
  root.footer(exit_codes);
  root.set_version_flag("--version", version);
  root.require_subcommand(1);
  const auto commands = make_commands(program, root);
  try {
    root.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return root.exit(success) == 0 ? ExitCode::done : ExitCode::usage;
  } catch (const CLI::ParseError& error) {
    throw_usage(error, commands, argc, argv);
  }
  for (const auto& command : commands)
    if (command->app->parsed()) return run(*command);
  return ExitCode::usage;
}

int report(ExitCode code, const std::string& problem, const std::string& remedy) {
  fmt::print(stderr, "touchtrace: {}\n", problem);
  if (!remedy.empty()) fmt::print(stderr, "  what to do: {}\n", remedy);
  return static_cast<int>(code);
}

}  // namespace

int run_command_line(const Program& program, int argc, const char* const* argv) {
  catch_interrupts();
  try {
    const ExitCode code = dispatch(program, argc, argv);
    if (std::fflush(stdout) != 0)
      throw failure("standard output cannot be written", "check the disk");
    return static_cast<int>(code);
  } catch (const Error& error) {
    return report(error.code(), error.what(), error.remedy());
  } catch (const std::bad_alloc&) {
    return report(ExitCode::failed, "out of memory", "use fewer or smaller inputs");
  } catch (const std::exception& error) {
    return report(ExitCode::failed, error.what(),
                  "this is a fault of touchtrace; please report it");
  }
}

}  // namespace touchtrace::cli
