#pragma once

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/files.h"
#include "tests/support/command_line.h"

namespace touchtrace::testing {

inline const std::filesystem::path photographs = "/usr/share/doc/opencv-doc/examples/data";

inline int run_calibrate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "calibrate");
  return run_touchtrace(std::move(arguments));
}

/// A grey picture in PGM, without a board.
inline void write_grey(const std::filesystem::path& path, int width, int height) {
  const std::string pixels(static_cast<std::size_t>(width * height), '\x80');
  write_file(path, fmt::format("P5\n{} {}\n255\n", width, height) + pixels, false);
}

}  // namespace touchtrace::testing
