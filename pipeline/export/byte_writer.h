#pragma once

#include <libdeflate.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace touchtrace {

/// Appends a number to `bytes`, low byte first.
template <class Number>
requires std::is_arithmetic_v<Number>
void append_number(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// Appends several numbers, low bytes first.
template <class... Numbers>
void append_numbers(std::string& bytes, Numbers... numbers) {
  (append_number(bytes, numbers), ...);
}

/// CRC-32 of zip, PNG and MCAP files (reflected polynomial 0xedb88320). `crc`: of the bytes before.
inline std::uint32_t crc32(std::string_view bytes, std::uint32_t crc = 0) {
  return libdeflate_crc32(crc, bytes.data(), bytes.size());
}

}  // namespace touchtrace
