#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Properties of a glove, estimated from frames at rest and frames in which it is squeezed.
struct LearnedGlove {
  int polarity = 1;
  double polarity_ratio = 1.0;         ///< of the changes in this direction to the others
  std::vector<float> baseline_counts;  ///< [rows, cols], median at rest
  double median_baseline = 0.0;        ///< [counts]
  double noise_counts = 0.0;           ///< standard deviation at rest, median over the taxels
  int taxels = 0;
  int dead_taxels = 0;           ///< do not respond to squeezing
  int stuck_taxels = 0;          ///< always at an end of the converter's range
  double repeated_frames = 0.0;  ///< fraction of the frames that equal their predecessor
  bool is_noisy = false;         ///< noise above 5 % of the range

  /// Reasons why the glove is not fit for use; empty: it is.
  std::vector<std::string> faults() const;
};

/// `rest` and `squeezed`: frames one after the other, [frames, rows, cols]. Throws data_error if
/// there are fewer than 20 frames of one of them.
LearnedGlove learn_glove(const GloveInfo& info, const std::vector<std::uint16_t>& rest,
                         const std::vector<std::uint16_t>& squeezed);

nlohmann::json to_json(const LearnedGlove& glove);

}  // namespace touchtrace
