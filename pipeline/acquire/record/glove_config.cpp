#include "pipeline/acquire/record/glove_config.h"

#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/json_number.h"

namespace touchtrace {
namespace {

constexpr const char* glove_schema = "touchtrace/glove/1";
constexpr std::uintmax_t max_config_bytes = 1 << 24;

Error invalid(const std::filesystem::path& path, const std::string& fault) {
  return data_error(fmt::format("{}: {}", path.string(), fault),
                    "write it with `touchtrace glove --learn --output FILE`");
}

double number_between(const nlohmann::json& json, const char* key, double minimum, double maximum) {
  const auto value = json.at(key).get<double>();
  if (!(value >= minimum && value <= maximum))
    throw data_error(fmt::format("{} = {}, expected {:g} to {:g}", key, value, minimum, maximum),
                     "");
  return value;
}

void require_baseline(const GloveConfig& config) {
  const auto taxels = static_cast<std::size_t>(config.rows) * static_cast<std::size_t>(config.cols);
  if (config.baseline_counts.size() != taxels)
    throw data_error(fmt::format("baseline_counts has {} values, expected {} x {}",
                                 config.baseline_counts.size(), config.rows, config.cols),
                     "");
  const float highest = static_cast<float>((1 << config.bits) - 1);
  for (const float count : config.baseline_counts)
    if (!(count >= 0.0f && count <= highest))
      throw data_error(fmt::format("baseline_counts has {}, expected 0 to {:g}", count, highest),
                       "");
}

GloveConfig parse(const nlohmann::json& json) {
  if (json.at("schema") != glove_schema)
    throw data_error(fmt::format("schema {}, expected \"{}\"", json["schema"].dump(), glove_schema),
                     "");
  GloveConfig config;
  // Earlier versions stored the path of a custom protocol file as the user typed it.
  config.protocol = std::filesystem::path(json.at("protocol").get<std::string>()).stem().string();
  const auto integer = [&](const char* key, int minimum, int maximum) {
    return static_cast<int>(whole_number(json.at(key), key, minimum, maximum));
  };
  config.rows = integer("rows", 1, 255), config.cols = integer("cols", 1, 255);
  config.bits = integer("bits", 1, 16);
  config.polarity = integer("polarity", -1, 1);
  if (config.polarity == 0) throw data_error("polarity is neither 1 nor -1", "");
  config.rate_hz = number_between(json, "rate_hz", 1e-3, 1e4);
  config.baseline_counts = json.at("baseline_counts").get<std::vector<float>>();
  config.faults = json.at("faults").get<std::vector<std::string>>();
  require_baseline(config);
  return config;
}

}  // namespace

nlohmann::json glove_config_json(const std::string& protocol, const GloveInfo& info,
                                 const LearnedGlove& learned) {
  nlohmann::json json = to_json(learned);
  json.update({{"schema", glove_schema},
               {"protocol", protocol},
               {"rows", info.rows},
               {"cols", info.cols},
               {"bits", info.bits},
               {"rate_hz", info.rate_hz}});
  return json;
}

GloveConfig read_glove_config(const std::filesystem::path& path) {
  const std::string text = read_file(path, max_config_bytes);
  try {
    return parse(nlohmann::json::parse(text));
  } catch (const std::exception& error) {
    throw invalid(path, error.what());
  }
}

}  // namespace touchtrace
