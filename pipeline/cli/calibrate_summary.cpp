#include "pipeline/cli/calibrate_summary.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "calib/rgbd/comparison.h"
#include "engine/base/text.h"

namespace touchtrace::cli {
namespace {

std::string list_of(const nlohmann::json& names) {
  return comma_separated(names.get<std::vector<std::string>>());
}

void print_depth(const RgbdCalibration& c) {
  const auto& depth = c.details["depth"];
  fmt::print(
      "depth     true = {:+.2f} mm + {:.5f} x measured; {:.2f} mm RMS in {} samples; bias at 1 m "
      "known to {:.2f} mm\n",
      1e3 * c.depth_offset_m, c.depth_scale, 1e3 * c.depth_rms_m, depth["samples"].get<int>(),
      1e3 * depth["bias_sigma_at_1m"].get<double>());
  const Eigen::Vector3d position = 1e3 * c.depth_from_color.translation();
  fmt::print(
      "          colour camera at ({:.1f}, {:.1f}, {:.1f}) mm in the depth camera's frame, rotated "
      "by {:.3f} degrees\n",
      position.x(), position.y(), position.z(),
      Eigen::AngleAxisd(c.depth_from_color.linear()).angle() * 180.0 / 3.14159265358979323846);
}

/// Prints the delay of the depth images, or the reason why it is unknown.
void print_delay(const RgbdCalibration& c) {
  const auto& sigmas = c.details["sigmas"];
  if (!sigmas.contains("depth.delay"))
    fmt::print("          delay of the depth images {}\n",
               c.details["depth"]["delay"].get<std::string>());
  else
    fmt::print("          depth images were taken {:.2f} +- {:.2f} ms after their stamps\n",
               1e3 * c.depth_delay_s, 1e3 * sigmas["depth.delay"].get<double>());
}

/// How the model of the board changes fx, fy, cx, cy.
void print_board_models(const nlohmann::json& models) {
  for (const auto& [key, name] :
       {std::pair{"flat", "flat"}, {"warped", "warped"}, {"free_corners", "free corners"}}) {
    const auto& v = models.at(key);
    if (v.is_array())
      fmt::print("          {:<12} fx {:.2f}  fy {:.2f}  cx {:.2f}  cy {:.2f}\n", name,
                 v[0].get<double>(), v[1].get<double>(), v[2].get<double>(), v[3].get<double>());
  }
}

void print_board(const RgbdCalibration& c) {
  const auto& board = c.details["board"];
  fmt::print("board     {} of {}x{}, ", board["target"].get<std::string>(),
             board["columns"].get<int>(), board["rows"].get<int>());
  if (c.details["board_models"]["warped"].is_null())
    fmt::print("taken as flat\n");
  else
    fmt::print("warped by {:.2f} mm along its columns, {:.2f} mm along its rows\n",
               1e3 * c.board_warp_m[0], 1e3 * c.board_warp_m[1]);
  const auto& deformation = c.details["target_deformation"];
  if (deformation["chosen"] == "free")
    fmt::print(
        "          corners deviate by {:.3f} mm (RMS), estimated with the camera (BIC {:+.1f})\n",
        1e3 * deformation["sigma_m"].get<double>(), -deformation["bic_gain"].get<double>());
  print_board_models(c.details["board_models"]);
}

void print_lens(const RgbdCalibration& c) {
  const auto& details = c.details;
  fmt::print("lens      {}; {:.4f} px RMS", details["lens"].get<std::string>(), c.rms_px);
  const auto& held_out = details["held_out"]["held_out_rms_px"];
  const bool is_known = held_out.is_number() && std::isfinite(held_out.get<double>());
  fmt::print(", {} in held-out views\n",
             is_known ? fmt::format("{:.4f} px", held_out.get<double>())
                      : "unknown (no convergence without some of the views)");
  for (const auto& trial : details["lenses"]) {
    const auto& bic = trial["bic"];
    fmt::print("          {:<10} BIC {}", trial["name"].get<std::string>(),
               bic.is_number() ? fmt::format("{:+.1f}", bic.get<double>()) : "none");
    std::string removed;
    for (const auto& coefficient : trial["removed"])
      removed += (removed.empty() ? "" : ", ") + coefficient["parameter"].get<std::string>();
    fmt::print("{}\n", removed.empty() ? "" : fmt::format("; without {}: unobservable", removed));
  }
  double worst_px = 0.0, cells = 0.0, known = 0.0;
  for (const auto& row : details["projection_sigma_px"])
    for (const auto& sigma : row) {
      ++cells;
      if (sigma.is_number()) ++known, worst_px = std::max(worst_px, sigma.get<double>());
    }
  if (const double inflation = details["view_inflation"]; inflation > 1.0)
    fmt::print(
        "          corners of a view err together: standard deviations are {:.1f} times those "
        "of independent corners\n",
        inflation);
  fmt::print("image     {:.0f} % covered by boards; projection known to {:.2f} px at worst{}\n",
             1e2 * details["coverage"].get<double>(), worst_px,
             known < cells
                 ? fmt::format(", in {:.0f} % of the image not at all", 1e2 * (1.0 - known / cells))
                 : "");
  print_board(c);
}

std::string cells(const Eigen::MatrixXd& shift_px, const Eigen::MatrixXd& sigma_px) {
  std::string text;
  for (Eigen::Index row = 0; row < shift_px.rows(); ++row) {
    text += "         ";
    for (Eigen::Index column = 0; column < shift_px.cols(); ++column)
      text += fmt::format(" {:>5.2f}/{:<5.2f}", shift_px(row, column), sigma_px(row, column));
    text += "\n";
  }
  return text;
}

}  // namespace

void print_summary(const RgbdCalibration& c) {
  const auto& details = c.details;
  const auto& sigma = details["sigmas"];
  fmt::print(
      "camera    fx {:.2f} +- {:.2f}  fy {:.2f} +- {:.2f}  cx {:.2f} +- {:.2f}  cy {:.2f} +- "
      "{:.2f} px\n",
      c.color.fx, sigma["color.fx"].get<double>(), c.color.fy, sigma["color.fy"].get<double>(),
      c.color.cx, sigma["color.cx"].get<double>(), c.color.cy, sigma["color.cy"].get<double>());
  print_lens(c);
  if (c.depth) print_depth(c), print_delay(c);
  if (!details["outlier_views"].empty())
    fmt::print("outliers  excluded views: {}\n", list_of(details["outlier_views"]));
  if (!details["duplicate_views"].empty())
    fmt::print("repeated  views counted once: {}\n", list_of(details["duplicate_views"]));
  for (const auto& image : details["skipped_images"])
    fmt::print("skipped   {}: {}\n", image["name"].get<std::string>(),
               image["why"].get<std::string>());
  if (!details["views_without_board"].empty())
    fmt::print("no board  in views {}\n", list_of(details["views_without_board"]));
  for (const auto& entry : details["not_identifiable"])
    fmt::print("prior     {} cannot be told from these views: keeps its prior value\n",
               entry["parameter"].get<std::string>());
  fmt::print("verdict   {}\n", details["verdict"].get<std::string>());
  for (const auto& advice : details["advice"])
    fmt::print("          {}\n", advice.get<std::string>());
  if (details.contains("next_view"))
    fmt::print("next      a view with the board {}\n", details["next_view"].get<std::string>());
}

void print_comparison(const CalibrationDifference& difference) {
  const double mm_per_px = 1e3 / difference.focal_px;  // at 1 m
  fmt::print(
      "shift     median {:.2f} px, {:.2f} mm at 1 m; worst {:.2f} px, {:.2f} mm; {:.1f} standard "
      "deviations (RMS), {:.1f} at worst\n{}",
      difference.median_px(), mm_per_px * difference.median_px(), difference.worst_px(),
      mm_per_px * difference.worst_px(), difference.rms_sigmas(), difference.worst_sigmas(),
      cells(difference.shift_px, difference.sigma_px));
  fmt::print(
      "          of a far point over the image, and its standard deviation [px]\nverdict   {}\n",
      difference.agrees() ? "the calibrations agree"
                          : "the calibrations differ by more than their covariances say: the "
                            "camera, its focus, the images or the lens model are not the same");
}

}  // namespace touchtrace::cli
