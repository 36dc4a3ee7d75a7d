#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/options.h"

namespace touchtrace::cli {

/// Sets the options that the table [command] of a TOML file names, except those in `given`.
/// Tables of other commands are ignored. Throws usage_error for a table that is not in
/// `command_names`, a key outside any table, an unknown key, or a value of the wrong type.
void apply_configuration(const std::filesystem::path& file,
                         const std::vector<std::string>& command_names, const std::string& command,
                         const std::vector<Option>& options, const std::vector<std::string>& given);

}  // namespace touchtrace::cli
