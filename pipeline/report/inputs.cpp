#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "pipeline/report/report.h"

namespace touchtrace::report {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_of(const fs::path& folder) {
  std::error_code error;
  fs::recursive_directory_iterator entries(folder, error);
  if (error)
    throw data_error(fmt::format("cannot read the folder {}: {}", folder.string(), error.message()),
                     "give a --folder with results of touchtrace");
  std::vector<fs::path> files;
  for (const auto& entry : entries)
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

void add_file(ReportInputs& inputs, const fs::path& file) {
  const std::string name = file.filename().string();
  if (name.starts_with('.')) return;
  if (name.ends_with("metrics.json"))
    inputs.metrics.push_back(file);
  else if (name.ends_with("figures.json"))
    inputs.figures.push_back(file);
  else if (name == "calibration.json")
    inputs.calibrations.push_back(file);
  else if (name.ends_with("labels.h5"))
    inputs.labels.push_back(file);
  else if (name.ends_with(".h5"))
    inputs.recordings.push_back(file);
  else
    return;
  inputs.found.insert(file);
}

}  // namespace

ReportInputs find_inputs(const fs::path& folder) {
  ReportInputs inputs;
  for (const auto& file : files_of(folder)) add_file(inputs, file);
  const auto combined = std::ranges::find(inputs.metrics, folder / "metrics.json");
  if (combined == inputs.metrics.end()) return inputs;
  if (fs::exists(folder / "study.json"))
    inputs.metrics.erase(combined);  // a sweep's summary of the others
  else
    inputs.metrics = {*combined};
  return inputs;
}

}  // namespace touchtrace::report
