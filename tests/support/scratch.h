#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace touchtrace::testing {

/// Number of the test process, also in processes that it starts: a death test runs the program
/// again and shares files with it. Set before main(), when no thread reads the environment.
inline const std::string test_process = [] {
  constexpr const char* variable = "TOUCHTRACE_TEST_PROCESS";
  setenv(variable, std::to_string(getpid()).c_str(), false);
  return std::string(std::getenv(variable));
}();

/// Path of a folder for the running test only: tests run concurrently in their own processes, also
/// those of copies of this checkout.
inline std::filesystem::path scratch_folder() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name =
      std::string("touchtrace_") + test->test_suite_name() + "_" + test->name() + "_";
  name += test_process;
  std::ranges::replace(name, '/', '_');
  return std::filesystem::temp_directory_path() / name;
}

}  // namespace touchtrace::testing
