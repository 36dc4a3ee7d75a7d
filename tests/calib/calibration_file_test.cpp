#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>

#include "calib/rgbd/calibration.h"
#include "calib/rgbd/calibration_json.h"
#include "calib/rgbd/camera_info.h"
#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/scratch_folder.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

class CalibrationFile : public ::testing::Test {
 protected:
  ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
};

RgbdCalibration example() {
  RgbdCalibration c;
  c.color.width = 640, c.color.height = 480;
  c.color.lens = Radtan4{};
  c.color.set_parameters({533.1234567890123, 531.0, 342.0, 235.0, -0.28, 0.09, 1e-20, -7e-4, 0.0});
  c.depth = c.color;
  c.depth_from_color.linear() =
      Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()).toRotationMatrix();
  c.depth_from_color.translation() << 0.025, 0.001, -0.002;
  c.depth_scale = 1.01, c.depth_offset_m = -0.003;
  c.depth_delay_s = 0.011, c.board_warp_m = {3e-4, -1e-4};
  c.rms_px = 0.2, c.depth_rms_m = 0.004;
  c.parameters = {"color.fx", "color.fy"};
  c.covariance = Eigen::Matrix2d{{1.0, 0.1}, {0.1, 2.0}};
  c.details["verdict"] = "GOOD";
  return c;
}

TEST_F(CalibrationFile, ReadsBackWhatWasWritten) {
  const auto written = example();
  write_calibration(folder_, written, false);
  const auto read = read_calibration(folder_);
  EXPECT_EQ(read.color.parameters(), written.color.parameters());
  EXPECT_EQ(lens_name(read.color.lens), "radtan4");
  EXPECT_EQ(read.color.width, 640);
  ASSERT_TRUE(read.depth.has_value());
  EXPECT_EQ(read.depth->parameters(), written.depth->parameters());
  EXPECT_EQ(read.depth_from_color.matrix(), written.depth_from_color.matrix());
  EXPECT_EQ(read.depth_scale, written.depth_scale);
  EXPECT_EQ(read.depth_offset_m, written.depth_offset_m);
  EXPECT_EQ(read.depth_delay_s, written.depth_delay_s);
  EXPECT_EQ(read.board_warp_m, written.board_warp_m);
  EXPECT_EQ(read.parameters, written.parameters);
  EXPECT_EQ(read.covariance, written.covariance);
  EXPECT_EQ(read.details, written.details);
}

TEST_F(CalibrationFile, ReadsKeysOfOlderVersions) {
  auto document = calibration_json(example());
  document["details"]["board_print"] = {{"sigma_m", 1e-4}};
  document["details"]["not_told"] = nlohmann::json::array({{{"parameter", "color.fx"}}});
  const auto details = calibration_from_json(document).details;
  EXPECT_EQ(details.at("target_deformation").at("sigma_m"), 1e-4);
  EXPECT_EQ(details.at("not_identifiable").at(0).at("parameter"), "color.fx");
  EXPECT_FALSE(details.contains("board_print") || details.contains("not_told"));
}

TEST_F(CalibrationFile, CameraInfoIsYamlWithFloats) {
  const auto camera = example().color;
  const std::string text = camera_info_yaml("color", camera);
  EXPECT_NE(text.find("data: [533.1234567890123, 0.0, 342.0, 0.0, 531.0, 235.0, 0.0, 0.0, 1.0]"),
            std::string::npos);
  cv::FileStorage yaml("%YAML:1.0\n---\n" + text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
  EXPECT_EQ(static_cast<int>(yaml["image_width"]), 640);
  EXPECT_EQ(static_cast<std::string>(yaml["distortion_model"]), "plumb_bob");
  EXPECT_EQ(static_cast<double>(yaml["camera_matrix"]["data"][0]), camera.fx);
  EXPECT_EQ(static_cast<double>(yaml["distortion_coefficients"]["data"][2]), 1e-20);
  EXPECT_EQ(yaml["projection_matrix"]["data"].size(), 12u);
}

TEST_F(CalibrationFile, DoesNotOverwriteNorWriteInPart) {
  write_file(folder_ / "calibration.json", "precious", false);
  EXPECT_THROW(write_calibration(folder_, example(), false), Error);
  EXPECT_FALSE(fs::exists(folder_ / "camera.yaml"));
  EXPECT_EQ(read_file(folder_ / "calibration.json"), "precious");
  write_calibration(folder_, example(), true);
  EXPECT_EQ(read_calibration(folder_).rms_px, 0.2);
}

/// Expects a data error for the example with one member replaced.
void expect_rejected(const fs::path& folder, const char* pointer, const nlohmann::json& value) {
  nlohmann::json document = calibration_json(example());
  document[nlohmann::json::json_pointer(pointer)] = value;
  write_file(folder / "calibration.json", document.dump(), true);
  SCOPED_TRACE(pointer);
  testing::expect_error([&] { read_calibration(folder); }, "");
}

TEST_F(CalibrationFile, RejectsInvalidMembers) {
  expect_rejected(folder_, "/schema", "touchtrace/labels/1");
  expect_rejected(folder_, "/color/width", 0);
  expect_rejected(folder_, "/color/width", 1e300);
  expect_rejected(folder_, "/color/intrinsics_px/0", -1.0);
  expect_rejected(folder_, "/color/intrinsics_px/0", nullptr);
  expect_rejected(folder_, "/color/lens", "radtan3");
  expect_rejected(folder_, "/color/distortion", nlohmann::json::object({{"k1", 1.0}}));
  expect_rejected(folder_, "/color/distortion/k1", "far");
  expect_rejected(folder_, "/depth_from_color/0/0", 2.0);
  expect_rejected(folder_, "/depth_scale", 0.0);
  expect_rejected(folder_, "/covariance", nlohmann::json::array());
  expect_rejected(folder_, "/parameters", "fx");
}

TEST_F(CalibrationFile, RejectsEveryFlippedBitButAcceptsTextWithoutChecksum) {
  write_calibration(folder_, example(), false);
  const auto path = folder_ / "calibration.json";
  auto text = read_file(path);
  for (std::size_t bit = 0; bit < 8 * text.size(); bit += 13) {
    text[bit / 8] ^= static_cast<char>(1 << bit % 8);
    std::ofstream(path, std::ios::binary) << text;
    text[bit / 8] ^= static_cast<char>(1 << bit % 8);
    EXPECT_THROW(read_calibration(folder_), Error) << bit;
  }
  auto document = nlohmann::json::parse(text);
  document.erase("checksum");
  document["depth_scale"] = 1.5;
  write_file(path, document.dump(), true);
  EXPECT_EQ(read_calibration(folder_).depth_scale, 1.5);
}

TEST_F(CalibrationFile, RejectsTruncatedAndMissingFiles) {
  EXPECT_THROW(read_calibration(folder_ / "none"), Error);
  testing::expect_error([&] { read_calibration(folder_ / "chain.yaml"); },
                        "chain.yaml does not exist", {});
  write_calibration(folder_, example(), false);
  const auto whole = read_file(folder_ / "calibration.json");
  write_file(folder_ / "calibration.json", whole.substr(0, whole.size() / 2), true);
  EXPECT_THROW(read_calibration(folder_), Error);
}

/// Extrinsics that people copy from a page have few decimals.
TEST(PoseFromJson, ReplacesARoundedRotationByTheNearestOne) {
  const Eigen::Matrix3d exact =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  Eigen::Matrix4d rounded = Eigen::Matrix4d::Identity();
  rounded.topLeftCorner<3, 3>() = (1000.0 * exact).array().round() / 1000.0;
  const Eigen::Matrix3d read = pose_from_json(matrix_json(rounded), "pose").linear();
  EXPECT_TRUE(read.isUnitary(1e-12));
  // the rounded matrix is at most 3 x 0.0005 from the exact rotation, hence from the nearest one
  EXPECT_LT((read - exact).norm(), 2.0 * 3.0 * 0.0005);
}

TEST(PoseFromJson, RejectsAScaledRotation) {
  Eigen::Matrix4d scaled = Eigen::Matrix4d::Identity();
  scaled.topLeftCorner<3, 3>() *= 1.01;
  EXPECT_THROW(pose_from_json(matrix_json(scaled), "pose"), std::exception);
}

}  // namespace
}  // namespace touchtrace
