#pragma once

#include <string>
#include <vector>

namespace touchtrace::cli {

/// One thing that `touchtrace doctor` looked at.
struct Finding {
  enum class State { good, advice, broken };

  State state;
  std::string what;  ///< what was looked at, and what was found
  std::string fix;   ///< a command or an action; empty when good
};

/// Every kernel of the table of operations against its reference, on every device.
std::vector<Finding> check_devices();
/// Room on the disk of the working folder and of PoCL's cache, and whether the cache can be
/// written.
std::vector<Finding> check_disk();
/// Whether Debian's packages that touchtrace is built from and run with are there.
std::vector<Finding> check_packages();
/// USB: whether devices can be listed, and whether this user may open serial and USB gloves.
std::vector<Finding> check_usb();

}  // namespace touchtrace::cli
