#include "engine/base/error.h"

#include <utility>

namespace touchtrace {
namespace {

/// Removes the tags of nlohmann::json, such as "[json.exception.out_of_range.403] ".
std::string without_json_tags(std::string text) {
  constexpr const char *begin = "[json.exception.", *end = "] ";
  for (auto from = text.find(begin); from != std::string::npos; from = text.find(begin, from)) {
    const auto to = text.find(end, from);
    if (to == std::string::npos) break;
    text.erase(from, to + 2 - from);
  }
  return text;
}

}  // namespace

Error::Error(ExitCode code, const std::string& problem, std::string hint)
    : std::runtime_error(without_json_tags(problem)), code_(code), hint_(std::move(hint)) {}

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
