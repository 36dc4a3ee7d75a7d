#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "pipeline/sweep/command_table.h"

namespace touchtrace::sweep {

/// One value of an axis: its name in results and the options that it sets.
struct AxisValue {
  nlohmann::json label, options;
};

struct Axis {
  std::string name;
  std::vector<AxisValue> values;
};

/// One command with its options; a cell is run for every combination of its axes.
struct Stage {
  std::string name, command;
  std::string output;  ///< name in the folder of the cell; empty if the command writes no file
  nlohmann::json options = nlohmann::json::object();  ///< by key; "@stage" stands for its output
  std::vector<Axis> axes;           ///< own axes; those of referenced stages are added
  std::vector<std::string> gather;  ///< axes whose values one cell takes together
};

/// Stages in the order of the file; each refers to earlier ones only.
struct Study {
  std::vector<Stage> stages;
};

/// Reads a study from a TOML file, or makes one of commands (command_chain.h). `changes`:
/// "STAGE.OPTION=VALUE[,VALUE...]", where FIRST:LAST is a range of whole numbers; of commands
/// without STAGE the first that has this option. Throws usage_error for what is not a study.
Study read_study(const std::string& source, const std::vector<std::string>& changes,
                 const CommandTable& commands);

/// Text of a reference: "@train" is {"train", ""}, "@simulate.seed" is {"simulate", "seed"}.
struct Reference {
  std::string stage, key;
};
bool is_reference(const nlohmann::json& value);
Reference parse_reference(const nlohmann::json& value);

/// Calls `body` and puts `where` before the message of an Error.
template <class Body>
auto with_context(const std::string& where, Body body) {
  try {
    return body();
  } catch (const Error& error) {
    throw Error(error.code(), where + ": " + error.what(), error.hint());
  }
}

}  // namespace touchtrace::sweep
