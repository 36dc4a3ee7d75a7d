#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>

namespace touchtrace {

/// Whole number of a JSON value, from `minimum` to `maximum`, both at most 2^53. Safe for untrusted
/// text: nlohmann's get<int>() is undefined for numbers that do not fit. Throws data_error with
/// `name`.
std::int64_t whole_number(const nlohmann::json& value, const char* name, std::int64_t minimum,
                          std::int64_t maximum);

}  // namespace touchtrace
