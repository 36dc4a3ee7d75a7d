#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace touchtrace::report {

/// The artefacts that a report is made of; any of them may be missing, and so are its sections
/// then.
struct ReportInputs {
  std::vector<std::filesystem::path> metrics;       ///< of `touchtrace evaluate`
  std::vector<std::filesystem::path> labels;        ///< labels.h5
  std::vector<std::filesystem::path> calibrations;  ///< calibration.json
  std::vector<std::filesystem::path> recordings;    ///< only their provenance is read
  std::vector<std::filesystem::path> figures;       ///< of `touchtrace-verify --json`

  bool empty() const;
};

/// What lies in a folder and its subfolders, by name: [*]metrics.json (a plain metrics.json stands
/// for all), *labels.h5, calibration.json, *figures.json, other *.h5. Throws data_error if there is
/// no such folder.
ReportInputs find_inputs(const std::filesystem::path& folder);

/// Everything the page shows: {title, version, created, metrics, calibrations, smoothing, figures,
/// stages, artefacts}. Numbers have 5 significant digits. Throws data_error for a file that is not
/// what its name says.
nlohmann::json report_data(const ReportInputs& inputs);

/// One HTML file without any other: styles, scripts and `data` are inside.
std::string render(const nlohmann::json& data);

}  // namespace touchtrace::report
