#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "pipeline/cli/doctor.h"

namespace touchtrace::cli {
namespace {

namespace fs = std::filesystem;

constexpr double recommended_gib = 20.0;  // 1 h of compressed 640x480 RGB-D at 20 Hz
constexpr double min_gib = 5.0;           // scripts/demo
constexpr double bytes_per_gib = 1024.0 * 1024.0 * 1024.0;

Finding check_space(const fs::path& folder) {
  std::error_code error;
  const auto space = fs::space(folder, error);
  if (error)
    return {Finding::State::broken, fmt::format("{}: {}", folder.string(), error.message()),
            "check that the directory exists and is readable"};
  const double free_gib = static_cast<double>(space.available) / bytes_per_gib;
  const std::string what = fmt::format("{:.1f} GiB free in {}", free_gib, folder.string());
  if (free_gib < min_gib)
    return {Finding::State::broken, what,
            fmt::format("free disk space: scripts/demo needs {:.0f} GiB", min_gib)};
  if (free_gib < recommended_gib)
    return {Finding::State::advice, what,
            fmt::format("one hour of video needs about {:.0f} GiB", recommended_gib)};
  return {Finding::State::good, what, ""};
}

fs::path cache_home() {
  if (const char* folder = std::getenv("XDG_CACHE_HOME")) return folder;
  const char* home = std::getenv("HOME");
  return fs::path(home ? home : "/tmp") / ".cache";
}

/// POCL_CACHE_DIR needs a check of its own: PoCL aborts the process if it is empty.
Finding check_kernel_cache() {
  const char* given = std::getenv("POCL_CACHE_DIR");
  if (given && !*given)
    return {Finding::State::broken, "POCL_CACHE_DIR is empty: PoCL aborts", "unset POCL_CACHE_DIR"};
  const fs::path cache = given ? fs::path(given) : cache_home();
  const fs::path folder = fs::exists(cache) ? cache : cache.parent_path();
  if (access(folder.c_str(), W_OK) != 0)
    return {
        Finding::State::advice,
        fmt::format("{} is not writable: PoCL compiles kernels again in each run", folder.string()),
        "set POCL_CACHE_DIR to a writable directory"};
  return {Finding::State::good, fmt::format("kernel cache in {}", cache.string()), ""};
}

}  // namespace

std::vector<Finding> check_disk() {
  return {check_space(fs::current_path()), check_kernel_cache()};
}

}  // namespace touchtrace::cli
