#include "pipeline/export/predictions.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/json_number.h"
#include "engine/base/text.h"

namespace touchtrace {
namespace {

constexpr std::int64_t max_number = std::int64_t{1} << 53;
constexpr std::size_t max_line_bytes = 1u << 16;  // nesting beyond the stack needs longer lines

void append_vectors(const nlohmann::json& body, const std::string& name, Predictions& predictions) {
  for (const char* quantity : {"position_m", "velocity_m_per_s"})
    for (const char* limit : {"", "_low", "_high"}) {
      const auto values = body.at(std::string(quantity) + limit).get<std::vector<double>>();
      if (values.size() != 3)
        throw std::runtime_error(fmt::format("{} {}{} has {} values instead of 3", name, quantity,
                                             limit, values.size()));
      auto& all = predictions.bodies[fmt::format("{}_{}{}", name, quantity, limit)];
      all.insert(all.end(), values.begin(), values.end());
    }
}

void append_line(const std::string& line, Predictions& predictions) {
  if (line.size() > max_line_bytes) throw std::runtime_error("the line is too long");
  const auto row = nlohmann::json::parse(line);
  if (row.at("object").is_null()) return;  // a glove's frames before the first window is full
  predictions.time_s.push_back(row.at("time_s").get<double>());
  predictions.clip.push_back(whole_number(row.at("clip"), "clip", 0, max_number));
  predictions.step.push_back(whole_number(row.at("step"), "step", 0, max_number));
  predictions.start.push_back(row.at("start").get<std::string>());
  for (const char* body : {"object", "hand"}) append_vectors(row.at(body), body, predictions);
}

}  // namespace

Predictions read_predictions(const std::filesystem::path& file) {
  constexpr const char* hint = "give the JSON lines that `touchtrace predict` printed";
  Predictions predictions;
  std::size_t number = 0;
  for (const auto& line : split_text(read_file(file), '\n')) {
    ++number;
    if (line.empty()) continue;
    try {
      append_line(line, predictions);
    } catch (const std::exception& error) {
      throw data_error(fmt::format("{}:{}: {}", file.string(), number, error.what()), hint);
    }
  }
  if (predictions.time_s.empty())
    throw data_error(fmt::format("{} has no predictions", file.string()), hint);
  return predictions;
}

}  // namespace touchtrace
