#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "pipeline/cli/doctor.h"

namespace touchtrace::cli {
namespace {

namespace fs = std::filesystem;

/// An hour of 640x480 RGBD at 20 Hz, compressed.
constexpr double wanted_gib = 20.0;
constexpr double least_gib = 5.0;
constexpr double bytes_per_gib = 1024.0 * 1024.0 * 1024.0;

Finding check_room(const fs::path& folder) {
  std::error_code error;
  const auto space = fs::space(folder, error);
  if (error)
    return {Finding::State::broken, fmt::format("{}: {}", folder.string(), error.message()),
            "check the folder"};
  const double free_gib = static_cast<double>(space.available) / bytes_per_gib;
  const std::string what = fmt::format("{:.1f} GiB free in {}", free_gib, folder.string());
  if (free_gib < least_gib)
    return {Finding::State::broken, what,
            fmt::format("free some room; the demo needs {:.0f} GiB", least_gib)};
  if (free_gib < wanted_gib)
    return {Finding::State::advice, what,
            fmt::format("an hour of video needs about {:.0f} GiB", wanted_gib)};
  return {Finding::State::good, what, ""};
}

/// PoCL aborts the process when POCL_CACHE_DIR is set and empty.
Finding check_kernel_cache() {
  const char* given = std::getenv("POCL_CACHE_DIR");
  if (given && !*given)
    return {Finding::State::broken, "POCL_CACHE_DIR is set but empty: PoCL aborts",
            "unset POCL_CACHE_DIR"};
  const char* home = std::getenv("HOME");
  const fs::path cache = given ? fs::path(given) : fs::path(home ? home : "/tmp") / ".cache";
  const fs::path folder = fs::exists(cache) ? cache : cache.parent_path();
  if (access(folder.c_str(), W_OK) != 0)
    return {Finding::State::advice,
            fmt::format("{} cannot be written: kernels are built anew each run", folder.string()),
            "set POCL_CACHE_DIR to a folder that can be written"};
  return {Finding::State::good, fmt::format("kernel cache in {}", cache.string()), ""};
}

}  // namespace

std::vector<Finding> check_disk() { return {check_room(fs::current_path()), check_kernel_cache()}; }

}  // namespace touchtrace::cli
