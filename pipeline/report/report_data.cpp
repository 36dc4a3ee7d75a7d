#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "engine/base/provenance.h"
#include "pipeline/recording/recording_file.h"
#include "pipeline/report/artefact_data.h"
#include "pipeline/report/report.h"

namespace touchtrace::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t max_json_bytes = 256u << 20;

/// Arrays of a metrics file; those of several files are concatenated.
constexpr const char* metrics_arrays[] = {"results",  "runs",   "differences",  "curves",
                                          "examples", "models", "label_errors", "notes"};

/// Those that the report shows under their activity and object.
constexpr const char* rows_of_groups[] = {"results", "runs", "differences", "curves"};

/// Rounds to 5 significant digits, enough for any plot; NaN and infinity become null.
void round_numbers(json& value) {
  if (value.is_number_float()) {
    const double number = value.get<double>();
    value = std::isfinite(number)
                ? json(std::strtod(fmt::format("{:.5g}", number).c_str(), nullptr))
                : json();
  } else if (value.is_structured()) {
    for (auto& element : value) round_numbers(element);
  }
}

/// Checks the members that are read below.
bool is_metrics(const json& document) {
  if (document.value("schema", json()) != "touchtrace/metrics/2" ||
      !document.value("provenance", json()).is_object())
    return false;
  for (const char* key : metrics_arrays)
    if (!document.contains(key) || !document.at(key).is_array()) return false;
  for (const char* key : rows_of_groups)
    for (const auto& row : document.at(key))
      if (!row.is_object()) return false;
  for (const auto& model : document.at("models"))
    if (!model.is_object() || !model.value("path", json()).is_string() ||
        !model.value("provenance", json()).is_object())
      return false;
  return true;
}

json read_metrics(const fs::path& path) {
  json document = json::parse(read_file(path, max_json_bytes), nullptr, false);
  if (!document.is_object() || !is_metrics(document))
    throw data_error(fmt::format("{} is not a metrics file of touchtrace evaluate", path.string()),
                     "run evaluate with this version of touchtrace, or leave the file out");
  return document;
}

void add_artefact(json& data, const fs::path& path, const json& provenance) {
  data["artefacts"].push_back({{"artefact", path.filename().string()}, {"provenance", provenance}});
  data["stages"].push_back({{"artefact", path.filename().string()},
                            {"command", provenance.value("command", provenance.value("verb", ""))},
                            {"wall_seconds", provenance.value("wall_seconds", 0.0)},
                            {"cpu_seconds", provenance.value("cpu_seconds", 0.0)},
                            {"device", provenance.value("device", "")}});
}

/// "out/wave.h5, out/throw.h5, against labels": what the rows of a metrics file were computed from.
std::string data_set_of(const json& document) {
  std::string name;
  const json options = document.at("provenance").value("options", json::object());
  if (options.is_object() && options.value("recording", json()).is_array())
    for (const auto& recording : options.at("recording"))
      if (recording.is_string())
        name += fs::path(recording.get<std::string>()).lexically_normal().string() + ", ";
  return name + "against " + (document.value("against", json()) == "truth" ? "truth" : "labels");
}

/// Rows of one activity and object in several metrics files keep the name of their data set, if
/// there are several.
void separate_data_sets(json& metrics) {
  std::map<json, std::set<json>> sets;
  const auto group_of = [](const json& row) {
    return json{row.value("activity", json()), row.value("object", json())};
  };
  for (const auto& row : metrics.at("results")) sets[group_of(row)].insert(row.at("data_set"));
  for (const char* key : rows_of_groups)
    for (auto& row : metrics.at(key))
      if (sets[group_of(row)].size() < 2) row.erase("data_set");
}

void add_metrics(json& data, const fs::path& path) {
  json document = read_metrics(path);
  const auto data_set = data_set_of(document);
  for (const char* key : rows_of_groups)
    for (auto& row : document.at(key)) row["data_set"] = data_set;
  for (const auto& model : document.at("models"))
    add_artefact(data, model.at("path").get<std::string>(), model.at("provenance"));
  add_artefact(data, path, document.at("provenance"));
  if (data["metrics"].is_null()) {
    data["metrics"] = std::move(document);
    return;
  }
  for (const char* key : metrics_arrays)
    for (auto& row : document.at(key)) data["metrics"][key].push_back(std::move(row));
}

void add_calibration(json& data, const fs::path& path) {
  json calibration = calibration_data(path);
  add_artefact(data, fs::absolute(path).parent_path(), calibration.at("provenance"));
  data["calibrations"].push_back(std::move(calibration));
}

void add_labels(json& data, const fs::path& path) {
  const Labels labels = read_labels(path);
  add_artefact(data, path, labels.provenance);
  if (!labels.clip.empty())
    data["smoothing"].push_back(smoothing_data(labels, path.filename().string()));
}

template <class Add>
void add_each(const ReportInputs& inputs, const std::vector<fs::path>& paths, Add add) {
  for (const auto& path : paths) {
    try {
      add(path);
    } catch (const Error& error) {
      if (!inputs.found.contains(path)) throw;
      Progress::warn(fmt::format("skipped: {}", error.what()));
    }
  }
}

}  // namespace

json report_data(const ReportInputs& inputs) {
  const Provenance now = start_provenance("touchtrace/report/1", "report");
  json data{
      {"title", "from touch to trajectories"}, {"version", now.version}, {"created", now.created}};
  data["metrics"] = nullptr;
  for (const char* key : {"calibrations", "smoothing", "figures", "stages", "artefacts"})
    data[key] = json::array();
  add_each(inputs, inputs.recordings, [&](const fs::path& path) {
    add_artefact(data, path, RecordingReader(path).recording().provenance);
  });
  add_each(inputs, inputs.calibrations, [&](const fs::path& path) { add_calibration(data, path); });
  add_each(inputs, inputs.labels, [&](const fs::path& path) { add_labels(data, path); });
  add_each(inputs, inputs.metrics, [&](const fs::path& path) { add_metrics(data, path); });
  add_each(inputs, inputs.figures,
           [&](const fs::path& path) { data["figures"].push_back(figures_data(path)); });
  if (!data["metrics"].is_null()) separate_data_sets(data["metrics"]);
  round_numbers(data);
  return data;
}

}  // namespace touchtrace::report
