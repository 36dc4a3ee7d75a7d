#include "pipeline/cli/usable_device.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include "engine/base/child_process.h"
#include "engine/base/error.h"

namespace touchtrace::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* vendors_variable = "OCL_ICD_VENDORS";
constexpr const char* default_vendors = "/etc/OpenCL/vendors";
// A driver that takes longer to compile the kernels of one operation counts as hanging.
constexpr double compile_limit_s = 20.0;

/// Returns the .icd files in a folder, or `vendors` itself if it is a driver.
std::vector<fs::path> drivers_in(const fs::path& vendors) {
  std::error_code missing;
  if (!fs::is_directory(vendors, missing)) return {vendors};
  std::vector<fs::path> drivers;
  for (const auto& entry : fs::directory_iterator(vendors, missing))
    if (entry.path().extension() == ".icd") drivers.push_back(entry.path());
  return drivers;
}

bool is_pocl(const fs::path& driver) {
  std::string line = driver.string();
  if (driver.extension() == ".icd") std::getline(std::ifstream(driver) >> std::ws, line);
  return fs::path(line).filename().string().find("pocl") != std::string::npos;
}

bool only_pocl_is_installed() {
  for (const char* variable : {"OPENCL_VENDOR_PATH", "OCL_ICD_FILENAMES"})
    if (std::getenv(variable)) return false;
  const char* vendors = std::getenv(vendors_variable);
  return std::ranges::all_of(drivers_in(vendors ? vendors : default_vendors), is_pocl);
}

/// Makes the ICD loader of this process load only PoCL. Returns false if PoCL is not installed.
bool leave_only_pocl() {
  const char* vendors = std::getenv(vendors_variable);
  for (const char* folder : {vendors, default_vendors}) {
    if (!folder) continue;
    const auto drivers = drivers_in(folder);
    const auto pocl = std::ranges::find_if(drivers, is_pocl);
    if (pocl != drivers.end()) return setenv(vendors_variable, pocl->c_str(), 1) == 0;
  }
  return false;
}

/// Returns the last line of the test's output: the failure.
std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.find_last_of('\n') + 1);
}

ChosenDevice fall_back_to_pocl(const std::string& failure) {
  const auto reason = fmt::format("the default OpenCL device is refused: {}", failure);
  if (!leave_only_pocl())
    throw device_error(reason,
                       "install PoCL, which runs on any CPU: apt-get install pocl-opencl-icd");
  auto chosen = choose_device("");
  fmt::print(stderr, "warning: {}; using {} instead\n", reason, chosen.info.name);
  chosen.reason = reason;
  return chosen;
}

}  // namespace

ChosenDevice usable_device(const std::string& selector) {
  if (only_pocl_is_installed()) return choose_device(selector);
  const auto test =
      run_self({"self-test", "--trust-pocl", "--device", selector}, {}, compile_limit_s);
  const bool no_such_device = test.exit_code == static_cast<int>(ExitCode::no_device);
  if (test.succeeded() || no_such_device) return choose_device(selector);
  const auto failure = test.exit_code == static_cast<int>(ExitCode::data)
                           ? last_line(test.output)
                           : fmt::format("its test {}", test.ending());
  if (selector.empty()) return fall_back_to_pocl(failure);
  throw device_error(fmt::format("OpenCL device '{}' is refused: {}", selector, failure),
                     "choose another device of `touchtrace devices`, or omit --device to use PoCL");
}

ChosenDevice usable_device_for_small_steps(const std::string& selector) {
  if (!selector.empty()) return usable_device(selector);
  return only_pocl_is_installed() || leave_only_pocl() ? choose_device_for_small_steps()
                                                       : usable_device(selector);
}

}  // namespace touchtrace::cli
