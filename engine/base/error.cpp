#include "engine/base/error.h"

#include <utility>

namespace touchtrace {

Error::Error(ExitCode code, const std::string& problem, std::string remedy)
    : std::runtime_error(problem), code_(code), remedy_(std::move(remedy)) {}

Error usage_error(const std::string& problem, const std::string& remedy) {
  return {ExitCode::usage, problem, remedy};
}

Error data_error(const std::string& problem, const std::string& remedy) {
  return {ExitCode::data, problem, remedy};
}

Error device_error(const std::string& problem, const std::string& remedy) {
  return {ExitCode::no_device, problem, remedy};
}

Error failure(const std::string& problem, const std::string& remedy) {
  return {ExitCode::failed, problem, remedy};
}

}  // namespace touchtrace
