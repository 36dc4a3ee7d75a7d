#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/recording/labels.h"

namespace touchtrace::report {

/// What the page shows of a calibration.json: {name, width, height, rms_px, depth_rms_m, verdict,
/// advice, sigmas {parameter: deviation}, projection_sigma_px [rows][columns] and coverage (of
/// files that have them), views [{name, rms_px}], corners [[u, v, du, dv]...] in pixels}, and its
/// provenance. Throws data_error if the file is something else.
nlohmann::json calibration_data(const std::filesystem::path& path);

/// Figures as `touchtrace-verify --json` prints them: {name, figures [{name, value, unit, goal,
/// holds, seconds, picture?}]}. Throws data_error if the file holds something else.
nlohmann::json figures_data(const std::filesystem::path& path);

/// Tracked points and smoothed positions of the first clip: {name, time_s, object, hand,
/// raw_time_s, raw_object, raw_hand}, seconds from its first label, metres. Needs at least one
/// label.
nlohmann::json smoothing_data(const Labels& labels, const std::string& name);

}  // namespace touchtrace::report
