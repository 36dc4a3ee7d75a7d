#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>

namespace touchtrace::testing {

/// Path of a folder for the running test only: tests run concurrently in their own processes, also
/// those of other checkouts.
inline std::filesystem::path scratch_folder() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name =
      std::string("touchtrace_") + test->test_suite_name() + "_" + test->name() + "_";
  const auto executable = std::filesystem::read_symlink("/proc/self/exe").string();
  name += std::to_string(std::hash<std::string>()(executable));
  std::ranges::replace(name, '/', '_');
  return std::filesystem::temp_directory_path() / name;
}

}  // namespace touchtrace::testing
