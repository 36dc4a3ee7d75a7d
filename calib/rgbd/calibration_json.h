#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "calib/rgbd/calibration.h"

namespace touchtrace {

// Parts of calibration.json and rig.json. Readers throw std::exception for an invalid document.

nlohmann::json camera_json(const Camera& camera);
Camera camera_from_json(const nlohmann::json& value);

/// Row-major.
nlohmann::json matrix_json(const Eigen::MatrixXd& matrix);
Eigen::MatrixXd matrix_from_json(const nlohmann::json& rows, Eigen::Index height,
                                 Eigen::Index width);

/// Rigid motion from a 4x4 matrix, whose rotation may be rounded to three decimals. `name`: for
/// messages.
Eigen::Isometry3d pose_from_json(const nlohmann::json& value, const std::string& name);

/// Text of a JSON document with its checksum.
std::string checked_json_text(nlohmann::json document);
/// Inverse of checked_json_text(). Throws if the text was changed.
nlohmann::json parse_checked_json(const std::string& text);
void require_schema(const nlohmann::json& document, const std::string& schema);

using FileTexts = std::map<std::string, std::string>;  ///< by path relative to a folder

/// Files of write_calibration().
FileTexts calibration_files(const RgbdCalibration& calibration);
/// Throws if a file exists, unless `overwrite`; then nothing is written.
void write_files(const std::filesystem::path& folder, const FileTexts& texts, bool overwrite);

}  // namespace touchtrace
