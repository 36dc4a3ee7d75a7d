#pragma once

#include "pipeline/recording/recording.h"

namespace touchtrace::scene {

/// What can be said of a tactile glove from its frames alone. Levels are fractions of the full
/// scale; pressure is the change from the baseline in the direction of pressure. Rest: the tenth of
/// the frames with the lowest mean pressure. NaN where there are too few frames.
struct GloveStatistics {
  double rest_level = 0.0;             ///< reading at rest, median over taxels
  double rest_spread = 0.0;            ///< its standard deviation among taxels, robust
  double noise = 0.0;                  ///< standard deviation of a reading at rest, median taxel
  double peak_pressure = 0.0;          ///< 99th percentile over frames and taxels
  double loaded_taxels = 0.0;          ///< share above a tenth of the full scale, mean frame
  double saturated_readings = 0.0;     ///< share
  double constant_taxels = 0.0;        ///< share
  double change = 0.0;                 ///< 99th percentile of changes between consecutive frames
  double quiet_correlation = 0.0;      ///< of taxels that are never loaded with all others' sum
  double row_correlation = 0.0;        ///< of neighbours in a row, mean over pairs
  double column_correlation = 0.0;     ///< of neighbours in a column
  double correlation_half_second = 0;  ///< of the total pressure with that .5 s later
  double lost_frames = 0.0;            ///< share; longer gaps than a second are pauses
};

/// Throws data_error for fewer than 20 frames.
GloveStatistics glove_statistics(const GloveStream& glove);

}  // namespace touchtrace::scene
