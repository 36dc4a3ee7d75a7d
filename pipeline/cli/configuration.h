#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/options.h"

namespace touchtrace::cli {

/// Sets the options that the table [command] of a TOML file names, except those in `given`.
/// Tables of other commands are ignored. Throws usage_error with all faults: tables that are not in
/// `command_names`, keys outside any table, unknown keys, and values of the wrong type.
void apply_configuration(const std::filesystem::path& file,
                         const std::vector<std::string>& command_names, const std::string& command,
                         const std::vector<Option>& options, const std::vector<std::string>& given);

}  // namespace touchtrace::cli
