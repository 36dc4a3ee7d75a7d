#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "engine/base/interrupt.h"
#include "engine/base/progress.h"
#include "engine/base/text.h"
#include "engine/base/version.h"
#include "engine/cl/compiler_process.h"
#include "pipeline/cli/command.h"
#include "pipeline/cli/configuration.h"

namespace touchtrace::cli {
namespace {

// What this program calls itself with to compile kernels beside itself: no command, since it is of
// no use to anybody else.
constexpr const char* compile_kernels = "compile-kernels";

constexpr const char* exit_codes =
    "Exit codes: 0 done, 1 failed, 2 usage, 3 data or quality gate, 4 no device, 130 interrupted";

/// A command as CLI11 sees it, with everything that must outlive the parsing.
struct Subcommand {
  const Command* command;
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

void bind_common(Subcommand& subcommand) {
  CLI::App& app = *subcommand.app;
  app.add_option("--config", subcommand.configuration_file,
                 "TOML file with keys like these flags; flags win over it");
  app.add_option("--device", subcommand.invocation.device,
                 "OpenCL device: number, type or part of a name (see touchtrace devices)");
  app.add_flag("--json", subcommand.invocation.json, "print one JSON document on stdout");
  app.add_flag("--overwrite", subcommand.invocation.overwrite, "replace outputs that exist");
  app.add_flag("--quiet", subcommand.quiet, "no progress on stderr");
}

std::string examples_text(const Command& command) {
  std::string text = "Examples:\n";
  for (const auto& example : command.examples) text += "  " + example + "\n";
  return text + exit_codes;
}

std::vector<std::unique_ptr<Subcommand>> make_subcommands(const Program& program, CLI::App& root) {
  std::vector<std::unique_ptr<Subcommand>> subcommands;
  for (const auto& command : program.commands) {
    auto subcommand = std::make_unique<Subcommand>();
    subcommand->command = &command;
    subcommand->app = root.add_subcommand(command.name, command.summary);
    subcommand->app->footer(examples_text(command));
    command.describe(subcommand->options);
    for (const auto& option : subcommand->options.options()) bind(*subcommand->app, option);
    bind_common(*subcommand);
    subcommands.push_back(std::move(subcommand));
  }
  return subcommands;
}

std::vector<std::string> flag_names(const Subcommand& subcommand) {
  std::vector<std::string> names{"config", "device", "json", "overwrite", "quiet"};
  for (const auto& name : subcommand.options.names()) names.push_back(name);
  return names;
}

/// The flags that were given, so that the configuration file does not change them.
std::vector<std::string> given(const Subcommand& subcommand) {
  std::vector<std::string> names;
  for (const auto& option : subcommand.options.options()) {
    const auto* flag =
        subcommand.app->get_option_no_throw(option.positional ? option.name : "--" + option.name);
    if (flag && flag->count() > 0) names.push_back(option.name);
  }
  return names;
}

ExitCode run(Subcommand& subcommand) {
  if (subcommand.quiet) Progress::silence();
  if (!subcommand.configuration_file.empty())
    apply_configuration(subcommand.configuration_file, subcommand.command->name, subcommand.options,
                        given(subcommand));
  subcommand.options.validate();
  subcommand.invocation.options = subcommand.options.values();
  return subcommand.command->run(subcommand.invocation);
}

std::string first_unknown(const Subcommand& subcommand) {
  const auto rest = subcommand.app->remaining();
  return rest.empty() ? std::string() : rest.front();
}

/// Unknown flags and commands get a suggestion; CLI11 alone would not make one.
[[noreturn]] void throw_usage(const CLI::ParseError& error,
                              const std::vector<std::unique_ptr<Subcommand>>& subcommands, int argc,
                              const char* const* argv) {
  for (const auto& subcommand : subcommands) {
    const std::string unknown = subcommand->app->parsed() ? first_unknown(*subcommand) : "";
    if (!unknown.empty())
      throw usage_error(
          fmt::format("{} does not know '{}'", subcommand->command->name, unknown),
          suggestion(unknown.substr(unknown.find_first_not_of('-') == std::string::npos
                                        ? 0
                                        : unknown.find_first_not_of('-')),
                     flag_names(*subcommand)));
  }
  std::vector<std::string> names;
  for (const auto& subcommand : subcommands) names.push_back(subcommand->command->name);
  if (argc > 1 && std::ranges::find(names, argv[1]) == names.end())
    throw usage_error(fmt::format("there is no command '{}'", argv[1]), suggestion(argv[1], names));
  throw usage_error(error.what(), "see touchtrace --help");
}

ExitCode dispatch(const Program& program, int argc, const char* const* argv) {
  if (argc == 2 && std::string_view(argv[1]) == compile_kernels) {
    compile_from_stdin();
    return ExitCode::done;
  }
  register_compiler_arguments({compile_kernels});
  CLI::App root{program.summary, program.name};
  root.footer(exit_codes);
  root.set_version_flag("--version", version);
  root.require_subcommand(1);
  const auto subcommands = make_subcommands(program, root);
  try {
    root.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return root.exit(success) == 0 ? ExitCode::done : ExitCode::usage;
  } catch (const CLI::ParseError& error) {
    throw_usage(error, subcommands, argc, argv);
  }
  for (const auto& subcommand : subcommands)
    if (subcommand->app->parsed()) return run(*subcommand);
  return ExitCode::usage;
}

int report(ExitCode code, const std::string& problem, const std::string& hint) {
  fmt::print(stderr, "touchtrace: {}\n", problem);
  if (!hint.empty()) fmt::print(stderr, "  hint: {}\n", hint);
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
    return report(error.code(), error.what(), error.hint());
  } catch (const std::bad_alloc&) {
    return report(ExitCode::failed, "out of memory", "use fewer or smaller inputs");
  } catch (const std::exception& error) {
    return report(ExitCode::failed, error.what(),
                  "this is a fault of touchtrace; please report it");
  }
}

}  // namespace touchtrace::cli
