#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/acquire/import/glove_file.h"

namespace touchtrace {

/// Conversion of a file's values to counts: (value - offset) * counts_per_unit.
struct ValueScale {
  double offset = 0.0, counts_per_unit = 1.0;

  double scaled(double value) const { return (value - offset) * counts_per_unit; }
  /// Nearest count from 0 to 65535.
  std::uint16_t count(double value) const;
  bool is_scaled() const { return counts_per_unit != 1.0; }
};

/// Whole numbers that fit 16 bits stay as they are, negative ones are shifted. Other values are
/// scaled to 16 bits, pressures from 0 to 1 by 65535. So are contacts, values that are all 0 or 1,
/// unless `is_counts`. The conversion is reported. Throws data_error for values that are not finite
/// and for whole numbers with a wider range.
ValueScale value_scale(const GloveFile& glove, bool is_counts);

std::vector<std::uint16_t> counts_of(const GloveFile& glove, const ValueScale& scale);

}  // namespace touchtrace
