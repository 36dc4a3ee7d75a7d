#include <fmt/core.h>

#include <cmath>
#include <map>

#include "engine/base/text.h"
#include "tests/verify/study/sensitivity.h"

namespace touchtrace::study {
namespace {

using nlohmann::json;

constexpr const char* models[] = {"full", "without_touch"};

/// NaN if the error is missing: the object was dropped in too many clips.
double error_of(const json& row, const char* model) {
  const json error = row.is_object() ? row.value(model, json()) : json();
  return error.is_number() ? error.get<double>() : NAN;
}

std::string text_of(double error) { return std::isnan(error) ? "-" : fmt::format("{:.3f}", error); }

std::string value_of(const json& row) {
  std::string text;
  if (row.is_null()) return "-";
  for (double value : row.at("value").get<std::vector<double>>())
    text += fmt::format("{}{:.3g}", text.empty() ? "" : ":", value);
  return text;
}

std::string spread_of(const std::vector<const json*>& seeds, const char* model) {
  double sum = 0.0, square = 0.0;
  for (const json* row : seeds) sum += error_of(*row, model);
  const double n = static_cast<double>(seeds.size()), mean = sum / n;
  for (const json* row : seeds) square += std::pow(error_of(*row, model) - mean, 2);
  return fmt::format("{} +- {}", text_of(mean), text_of(std::sqrt(square / std::max(1.0, n - 1))));
}

/// Cells of one parameter; null if missing.
struct Row {
  json half, twice;

  bool changes(const json& usual) const {
    for (const json* cell : {&half, &twice})
      if (!cell->is_null() && cell->value("full_data", "") != usual.value("full_data", "-"))
        return true;
    return false;
  }
};

std::string row_text(const std::string& name, const Row& row, const json& usual) {
  std::string text = fmt::format("| {} | {}, {} |", name, value_of(row.half), value_of(row.twice));
  for (const char* model : models)
    text += fmt::format(" {}, {}, {} |", text_of(error_of(row.half, model)),
                        text_of(error_of(usual, model)), text_of(error_of(row.twice, model)));
  return text + "\n";
}

}  // namespace

std::string sensitivity_table(const json& document) {
  std::vector<const json*> defaults;
  std::vector<std::string> order, idle;
  std::map<std::string, Row> rows;
  for (const json& cell : document.at("cells")) {
    if (cell.at("assumption").is_null()) {
      defaults.push_back(&cell);
      continue;
    }
    const std::string name = cell.at("assumption");
    if (!rows.contains(name)) order.push_back(name);
    (cell.at("factor").get<double>() < 1.0 ? rows[name].half : rows[name].twice) = cell;
  }
  if (defaults.empty()) return "";
  std::string text =
      "| parameter | half, double | with touch: half, default, double | without: half, default, "
      "double |\n|---|---|---|---|\n";
  text += fmt::format("| default, {} seeds | | {} | {} |\n", defaults.size(),
                      spread_of(defaults, models[0]), spread_of(defaults, models[1]));
  for (const std::string& name : order)
    if (rows[name].changes(*defaults.front()))
      text += row_text(name, rows[name], *defaults.front());
    else
      idle.push_back(name);
  return idle.empty() ? text : text + "\nNothing changed with: " + comma_separated(idle) + ".\n";
}

}  // namespace touchtrace::study
