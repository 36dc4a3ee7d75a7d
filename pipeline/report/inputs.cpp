#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "pipeline/recording/h5_file.h"
#include "pipeline/recording/labels.h"
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

/// Warns of an HDF5 file of another program.
bool is_recording(const fs::path& file) {
  try {
    if (h5::schema_of(file).starts_with("touchtrace/recording/")) return true;
    Progress::warn(fmt::format("skipped {}: it is not a recording", file.string()));
  } catch (const Error& error) {
    Progress::warn(fmt::format("skipped {}: {}", file.string(), error.what()));
  }
  return false;
}

/// Warns of labels that cannot be read.
bool are_labels(const fs::path& file) {
  try {
    read_labels(file);
    return true;
  } catch (const Error& error) {
    Progress::warn(fmt::format("skipped {}", error.what()));
    return false;
  }
}

void add_file(ReportInputs& inputs, const fs::path& file) {
  const std::string name = file.filename().string();
  if (name.starts_with('.')) return;
  const bool is_labels_name = name.ends_with("labels.h5");
  if (name.ends_with("metrics.json"))
    inputs.metrics.push_back(file);
  else if (name.ends_with("figures.json"))
    inputs.figures.push_back(file);
  else if (name == "calibration.json")
    inputs.calibrations.push_back(file);
  else if (is_labels_name && are_labels(file))
    inputs.labels.push_back(file);
  else if (!is_labels_name && name.ends_with(".h5") && is_recording(file))
    inputs.recordings.push_back(file);
}

}  // namespace

bool ReportInputs::empty() const {
  return metrics.empty() && labels.empty() && calibrations.empty() && recordings.empty() &&
         figures.empty();
}

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
