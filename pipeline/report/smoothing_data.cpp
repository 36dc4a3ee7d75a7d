#include "engine/base/base64.h"
#include "pipeline/report/artefact_data.h"

namespace touchtrace::report {
namespace {

using nlohmann::json;

std::vector<std::size_t> indices_in_clip(const std::vector<std::int32_t>& clips,
                                         std::int32_t clip) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (clips[i] == clip) indices.push_back(i);
  return indices;
}

json points(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  json rows = json::array();
  for (std::size_t i : indices)
    rows.push_back({values[3 * i], values[3 * i + 1], values[3 * i + 2]});
  return rows;
}

json times(const std::vector<double>& time_s, const std::vector<std::size_t>& indices,
           double start_s) {
  json values = json::array();
  for (std::size_t i : indices) values.push_back(time_s[i] - start_s);
  return values;
}

/// Rows of the error budget; empty if it or its names are unknown.
json budget_rows(const LabelledBody& body, std::size_t num_sources,
                 const std::vector<std::size_t>& indices) {
  json rows = json::array();
  if (num_sources == 0 || body.error_budget_m.size() != num_sources * body.quality.size())
    return rows;
  for (std::size_t i : indices) {
    const auto row = body.error_budget_m.begin() + static_cast<std::ptrdiff_t>(i * num_sources);
    rows.push_back(std::vector<double>(row, row + static_cast<std::ptrdiff_t>(num_sources)));
  }
  return rows;
}

json error_sources(const json& summary) {
  const json names = summary.is_object() ? summary.value("error_sources", json()) : json();
  return names.is_array() ? names : json::array();
}

std::string contact_sheet(const std::vector<std::uint8_t>& jpeg) {
  return jpeg.empty() ? "" : "data:image/jpeg;base64," + base64(jpeg);
}

}  // namespace

json smoothing_data(const Labels& labels, const std::string& name) {
  const std::int32_t clip = labels.clip.front();
  const auto labelled = indices_in_clip(labels.clip, clip),
             raw = indices_in_clip(labels.raw.clip, clip);
  const double start_s = labels.time_s[labelled.front()];
  const json sources = error_sources(labels.summary);
  return {{"name", name},
          {"contact_sheet", contact_sheet(labels.contact_sheet_jpeg)},
          {"error_sources", sources},
          {"object_budget", budget_rows(labels.object, sources.size(), labelled)},
          {"hand_budget", budget_rows(labels.hand, sources.size(), labelled)},
          {"time_s", times(labels.time_s, labelled, start_s)},
          {"object", points(labels.object.position_m, labelled)},
          {"hand", points(labels.hand.position_m, labelled)},
          {"raw_time_s", times(labels.raw.time_s, raw, start_s)},
          {"raw_object", points(labels.raw.object_m, raw)},
          {"raw_hand", points(labels.raw.hand_m, raw)}};
}

}  // namespace touchtrace::report
