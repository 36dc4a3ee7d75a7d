#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/sweep/study.h"

namespace touchtrace::sweep {

/// One run of a command. Cells with equal command, options, inputs and program version have the
/// same id and share a folder.
struct Cell {
  std::string stage, command;
  std::string id;                                  ///< "train-" and 16 hexadecimal digits
  nlohmann::json axes = nlohmann::json::object();  ///< value of every axis by name
  nlohmann::json options;                          ///< as given, with paths for references
  std::vector<std::string> arguments;              ///< of the command
  std::string version;                             ///< CommandTable::version
  std::vector<std::size_t> inputs;                 ///< indices of the cells that must be done first
  std::filesystem::path folder, output;            ///< output: what a reference "@stage" stands for
  bool can_resume = false;                         ///< the command has --resume

  std::filesystem::path result() const { return folder / "result.json"; }
  bool is_done() const { return std::filesystem::exists(result()); }
  /// File with the message of the last run if that has failed.
  std::filesystem::path failure() const { return folder / "failed.txt"; }
  std::filesystem::path log() const { return folder / "log.txt"; }
  /// "train activity=throw seed=1"
  std::string name() const;
};

/// Cells of a study whose outputs lie in `root`/cells, inputs before those that need them. Checks
/// all options. Throws usage_error.
std::vector<Cell> expand(const Study& study, const CommandTable& commands,
                         const std::filesystem::path& root);

}  // namespace touchtrace::sweep
