#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/options.h"

namespace touchtrace::cli {

/// Sets every option that the table [command] of a TOML file names, except those in `given`. Throws
/// usage_error, with the nearest name, for an unknown key, and for a value of the wrong type.
void apply_configuration(const std::filesystem::path& file, const std::string& command,
                         OptionSet& options, const std::vector<std::string>& given);

}  // namespace touchtrace::cli
