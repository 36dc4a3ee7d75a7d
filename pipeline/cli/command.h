#pragma once

#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/options.h"

namespace touchtrace::cli {

/// Options that several commands share. Each command lists only those that affect it.
struct CommonOptions {
  bool device = false;     ///< --device: the command uses OpenCL
  bool overwrite = false;  ///< --overwrite: the command writes files
  bool quiet = false;      ///< --quiet: the command reports progress
  bool json = true;        ///< --json
};

/// Values of the common options, and of the command's own options for the provenance.
struct Invocation {
  bool json = false;       ///< print one JSON document on stdout and nothing else
  bool overwrite = false;  ///< replace existing output files
  std::string device;      ///< number, type or part of a name; empty: the fastest usable device
  nlohmann::json options;  ///< values of the command's options, defaults included
};

/// Command of a program. `describe` resets and describes its options; `run` reads them.
struct Command {
  std::string name, summary;  ///< summary: starts with an imperative in lower case, no full stop
  std::vector<std::string> examples;
  std::function<void(OptionSet&)> describe;
  std::function<ExitCode(const Invocation&)> run;
  CommonOptions common = {};
};

/// Command whose options are a struct `Options` with a function `describe(OptionSet&, Options&)`.
template <class Options>
Command make_command(std::string name, std::string summary, std::vector<std::string> examples,
                     ExitCode (*run)(const Options&, const Invocation&),
                     CommonOptions common = {}) {
  auto options = std::make_shared<Options>();
  return {std::move(name),
          std::move(summary),
          std::move(examples),
          [options](OptionSet& set) { describe(set, *options = Options{}); },
          [options, run](const Invocation& invocation) { return run(*options, invocation); },
          common};
}

/// Commands under one heading of the help.
struct CommandGroup {
  std::string heading;
  std::vector<Command> commands;
};

/// What replaces a former command.
struct MovedCommand {
  std::string place, hint;
};

struct Program {
  std::string name, summary;
  std::vector<CommandGroup> groups;
  std::map<std::string, MovedCommand> moved;  ///< by the former command's name
};

/// Parses and runs a command line; prints errors with their hints to stderr. Returns the exit code.
int run_command_line(const Program& program, int argc, const char* const* argv);

}  // namespace touchtrace::cli
