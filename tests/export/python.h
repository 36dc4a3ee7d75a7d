#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace touchtrace::testing {

struct PythonResult {
  int status;
  std::string output;  ///< stdout and stderr
};

/// Python with the libraries of other programs: $TOUCHTRACE_PYTHON, or Debian's, which has numpy
/// and h5py.
inline std::string python() {
  const char* chosen = std::getenv("TOUCHTRACE_PYTHON");
  return chosen ? chosen : "/usr/bin/python3";
}

inline PythonResult run_python(const std::string& arguments) {
  FILE* pipe = popen((python() + " " + arguments + " 2>&1").c_str(), "r");
  if (!pipe) return {-1, "popen failed"};
  PythonResult result{-1, {}};
  for (int c; (c = std::fgetc(pipe)) != EOF;) result.output += static_cast<char>(c);
  result.status = pclose(pipe);
  return result;
}

/// Expects that Python runs `code` in a folder, with json, h5py, and numpy as np.
inline void expect_python(const std::filesystem::path& folder, const std::string& code) {
  std::ofstream(folder / "code.py")
      << "import os, json, h5py, numpy as np\nos.chdir('" << folder.string() << "')\n"
      << code << '\n';
  const PythonResult result = run_python((folder / "code.py").string());
  EXPECT_EQ(result.status, 0) << result.output;
}

/// Runs tests/export/NAME with arguments.
inline PythonResult run_script(const std::string& name, const std::string& arguments) {
  return run_python(fmt::format("{}/tests/export/{} {}", TOUCHTRACE_SOURCE_DIR, name, arguments));
}

inline bool can_import(const std::string& modules) {
  return run_python("-c 'import " + modules + "'").status == 0;
}

}  // namespace touchtrace::testing

/// Skips the test unless Python has these modules.
#define SKIP_WITHOUT_MODULES(modules)                                 \
  if (!touchtrace::testing::can_import(modules))                      \
  GTEST_SKIP() << touchtrace::testing::python() << " has no " modules \
               << "; set TOUCHTRACE_PYTHON to one that has (pip install)"
