#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/sweep/command_table.h"

namespace touchtrace::sweep {

/// Hash of the contents if `value` is the path of a file or folder, else `value`. Labels
/// X.labels.h5 next to a recording X.h5 are part of its contents.
nlohmann::json outside_identity(const nlohmann::json& value);

/// "train-" and the start of the SHA-256 of command, option values (defaults included) and program
/// version. `identity`: options by key, with ids or hashes in place of paths.
std::string cell_id(const std::string& command, const nlohmann::json& identity,
                    const std::vector<Option>& options, const CommandTable& commands);

}  // namespace touchtrace::sweep
