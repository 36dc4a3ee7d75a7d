#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace touchtrace {

/// Base64 of RFC 4648, padded, without line breaks.
std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace touchtrace
