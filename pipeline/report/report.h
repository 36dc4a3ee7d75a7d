#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace touchtrace::report {

/// Files shown in a report. Sections without a file are omitted.
struct ReportInputs {
  std::vector<std::filesystem::path> metrics;       ///< from `touchtrace evaluate`
  std::vector<std::filesystem::path> labels;        ///< labels.h5
  std::vector<std::filesystem::path> calibrations;  ///< calibration.json
  std::vector<std::filesystem::path> recordings;    ///< only their provenance is read
  std::vector<std::filesystem::path> figures;       ///< from `touchtrace-verify --json`

  std::set<std::filesystem::path> found;  ///< those of find_inputs
};

/// Finds inputs in a folder and its subfolders by name: *metrics.json, *labels.h5,
/// calibration.json, *figures.json, other *.h5. A metrics.json directly in the folder replaces all
/// other metrics files. Throws data_error if the folder cannot be read.
ReportInputs find_inputs(const std::filesystem::path& folder);

/// Data of the page: {title, version, created, metrics, calibrations, smoothing, figures, stages,
/// artefacts}; numbers rounded to 5 significant digits. Throws data_error for an invalid file; of
/// those that were found in a folder, it skips invalid ones with a warning.
nlohmann::json report_data(const ReportInputs& inputs);

/// Renders a self-contained HTML page with styles, scripts and `data` embedded.
std::string render(const nlohmann::json& data);

}  // namespace touchtrace::report
