#pragma once

#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "pipeline/acquire/import/source/source.h"

namespace touchtrace {

/// Conversion of a source's depth images to 16-bit counts.
struct DepthScale {
  double unit_m = 0.001;  ///< of the counts
  double counts_per_value = 1.0;
  /// Smallest value of the source that marks missing depth.
  double invalid_from = std::numeric_limits<double>::infinity();

  double metres_per_value() const { return unit_m * counts_per_value; }
  /// Counts, row by row; 0 where the source has no positive finite depth, or one that exceeds 16
  /// bits or marks missing depth.
  std::vector<std::uint16_t> counts(const cv::Mat& depth) const;
};

/// Scale of a stream of integer or floating-point images (`type`: CV_16UC1 or CV_32FC1). Integers
/// are kept; floating-point depth gets counts of 0.25 mm.
/// `values_per_m`: as the user states it; 0: the source's, or metres of floating-point numbers.
DepthScale depth_scale(const ImportSource& source, int type, double values_per_m);

/// Returns `scale` with `invalid_from` set if over 10 % of the pixels have one value beyond 20 m.
/// Warns of that, of a median depth above 6 m, and if over 75 % of the pixels exceed 16 bits.
/// Throws data_error, which proposes scales, if the median depth is implausible or counts of the
/// TUM format may be millimetres, and if no pixel has depth. `is_given`: the user stated the scale,
/// which then may give any possible depth.
DepthScale plausible_scale(DepthScale scale, const SourceStream& depth, bool is_given);

}  // namespace touchtrace
