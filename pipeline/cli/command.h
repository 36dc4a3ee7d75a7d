#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/options.h"

namespace touchtrace::cli {

/// What every command is given beside its own options.
struct Invocation {
  bool json = false;       ///< --json: stdout carries one JSON document and nothing else
  bool overwrite = false;  ///< --overwrite: outputs that exist are replaced
  std::string device;      ///< --device: number, type or part of a name; empty: the fastest usable
  nlohmann::json options;  ///< the command's options as given, for the provenance
};

/// One command of the command line. `describe` binds its options struct, `run` reads it afterwards.
struct Command {
  std::string name, summary;
  std::vector<std::string> examples;
  std::function<void(OptionSet&)> describe;
  std::function<ExitCode(const Invocation&)> run;
};

/// A command whose options live in a struct `Options` with a free function `describe(OptionSet&,
/// Options&)`.
template <class Options>
Command make_command(std::string name, std::string summary, std::vector<std::string> examples,
                     ExitCode (*run)(const Options&, const Invocation&)) {
  auto options = std::make_shared<Options>();
  return {std::move(name), std::move(summary), std::move(examples),
          [options](OptionSet& set) { describe(set, *options = Options{}); },
          [options, run](const Invocation& invocation) { return run(*options, invocation); }};
}

/// A program with commands.
struct Program {
  std::string name, summary;
  std::vector<Command> commands;
};

/// Parses and runs a command line; prints errors and their hints to stderr. Returns the exit code.
int run_command_line(const Program& program, int argc, const char* const* argv);

}  // namespace touchtrace::cli
