#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace touchtrace {

/// Predicted states of `touchtrace predict`, one per JSON line (pipeline/study/prediction.h).
struct Predictions {
  std::vector<double> time_s;      ///< [n], host clock
  std::vector<std::int64_t> clip;  ///< [n]
  std::vector<std::int64_t> step;  ///< [n], since the start of the roll-out
  std::vector<std::string> start;  ///< [n], "label" or "prior"
  /// [n, 3] by name: "object_position_m" [m], "object_position_m_low", "hand_velocity_m_per_s" ...
  std::map<std::string, std::vector<double>> bodies;
};

/// Reads JSON lines. Throws data_error that names the first faulty line.
Predictions read_predictions(const std::filesystem::path& file);

}  // namespace touchtrace
