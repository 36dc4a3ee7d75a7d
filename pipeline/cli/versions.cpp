#include "pipeline/cli/versions.h"

#include <ceres/version.h>
#include <fmt/core.h>
#include <hdf5.h>
#include <libusb.h>

#include <Eigen/Core>
#include <opencv2/core/utility.hpp>

#include "engine/base/child_process.h"
#include "engine/base/version.h"
#include "engine/cl/device.h"

// Written by scripts/cmake/WriteCommit.cmake.
#if __has_include("generated/commit.h")
#include "generated/commit.h"
#else
#define TOUCHTRACE_COMMIT "unknown"
#endif

namespace touchtrace::cli {
namespace {

constexpr double driver_limit_s = 10.0;

std::string library_versions() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  const libusb_version& usb = *libusb_get_version();
  return fmt::format(
      "Ceres    {}\nOpenCV   {}\nHDF5     {}.{}.{}\nEigen    {}.{}.{}\nlibusb   {}.{}.{}\n",
      CERES_VERSION_STRING, cv::getVersionString(), major, minor, release, EIGEN_WORLD_VERSION,
      EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION, usb.major, usb.minor, usb.micro);
}

std::string devices_or_reason() {
  const auto child = run_self({print_opencl_versions}, {}, driver_limit_s);
  if (!child.succeeded()) return fmt::format("OpenCL   listing the devices {}\n", child.ending());
  return child.output.empty() ? "OpenCL   no device\n" : child.output;
}

}  // namespace

std::string program_version() { return fmt::format("{} (commit {})", version, TOUCHTRACE_COMMIT); }

std::string version_text(const std::string& program) {
  return fmt::format("{} {}\n{}{}", program, program_version(), devices_or_reason(),
                     library_versions());
}

std::string opencl_versions() {
  std::string text;
  for (const auto& info : list_devices()) {
    const cl::Platform platform(info.handle.getInfo<CL_DEVICE_PLATFORM>());
    text += fmt::format("OpenCL   {}: {}; {}; driver {}\n", info.number, info.name,
                        platform.getInfo<CL_PLATFORM_VERSION>(), info.driver);
  }
  return text;
}

}  // namespace touchtrace::cli
