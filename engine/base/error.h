#pragma once

#include <stdexcept>
#include <string>

namespace touchtrace {

/// Exit code of the process, documented in `touchtrace --help`.
enum class ExitCode { done = 0, failed = 1, usage = 2, data = 3, no_device = 4, interrupted = 130 };

/// Error reported to the user: what() is the problem, hint() what the user can do about it.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& problem, std::string hint);

  ExitCode code() const noexcept { return code_; }
  const std::string& hint() const noexcept { return hint_; }

 private:
  ExitCode code_;
  std::string hint_;
};

/// Invalid option, name or combination of options (exit code 2).
Error usage_error(const std::string& problem, const std::string& hint);
/// Invalid or insufficient input file, or a failed quality check (exit code 3).
Error data_error(const std::string& problem, const std::string& hint);
/// No usable OpenCL device, or a device failure (exit code 4).
Error device_error(const std::string& problem, const std::string& hint);
/// Any other failure (exit code 1).
Error failure(const std::string& problem, const std::string& hint);

}  // namespace touchtrace
