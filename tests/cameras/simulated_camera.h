#pragma once

#include <cstdint>

namespace touchtrace::testing {

// Images of the camera that openni2_driver.cpp simulates, by their number from 1.

inline constexpr int simulated_width = 320, simulated_height = 240, simulated_frames = 30;

/// Stamps beyond 32 bits. Colour follows 5 ms after depth.
inline std::uint64_t simulated_stamp_us(int number, bool is_color) {
  return 5'000'000'000u + 33'333u * static_cast<unsigned>(number) + (is_color ? 5'000u : 0u);
}

inline std::uint8_t simulated_color(int x, int y, int channel, int number) {
  return static_cast<std::uint8_t>(x + 3 * y + 50 * channel + 7 * number);
}

/// [mm]
inline std::uint16_t simulated_depth(int x, int y, int number, bool is_registered) {
  return static_cast<std::uint16_t>(500 + x + 2 * y + 5 * number + (is_registered ? 2000 : 0));
}

}  // namespace touchtrace::testing
