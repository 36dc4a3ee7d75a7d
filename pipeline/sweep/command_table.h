#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/options.h"

namespace touchtrace::sweep {

/// The program's commands, as a study needs them.
struct CommandTable {
  std::string version;  ///< of the program, with its commit
  /// Options of a command, common ones included. Throws usage_error for an unknown command.
  std::function<std::vector<Option>(const std::string& command)> options;
  /// Values of a command's options by key, defaults included. Throws usage_error for arguments that
  /// the command refuses.
  std::function<nlohmann::json(const std::string& command,
                               const std::vector<std::string>& arguments)>
      values;
};

/// Option with a key; null if there is none.
const Option* find_option(const std::vector<Option>& options, const std::string& key);

/// Command-line arguments that set options to values given by key. Throws usage_error for a value
/// of the wrong type.
std::vector<std::string> arguments_of(const std::vector<Option>& options,
                                      const nlohmann::json& given);

/// Name of the file or folder that a command writes into the folder of its cell.
std::string default_output(const std::string& command);

}  // namespace touchtrace::sweep
