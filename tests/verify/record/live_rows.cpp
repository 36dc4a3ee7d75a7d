#include "tests/verify/record/live_rows.h"

#include <cmath>
#include <sstream>

#include "engine/base/random.h"

namespace touchtrace {

GloveStream wavy_glove(int rows, int cols, std::size_t frames, double rate_hz) {
  RandomStream random(5, "wavy glove");
  GloveStream glove;
  glove.info.rows = rows, glove.info.cols = cols, glove.info.bits = 12;
  glove.info.rate_hz = rate_hz;
  std::vector<double> speed, phase;
  for (int i = 0; i < glove.info.taxels(); ++i) {
    speed.push_back(random.uniform(0.05, 0.5)), phase.push_back(random.uniform(0.0, 6.0));
    glove.info.baseline_counts.push_back(static_cast<float>(190 + random.below(20)) + 0.5f);
  }
  for (std::size_t f = 0; f < frames; ++f) {
    glove.sequence.push_back(f);
    glove.host_time_s.push_back(static_cast<double>(f) / rate_hz);
    for (std::size_t i = 0; i < speed.size(); ++i)
      glove.counts.push_back(static_cast<std::uint16_t>(
          200.0 + 1500.0 * std::max(0.0, std::sin(speed[i] * static_cast<double>(f) + phase[i])) +
          static_cast<double>(random.below(20))));
  }
  return glove;
}

std::vector<nlohmann::json> parse_rows(const std::string& lines) {
  std::vector<nlohmann::json> rows;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) rows.push_back(nlohmann::json::parse(line));
  return rows;
}

RowComparison compare_rows(const std::vector<nlohmann::json>& recorded,
                           const std::vector<nlohmann::json>& live) {
  std::vector<const nlohmann::json*> rolled;
  for (const auto& row : live)
    if (row.at("step") > 0 && row.at("embedding") != "mean") rolled.push_back(&row);
  RowComparison comparison;
  for (std::size_t i = 0; i < recorded.size(); ++i, ++comparison.compared)
    for (const char* key : {"step", "start", "object", "hand"})
      if (i >= rolled.size() || recorded[i].at(key) != rolled[i]->at(key)) {
        ++comparison.unequal;
        break;
      }
  return comparison;
}

}  // namespace touchtrace
