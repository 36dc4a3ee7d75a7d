#include "engine/base/toml_file.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/files.h"

namespace touchtrace {

toml::table read_toml_file(const std::filesystem::path& file) {
  try {
    return toml::parse(read_file(file, 1 << 20), file.string());
  } catch (const toml::parse_error& error) {
    throw usage_error(
        fmt::format("{}:{}: {}", file.string(), error.source().begin.line, error.description()),
        "write it in TOML 1.0");
  }
}

}  // namespace touchtrace
