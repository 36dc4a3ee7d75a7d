#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "pipeline/acquire/import/gloves/glove_file.h"

namespace touchtrace {

/// Conversion of a file's values to counts: (value - offset) * counts_per_unit.
struct ValueScale {
  double offset = 0.0, counts_per_unit = 1.0;

  double scaled(double value) const { return (value - offset) * counts_per_unit; }
  /// Nearest count from 0 to 65535.
  std::uint16_t count(double value) const;
  bool is_scaled() const { return counts_per_unit != 1.0; }
};

/// Whole numbers from 0 to 65535 stay as they are. Negative whole numbers are shifted if their
/// range fits 16 bits. All other values are scaled to 16 bits; pressures from 0 to 1, and contacts
/// (all 0 or 1) unless `is_counts`, by 65535. Reports the conversion. Throws data_error for values
/// that are not finite.
ValueScale value_scale(const GloveFile& glove, bool is_counts);

std::vector<std::uint16_t> counts_of(const GloveFile& glove, const ValueScale& scale);

/// Warns of frames that were skipped, since some taxel has no value. Throws data_error if they are
/// more than a tenth of all.
void report_incomplete(const std::filesystem::path& file, std::size_t incomplete, std::size_t all);

}  // namespace touchtrace
