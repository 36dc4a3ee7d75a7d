#include <fmt/core.h>

#include <cmath>

#include "pipeline/recording/stream_check.h"

namespace touchtrace {
namespace {

/// Fraction of faulty frames or taxels from which on a glove is useless.
constexpr double useless_fraction = 0.9;
constexpr double max_rest_level = 0.2, max_repeated_frames = 0.1, max_frozen_s = 1.0;
constexpr double min_used_range = 0.125;  ///< 3 bits
constexpr double max_faulty_taxels = 0.1;

struct FaultyTaxels {
  int taxels, rows, cols;
};

/// Warns of whole rows and columns, or of over a tenth of the taxels.
void add_faulty_taxels(const char* how, const FaultyTaxels& faulty, int taxels,
                       std::vector<std::string>& warnings) {
  if (faulty.rows == 0 && faulty.cols == 0 && faulty.taxels <= max_faulty_taxels * taxels) return;
  std::string text = fmt::format("{} of {} taxels {}", faulty.taxels, taxels, how);
  if (faulty.rows > 0) text += fmt::format(", {} whole rows", faulty.rows);
  if (faulty.cols > 0) text += fmt::format(", {} whole columns", faulty.cols);
  warnings.push_back(std::move(text));
}

}  // namespace

std::vector<std::string> TactileCheck::faults() const {
  std::vector<std::string> faults;
  if (zero_frames >= useless_fraction)
    faults.push_back(fmt::format("{:.0f} % of the tactile frames are all zero", 100 * zero_frames));
  if (saturated_frames >= useless_fraction)
    faults.push_back(
        fmt::format("{:.0f} % of the tactile frames are saturated", 100 * saturated_frames));
  if (faults.empty() && dead_taxels >= useless_fraction * taxels)
    faults.push_back(fmt::format("{} of {} taxels have constant counts", dead_taxels, taxels));
  return faults;
}

std::vector<std::string> TactileCheck::warnings() const {
  std::vector<std::string> warnings;
  if (std::abs(rest_level) > max_rest_level)
    warnings.push_back(
        fmt::format("mean pressure at rest is {:.0f} % of the range: baseline or "
                    "polarity is wrong",
                    100 * rest_level));
  if (repeated_frames > max_repeated_frames || frozen_s > max_frozen_s)
    warnings.push_back(
        fmt::format("{:.0f} % of the frames repeat the previous one, for up to "
                    "{:.1f} s",
                    100 * repeated_frames, frozen_s));
  add_faulty_taxels("are stuck at saturation", {stuck_taxels, stuck_rows, stuck_cols}, taxels,
                    warnings);
  add_faulty_taxels("never change", {dead_taxels, dead_rows, dead_cols}, taxels, warnings);
  if (upsampling > 1)
    warnings.push_back(
        fmt::format("of {} frames, {} are interpolated or repetitions: give the native frames and "
                    "rate",
                    upsampling, upsampling - 1));
  if (against_polarity > 0.5)
    warnings.push_back(
        fmt::format("{:.0f} % of the squared changes are against the polarity: polarity or "
                    "baseline is wrong",
                    100 * against_polarity));
  if (used_range < min_used_range)
    warnings.push_back(
        fmt::format("the largest count is {:.1f} % of the range: attribute 'bits' is "
                    "wrong, or the glove was never pressed",
                    100 * used_range));
  return warnings;
}

nlohmann::json to_json(const TactileCheck& check) {
  return {{"taxels", check.taxels},
          {"dead_taxels", check.dead_taxels},
          {"zero_frames", check.zero_frames},
          {"saturated_frames", check.saturated_frames},
          {"rest_level", check.rest_level},
          {"repeated_frames", check.repeated_frames},
          {"frozen_s", check.frozen_s},
          {"stuck_rows", check.stuck_rows},
          {"stuck_cols", check.stuck_cols},
          {"upsampling", check.upsampling},
          {"stuck_taxels", check.stuck_taxels},
          {"dead_rows", check.dead_rows},
          {"dead_cols", check.dead_cols},
          {"against_polarity", check.against_polarity},
          {"used_range", check.used_range}};
}

}  // namespace touchtrace
