#include <fmt/core.h>

#include <cmath>

#include "pipeline/recording/stream_check.h"

namespace touchtrace {
namespace {

/// Minimum fraction of faulty frames or taxels that makes a glove unusable.
constexpr double unusable_fraction = 0.9;
// Limits of the warnings, chosen by judgement.
constexpr double max_rest_level = 0.2, max_repeated_frames = 0.1, max_frozen_s = 1.0;
constexpr double min_used_range = 0.125;  ///< 3 bits
constexpr double max_faulty_taxels = 0.1, max_negative_pressure = 0.2;

struct FaultyTaxels {
  int taxels, rows, cols;
};

/// Warns of whole rows and columns, or of over a tenth of the taxels.
void add_faulty_taxels(const char* how, const FaultyTaxels& faulty, int taxels,
                       std::vector<std::string>& warnings) {
  if (faulty.rows == 0 && faulty.cols == 0 && faulty.taxels <= max_faulty_taxels * taxels) return;
  std::string text = fmt::format("{} of {} taxels {}", faulty.taxels, taxels, how);
  const auto add_lines = [&](int count, const char* line) {
    if (count > 0) text += fmt::format(", {} whole {}{}", count, line, count > 1 ? "s" : "");
  };
  add_lines(faulty.rows, "row");
  add_lines(faulty.cols, "column");
  warnings.push_back(std::move(text));
}

}  // namespace

std::vector<std::string> TactileCheck::faults() const {
  std::vector<std::string> faults;
  if (zero_frames >= unusable_fraction)
    faults.push_back(fmt::format("{:.0f} % of the tactile frames are all zero", 100 * zero_frames));
  if (saturated_frames >= unusable_fraction)
    faults.push_back(
        fmt::format("{:.0f} % of the tactile frames are saturated", 100 * saturated_frames));
  if (faults.empty() && dead_taxels >= unusable_fraction * taxels)
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
        fmt::format("{} of every {} frames are interpolated or repeated: import the glove's own "
                    "frames at their own rate",
                    upsampling - 1, upsampling));
  if (negative_pressure_fraction > max_negative_pressure)
    warnings.push_back(
        fmt::format("{:.0f} % of the squared pressure is negative pressure: polarity or baseline "
                    "is wrong",
                    100 * negative_pressure_fraction));
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
          {"against_polarity", check.negative_pressure_fraction},
          {"used_range", check.used_range}};
}

}  // namespace touchtrace
