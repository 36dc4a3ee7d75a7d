#pragma once

#include <array>
#include <cstddef>
#include <cstring>

#include "engine/base/crc32c.h"
#include "pipeline/acquire/record/log.h"

namespace touchtrace {

/// Start of a log: name and version of the format.
inline constexpr std::array<std::uint8_t, 16> log_magic{'T', 'T', 'L',  'O', 'G', '\r', '\n', 0x1a,
                                                        1,   0,   0x00, 0,   0,   0,    0,    0};
inline constexpr std::uint32_t record_marker = 0x44524354;  // "TCRD"
inline constexpr std::uint32_t max_payload_bytes = 1u << 27;

/// Precedes each record's payload.
struct RecordHeader {
  std::uint32_t marker = record_marker;
  std::uint32_t kind = 0, payload_bytes = 0, payload_crc = 0;
  std::uint64_t number = 0;
  std::uint32_t unused = 0;
  std::uint32_t header_crc = 0;  ///< of the members before it

  std::uint32_t computed_crc() const {
    return crc32c(
        {reinterpret_cast<const std::uint8_t*>(this), offsetof(RecordHeader, header_crc)});
  }
  bool is_valid() const {
    return marker == record_marker && payload_bytes <= max_payload_bytes &&
           header_crc == computed_crc();
  }
};
static_assert(sizeof(RecordHeader) == 32);

}  // namespace touchtrace
