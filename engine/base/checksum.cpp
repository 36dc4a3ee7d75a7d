#include "engine/base/checksum.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/files.h"

namespace touchtrace {
namespace {

// A flipped bit spoils the key or the prefix, but not both: the other one tells that the text had a
// checksum.
constexpr std::string_view prefix = "sha256-with-zeros-here:";
constexpr std::size_t num_digits = 64;

}  // namespace

std::string empty_checksum() { return std::string(prefix) + std::string(num_digits, '0'); }

std::string with_checksum(std::string text) {
  const std::string digest = sha256_of(text);
  return text.replace(text.find(prefix) + prefix.size(), num_digits, digest);
}

void verify_checksum(std::string_view text, std::string_view head) {
  const auto at = head.find(prefix);
  if (at == std::string_view::npos &&
      head.find(fmt::format("\"{}\"", checksum_key)) == std::string_view::npos)
    return;
  std::string zeroed(text);
  if (at != std::string_view::npos && head.size() - at >= prefix.size() + num_digits) {
    zeroed.replace(at + prefix.size(), num_digits, num_digits, '0');
    if (text.substr(at + prefix.size(), num_digits) == sha256_of(zeroed)) return;
  }
  throw data_error("the file was changed after it was written: its checksum is wrong",
                   "restore it from a copy; if it was changed on purpose, remove its \"checksum\"");
}

}  // namespace touchtrace
