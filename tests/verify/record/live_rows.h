#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/recording/recording.h"

namespace touchtrace {

/// Glove of `rows` x `cols` taxels whose counts are smooth random waves around 200 counts.
GloveStream wavy_glove(int rows, int cols, std::size_t frames, double rate_hz);

/// JSON lines.
std::vector<nlohmann::json> parse_rows(const std::string& lines);

/// Comparison of the rows of `predict --recording` with those of `predict --glove`.
struct RowComparison {
  std::size_t compared = 0;
  std::size_t unequal = 0;  ///< of the compared, in step, start, hand or object
};

/// Compares recorded rows in order with live rows of the roll-outs that use the object's segment,
/// if there is one. A live row that is missing is unequal.
RowComparison compare_rows(const std::vector<nlohmann::json>& recorded,
                           const std::vector<nlohmann::json>& live);

}  // namespace touchtrace
