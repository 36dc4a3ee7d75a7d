#include "engine/base/json_number.h"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/base/error.h"

namespace touchtrace {

std::int64_t whole_number(const nlohmann::json& value, const char* name, std::int64_t minimum,
                          std::int64_t maximum) {
  const double number = value.is_number() ? value.get<double>() : std::nan("");
  if (!(number >= static_cast<double>(minimum) && number <= static_cast<double>(maximum) &&
        number == std::floor(number)))
    throw data_error(fmt::format("{} is {}, expected a whole number from {} to {}", name,
                                 value.dump(), minimum, maximum),
                     "correct the value");
  return static_cast<std::int64_t>(number);
}

}  // namespace touchtrace
