#pragma once

#include <stdexcept>
#include <string>

namespace touchtrace {

/// What the process returns; documented in the README and in `touchtrace --help`.
enum class ExitCode { done = 0, failed = 1, usage = 2, data = 3, no_device = 4, interrupted = 130 };

/// An error that a person can act on: what is wrong, and what to do about it.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& problem, std::string remedy);

  ExitCode code() const noexcept { return code_; }
  const std::string& remedy() const noexcept { return remedy_; }

 private:
  ExitCode code_;
  std::string remedy_;
};

/// An option, a name or a combination that cannot be meant (exit code 2).
Error usage_error(const std::string& problem, const std::string& remedy);
/// A file or a recording that does not hold what is needed, or a quality gate (exit code 3).
Error data_error(const std::string& problem, const std::string& remedy);
/// No usable OpenCL device, or one that failed (exit code 4).
Error device_error(const std::string& problem, const std::string& remedy);
/// Anything else that went wrong while doing what was asked (exit code 1).
Error failure(const std::string& problem, const std::string& remedy);

}  // namespace touchtrace
