#pragma once

#include <cstdint>
#include <span>

namespace touchtrace {

/// CRC-32C (Castagnoli, reflected polynomial 0x82f63b78) of `bytes`. `crc`: of the bytes before
/// them.
std::uint32_t crc32c(std::span<const std::uint8_t> bytes, std::uint32_t crc = 0) noexcept;

}  // namespace touchtrace
