#include "engine/base/error.h"

#include <utility>

namespace touchtrace {

Error::Error(ExitCode code, const std::string& problem, std::string hint)
    : std::runtime_error(problem), code_(code), hint_(std::move(hint)) {}

Error usage_error(const std::string& problem, const std::string& hint) {
  return {ExitCode::usage, problem, hint};
}

Error data_error(const std::string& problem, const std::string& hint) {
  return {ExitCode::data, problem, hint};
}

Error device_error(const std::string& problem, const std::string& hint) {
  return {ExitCode::no_device, problem, hint};
}

Error failure(const std::string& problem, const std::string& hint) {
  return {ExitCode::failed, problem, hint};
}

}  // namespace touchtrace
