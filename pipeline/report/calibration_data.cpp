#include <fmt/core.h>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "pipeline/report/artefact_data.h"

namespace touchtrace::report {
namespace {

using nlohmann::json;

constexpr std::uintmax_t max_bytes = 64u << 20;

void append_corners(json& corners, const json& view) {
  const json& pixels = view.at("corners_px");
  const json& residuals = view.at("residuals_px");
  for (std::size_t i = 0; i < pixels.size() && i < residuals.size(); ++i)
    corners.push_back({pixels[i].at(0), pixels[i].at(1), residuals[i].at(0), residuals[i].at(1)});
}

/// Also reads the key of older versions, board_print.
double deformation_sigma_m(const json& details) {
  for (const char* key : {"target_deformation", "board_print"})
    if (details.contains(key)) return details.at(key).value("sigma_m", 0.0);
  return 0.0;
}

json data_of(const json& document, const std::string& name) {
  const json& details = document.at("details");
  json data{{"name", name},
            {"width", document.at("color").at("width")},
            {"height", document.at("color").at("height")},
            {"rms_px", document.at("rms_px")},
            {"depth_rms_m", document.at("depth_rms_m")},
            {"verdict", details.at("verdict")},
            {"advice", details.value("advice", json::array())},
            {"sigmas", details.value("sigmas", json::object())},
            {"independent_sigmas", details.value("independent_sigmas", json::object())},
            {"view_inflation", details.value("view_inflation", 1.0)},
            {"projection_sigma_px", details.value("projection_sigma_px", json::array())},
            {"coverage", details.value("coverage", json())},
            {"deformation_sigma_m", deformation_sigma_m(details)},
            {"views", json::array()},
            {"corners", json::array()},
            {"provenance", details.value("provenance", json::object())}};
  for (const auto& view : details.value("views", json::array())) {
    data["views"].push_back({{"name", view.at("name")}, {"rms_px", view.at("rms_px")}});
    if (view.at("used").get<bool>()) append_corners(data["corners"], view);
  }
  return data;
}

}  // namespace

json calibration_data(const std::filesystem::path& path) {
  try {
    return data_of(json::parse(read_file(path, max_bytes)),
                   std::filesystem::absolute(path).parent_path().filename().string());
  } catch (const json::exception&) {
    throw data_error(fmt::format("{} is not a calibration of touchtrace calibrate", path.string()),
                     "run calibrate with this version of touchtrace, or leave the file out");
  }
}

}  // namespace touchtrace::report
