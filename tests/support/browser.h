#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "engine/base/files.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace::testing {

/// Path to a Chromium or Chrome, empty if none is installed.
inline std::string find_browser() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
    for (const char* folder : {"/usr/bin/", "/usr/local/bin/", "/snap/bin/"})
      if (std::filesystem::exists(std::string(folder) + name)) return std::string(folder) + name;
  return {};
}

struct Loaded {
  std::string dom, console;
};

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Loads a page and runs `script` after the page's own scripts.
inline Loaded load(const TemporaryFolder& folder, const std::string& page,
                   const std::string& script = "") {
  put(folder / "page.html", replaced(page, "</body>", "<script>" + script + "</script></body>"));
  const std::string command = fmt::format(
      "timeout 120 {0} --headless --no-sandbox --disable-gpu --disable-dev-shm-usage "
      "--enable-logging=stderr --v=0 --user-data-dir={1}/profile --dump-dom file://{1}/page.html "
      ">{1}/dom.html 2>{1}/console.txt",
      find_browser(), folder.path().string());
  EXPECT_EQ(std::system(command.c_str()), 0) << read_file(folder / "console.txt");
  return {read_file(folder / "dom.html"), read_file(folder / "console.txt")};
}

}  // namespace touchtrace::testing
