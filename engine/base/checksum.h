#pragma once

#include <string>
#include <string_view>

namespace touchtrace {

/// Key of the checksum in JSON.
inline constexpr const char* checksum_key = "checksum";
/// Its value before the file is complete; the text must not contain it a second time.
std::string empty_checksum();

/// Returns a text that contains empty_checksum() with the SHA-256 of the text in its place.
std::string with_checksum(std::string text);

/// Throws data_error if a text of with_checksum() was changed. `head`: part at the start of the
/// text that contains the key. Accepts a text without a checksum: older files have none.
void verify_checksum(std::string_view text, std::string_view head);

}  // namespace touchtrace
