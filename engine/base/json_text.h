#pragma once

#include <string>

namespace touchtrace {

/// A string without its quotes; other values as JSON. `Json`: a basic_json of nlohmann.
template <class Json>
std::string json_text(const Json& value) {
  return value.is_string() ? value.template get<std::string>() : value.dump();
}

}  // namespace touchtrace
