#include <fmt/core.h>

#include <cmath>
#include <cstdlib>

#include "engine/base/error.h"
#include "engine/base/files.h"
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

void add_metrics(json& data, const fs::path& path) {
  json document = read_metrics(path);
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

}  // namespace

json report_data(const ReportInputs& inputs) {
  const Provenance now = start_provenance("touchtrace/report/1", "report");
  json data{
      {"title", "from touch to trajectories"}, {"version", now.version}, {"created", now.created}};
  data["metrics"] = nullptr;
  for (const char* key : {"calibrations", "smoothing", "figures", "stages", "artefacts"})
    data[key] = json::array();
  for (const auto& path : inputs.recordings)
    add_artefact(data, path, RecordingReader(path).recording().provenance);
  for (const auto& path : inputs.calibrations) add_calibration(data, path);
  for (const auto& path : inputs.labels) add_labels(data, path);
  for (const auto& path : inputs.metrics) add_metrics(data, path);
  for (const auto& path : inputs.figures) data["figures"].push_back(figures_data(path));
  round_numbers(data);
  return data;
}

}  // namespace touchtrace::report
