#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace touchtrace {

struct BitFlips {
  int detected = 0;  ///< read with an Error
  int silent = 0;    ///< read without one, with other content
};

/// Flips `flips` random bits of a file, one at a time, and reads it each time. `content`: reads it
/// and returns all that was read as bytes.
BitFlips flip_bits(const std::filesystem::path& file, int flips,
                   const std::function<std::string()>& content);

}  // namespace touchtrace
