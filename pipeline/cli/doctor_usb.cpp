#include <fmt/core.h>
#include <libusb.h>
#include <unistd.h>

#include <filesystem>
#include <memory>

#include "pipeline/cli/doctor.h"

namespace touchtrace::cli {
namespace {

namespace fs = std::filesystem;

struct SerialChip {
  std::uint16_t vendor;
  const char* name;
};

/// USB-to-serial chips of common gloves.
constexpr SerialChip serial_chips[]{{0x1a86, "CH340"},
                                    {0x10c4, "CP210x"},
                                    {0x0403, "FTDI"},
                                    {0x0483, "STM32"},
                                    {0x2341, "Arduino"}};

const char* chip_name(std::uint16_t vendor) {
  for (const auto& chip : serial_chips)
    if (chip.vendor == vendor) return chip.name;
  return nullptr;
}

Finding check_open(libusb_device* device, const std::string& name) {
  libusb_device_handle* handle = nullptr;
  const int result = libusb_open(device, &handle);
  if (result == 0) {
    libusb_close(handle);
    return {Finding::State::good, fmt::format("{} is accessible", name), ""};
  }
  return {Finding::State::advice,
          fmt::format("cannot open {}: {}", name, libusb_error_name(result)),
          "sudo usermod -aG dialout,plugdev $USER, then log in again"};
}

std::vector<Finding> check_gloves(libusb_context* context) {
  std::vector<Finding> findings;
  libusb_device** list = nullptr;
  const auto count = libusb_get_device_list(context, &list);
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(list[i], &descriptor) != 0) continue;
    if (const char* name = chip_name(descriptor.idVendor))
      findings.push_back(check_open(
          list[i],
          fmt::format("USB {} ({:04x}:{:04x})", name, descriptor.idVendor, descriptor.idProduct)));
  }
  if (count >= 0) libusb_free_device_list(list, 1);
  return findings;
}

Finding check_tty(const fs::path& tty) {
  if (access(tty.c_str(), R_OK | W_OK) == 0)
    return {Finding::State::good, tty.string() + " is accessible", ""};
  return {Finding::State::advice, "cannot open " + tty.string(),
          "sudo usermod -aG dialout $USER, then log in again"};
}

}  // namespace

std::vector<Finding> check_usb() {
  std::vector<Finding> findings;
  libusb_context* context = nullptr;
  if (const int result = libusb_init(&context); result != 0)
    findings.push_back({Finding::State::advice,
                        fmt::format("cannot list USB devices: {}", libusb_error_name(result)),
                        "only needed for a USB glove; check that /dev/bus/usb exists"});
  else {
    const std::unique_ptr<libusb_context, decltype(&libusb_exit)> owner(context, &libusb_exit);
    findings = check_gloves(context);
  }
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/dev", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("ttyACM") || name.starts_with("ttyUSB"))
      findings.push_back(check_tty(entry.path()));
  }
  if (findings.empty())
    findings.push_back(
        {Finding::State::good, "no glove connected; recordings and simulations need none", ""});
  return findings;
}

}  // namespace touchtrace::cli
