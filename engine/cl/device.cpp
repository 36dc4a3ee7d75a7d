#include "engine/cl/device.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

std::string type_name(cl_device_type type) {
  if (type & CL_DEVICE_TYPE_GPU) return "gpu";
  return type & CL_DEVICE_TYPE_CPU ? "cpu" : "accelerator";
}

/// Empty if the driver reports an error.
std::vector<cl::Device> devices_of(const cl::Platform& platform) {
  std::vector<cl::Device> devices;
  try {
    platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
  } catch (const cl::Error&) {
    devices.clear();
  }
  return devices;
}

DeviceInfo describe(int number, const cl::Platform& platform, const cl::Device& device) {
  DeviceInfo info;
  info.number = number;
  info.name = device.getInfo<CL_DEVICE_NAME>();
  info.vendor = device.getInfo<CL_DEVICE_VENDOR>();
  info.platform = platform.getInfo<CL_PLATFORM_NAME>();
  info.driver = device.getInfo<CL_DRIVER_VERSION>();
  info.type = type_name(device.getInfo<CL_DEVICE_TYPE>());
  info.compute_units = static_cast<int>(device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>());
  info.memory_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  info.has_doubles = device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0;
  info.is_pocl = info.platform.find("Portable Computing Language") != std::string::npos;
  info.handle = device;
  return info;
}

/// GPUs before accelerators before CPUs, then by compute units.
bool slower(const DeviceInfo& a, const DeviceInfo& b) {
  const auto rank = [](const DeviceInfo& info) {
    return info.type == "gpu" ? 2 : info.type == "accelerator" ? 1 : 0;
  };
  return std::pair(rank(a), a.compute_units) < std::pair(rank(b), b.compute_units);
}

std::string list_text(const std::vector<DeviceInfo>& devices) {
  std::string text;
  for (const auto& info : devices)
    text += fmt::format("\n  {}: {} ({})", info.number, info.name, info.type);
  return text;
}

}  // namespace

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> found;
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    return found;
  }
  for (const auto& platform : platforms) {
    for (const auto& device : devices_of(platform)) {
      try {
        found.push_back(describe(static_cast<int>(found.size()), platform, device));
      } catch (const cl::Error&) {
        continue;
      }
    }
  }
  return found;
}

const DeviceInfo* find_device(const std::vector<DeviceInfo>& devices, const std::string& selector) {
  const auto find = [&](auto matches) {
    const auto found = std::ranges::find_if(devices, matches);
    return found == devices.end() ? nullptr : &*found;
  };
  if (selector.find_first_not_of("0123456789") == std::string::npos)
    return find([&](const auto& info) { return selector == std::to_string(info.number); });
  if (const auto* info = find([&](const auto& i) { return i.type == lower_case(selector); }))
    return info;
  return find([&](const auto& info) {
    return lower_case(info.name + " " + info.platform).find(lower_case(selector)) !=
           std::string::npos;
  });
}

ChosenDevice choose_device(const std::string& selector) {
  const auto devices = list_devices();
  if (devices.empty())
    throw device_error("no OpenCL device found",
                       "install PoCL, which runs on any CPU: apt-get install pocl-opencl-icd");
  if (selector.empty()) {
    const auto& best = *std::ranges::max_element(devices, slower);
    return {best,
            best.type == "cpu" ? "no OpenCL GPU found, using the CPU" : "fastest OpenCL device"};
  }
  if (const auto* info = find_device(devices, selector))
    return {*info, fmt::format("selected by --device {}", selector)};
  throw device_error(fmt::format("no OpenCL device matches '{}'", selector),
                     "pass a number, a type or a part of a name to --device:" + list_text(devices));
}

ChosenDevice choose_device_for_small_steps() {
  constexpr bool replace = false;
  setenv("POCL_DEVICES", "pthread basic", replace);
  for (const auto& info : list_devices())
    if (info.is_pocl && info.name.starts_with("basic"))
      return {info, "lowest latency for small steps"};
  return choose_device("");
}

}  // namespace touchtrace
