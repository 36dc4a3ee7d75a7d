#pragma once

#include <toml++/toml.h>

#include <filesystem>

namespace touchtrace {

/// Reads a TOML file that a user wrote. Throws usage_error with file and line if it is not TOML.
toml::table read_toml_file(const std::filesystem::path& file);

}  // namespace touchtrace
