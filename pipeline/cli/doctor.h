#pragma once

#include <string>
#include <vector>

namespace touchtrace::cli {

/// Result of one check of `touchtrace doctor`.
struct Finding {
  enum class State { good, advice, broken };

  State state;
  std::string what;  ///< thing checked and its condition
  std::string hint;  ///< command or action; empty if good
};

/// Compares every operation with its reference on every device.
std::vector<Finding> check_devices();
/// Checks the free space of the working directory and whether PoCL's kernel cache is writable.
std::vector<Finding> check_disk();
/// Checks the Debian packages that building, running and testing need, and which camera libraries
/// are built in.
std::vector<Finding> check_packages();
/// Checks whether USB devices can be listed and this user may open USB and serial gloves.
std::vector<Finding> check_usb();

}  // namespace touchtrace::cli
