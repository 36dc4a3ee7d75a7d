#pragma once

#include <optional>
#include <string_view>

namespace touchtrace {

/// Unix time of "2023-11-14T22:13:20.5", with 'T' or a blank, and 'Z', "+02:00" or nothing (UTC)
/// behind it; of "22:13:20.5", seconds since midnight; nullopt for other text.
std::optional<double> parse_iso_time(std::string_view text);

}  // namespace touchtrace
