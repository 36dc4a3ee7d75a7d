#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/recording/labels.h"

namespace touchtrace::report {

/// Data of the page for one calibration.json: {name, width, height, rms_px, depth_rms_m, verdict,
/// advice, sigmas {parameter: standard deviation}, projection_sigma_px [rows][columns], coverage,
/// deformation_sigma_m, views [{name, rms_px}], corners [[u, v, du, dv]...] in pixels, provenance}.
/// Parts that older or imported files do not have are empty. Throws data_error for another file.
nlohmann::json calibration_data(const std::filesystem::path& path);

/// Output of `touchtrace-verify --json`: {name, figures [{name, value, unit, goal, holds, seconds,
/// picture?}]}. Throws data_error for another file.
nlohmann::json figures_data(const std::filesystem::path& path);

/// Measured and smoothed positions of the first clip: {name, time_s, object, hand, raw_time_s,
/// raw_object, raw_hand}; metres, and seconds since its first label. Also the labels' error_sources
/// and standard deviations by source, {object,hand}_budget [labels][sources] in metres, and
/// contact_sheet, a data URI; empty if the file lacks them. `labels` must not be empty.
nlohmann::json smoothing_data(const Labels& labels, const std::string& name);

}  // namespace touchtrace::report
