#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "engine/base/files.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace::testing {

/// Path to a Chromium or Chrome, empty if none is installed (Debian: apt-get install chromium).
inline std::string find_browser() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
    for (const char* folder : {"/usr/bin/", "/usr/local/bin/", "/snap/bin/"})
      if (std::filesystem::exists(std::string(folder) + name)) return std::string(folder) + name;
  return {};
}

struct LoadedPage {
  std::string dom, console;
};

/// Loads a page in a headless browser. `folder`: for files of the browser.
inline LoadedPage load_page(const std::string& url, const std::filesystem::path& folder,
                            const std::string& more_options = "") {
  const std::string command = fmt::format(
      "timeout 120 {0} --headless --no-sandbox --disable-gpu --disable-dev-shm-usage "
      "--enable-logging=stderr --v=0 --user-data-dir={1}/profile {2} --dump-dom '{3}' "
      ">{1}/dom.html 2>{1}/console.txt",
      find_browser(), folder.string(), more_options, url);
  EXPECT_EQ(std::system(command.c_str()), 0) << read_file(folder / "console.txt");
  return {read_file(folder / "dom.html"), read_file(folder / "console.txt")};
}

/// Headless browser on a page, in real time, until destruction.
class OpenBrowser {
 public:
  OpenBrowser(const std::string& url, std::filesystem::path folder) : folder_(std::move(folder)) {
    const std::string command = fmt::format(
        "timeout 120 {0} --headless --no-sandbox --disable-gpu --disable-dev-shm-usage "
        "--remote-debugging-port=0 --user-data-dir={1}/profile '{2}' >{1}/console.txt 2>&1 & "
        "echo $! >{1}/pid",
        find_browser(), folder_.string(), url);
    EXPECT_EQ(std::system(command.c_str()), 0);
  }
  ~OpenBrowser() {
    const std::string command = fmt::format(
        "pid=$(cat {}/pid); kill $pid; while kill -0 $pid 2>/dev/null; do sleep 0.05; done",
        folder_.string());
    EXPECT_EQ(std::system(command.c_str()), 0);
  }
  OpenBrowser(const OpenBrowser&) = delete;
  OpenBrowser& operator=(const OpenBrowser&) = delete;

 private:
  std::filesystem::path folder_;
};

/// `text` with the first `from` replaced, which must be there.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// Loads the page with this HTML and runs `script` after the page's own scripts.
inline LoadedPage load(const TemporaryFolder& folder, const std::string& html,
                       const std::string& script = "") {
  put(folder / "page.html", replaced(html, "</body>", "<script>" + script + "</script></body>"));
  return load_page("file://" + (folder / "page.html").string(), folder.path());
}

}  // namespace touchtrace::testing
