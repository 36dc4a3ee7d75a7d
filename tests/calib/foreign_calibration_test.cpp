#include "calib/rgbd/foreign_calibration.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/core.hpp>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/scratch_folder.h"
#include "tests/support/expect_error.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;

class ForeignCalibration : public ::testing::Test {
 protected:
  RgbdCalibration read(const std::string& text) {
    write_file(folder_ / "foreign.yaml", text, true);
    return read_calibration(folder_ / "foreign.yaml");
  }
  void expect_rejected(const std::string& text) {
    SCOPED_TRACE(text.substr(0, 200));
    testing::expect_error([&] { read(text); }, "");
  }

  ScratchFolder scratch_;
  fs::path folder_ = scratch_.path();
};

RgbdCalibration rgbd_pair(double k3 = 0.0) {
  RgbdCalibration c;
  c.color.width = 640, c.color.height = 480;
  c.color.lens = k3 == 0.0 ? Lens(Radtan4{}) : Lens(Radtan5{});
  c.color.set_parameters({533.1234567890123, 531.0, 342.0, 235.0, -0.28, 0.09, 1e-20, -7e-4, k3});
  c.depth = c.color;
  c.depth->fx = 600.5;
  c.depth_from_color.linear() =
      Eigen::AngleAxisd(0.01, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  c.depth_from_color.translation() << 0.025, 0.001, -0.002;
  return c;
}

TEST_F(ForeignCalibration, RoundTripsExactly) {
  const RgbdCalibration c = rgbd_pair();
  write_calibration(folder_, c, false);
  for (const char* name : {"camera.yaml", "camera_opencv.yaml", "camchain.yaml"}) {
    const RgbdCalibration read = read_calibration(folder_ / name);
    EXPECT_EQ(read.color.parameters(), c.color.parameters()) << name;
    EXPECT_EQ(lens_name(read.color.lens), "radtan4") << name;
    EXPECT_EQ(read.color.width, 640) << name;
    EXPECT_EQ(read.color.height, 480) << name;
    EXPECT_EQ(read.depth_scale, 1.0) << name;
  }
  const RgbdCalibration depth = read_calibration(folder_ / "camera_depth_opencv.yaml");
  EXPECT_EQ(depth.color.parameters(), c.depth->parameters());
  EXPECT_FALSE(depth.depth.has_value());
  const RgbdCalibration chain = read_calibration(folder_ / "camchain.yaml");
  ASSERT_TRUE(chain.depth.has_value());
  EXPECT_EQ(chain.depth->parameters(), c.depth->parameters());
  EXPECT_EQ(chain.depth_from_color.matrix(), c.depth_from_color.matrix());
}

TEST_F(ForeignCalibration, OpenCvReadsMatrices) {
  write_calibration(folder_, rgbd_pair(), false);
  cv::FileStorage storage((folder_ / "camera_opencv.yaml").string(), cv::FileStorage::READ);
  cv::Mat camera_matrix, distortion;
  storage["camera_matrix"] >> camera_matrix;
  storage["distortion_coefficients"] >> distortion;
  ASSERT_EQ(camera_matrix.size(), cv::Size(3, 3));
  EXPECT_EQ(camera_matrix.at<double>(0, 0), rgbd_pair().color.fx);
  EXPECT_EQ(camera_matrix.at<double>(1, 2), rgbd_pair().color.cy);
  ASSERT_EQ(distortion.total(), 5u);
  EXPECT_EQ(static_cast<int>(storage["fisheye_model"]), 0);
  EXPECT_EQ(distortion.at<double>(3), -7e-4);
}

/// What kalibr's reader requires: PyYAML, floats, four coefficients, a 4x4 matrix.
TEST_F(ForeignCalibration, KalibrReadsTheCamchain) {
  write_calibration(folder_, rgbd_pair(), false);
  const std::string script =
      "import sys, yaml\n"
      "chain = yaml.safe_load(open(sys.argv[1]))\n"
      "for name in ('cam0', 'cam1'):\n"
      "    cam = chain[name]\n"
      "    assert cam['camera_model'] == 'pinhole' and cam['distortion_model'] == 'radtan'\n"
      "    assert len(cam['intrinsics']) == 4 and len(cam['distortion_coeffs']) == 4\n"
      "    assert all(type(x) is float for x in cam['intrinsics'] + cam['distortion_coeffs'])\n"
      "    assert cam['resolution'] == [640, 480] and cam['rostopic'].startswith('/')\n"
      "rows = chain['cam1']['T_cn_cnm1']\n"
      "assert [len(row) for row in rows] == [4] * 4 and rows[3] == [0.0, 0.0, 0.0, 1.0]\n"
      "assert rows[0][3] == 0.025\n";
  write_file(folder_ / "read.py", script, false);
  const std::string command = "/usr/bin/python3 " + (folder_ / "read.py").string() + " " +
                              (folder_ / "camchain.yaml").string();
  EXPECT_EQ(std::system(command.c_str()), 0);
}

RgbdCalibration with_lens_of(const Lens& lens, const std::array<double, 8>& coefficients) {
  RgbdCalibration c = rgbd_pair();
  c.color.lens = lens;
  c.color.distortion = Eigen::Map<const Eigen::Matrix<double, 8, 1>>(coefficients.data());
  c.depth->lens = Undistorted{};
  c.depth->distortion.setZero();
  return c;
}

TEST_F(ForeignCalibration, LensModelsRoundTrip) {
  const RgbdCalibration fisheye = with_lens_of(Fisheye4{}, {0.02, -0.015, 0.006, -0.001});
  const RgbdCalibration rational =
      with_lens_of(Rational8{}, {0.6, 0.1, 0.001, -0.0007, 0.01, 0.9, 0.3, 0.02});
  for (const RgbdCalibration& c : {fisheye, rational}) {
    write_calibration(folder_, c, true);
    std::vector<const char*> names{"camera.yaml", "camera_opencv.yaml"};
    if (!is_perspective(c.color.lens)) names.push_back("camchain.yaml");
    for (const char* name : names) {
      const RgbdCalibration read = read_calibration(folder_ / name);
      EXPECT_EQ(lens_name(read.color.lens), lens_name(c.color.lens)) << name;
      EXPECT_EQ(read.color.parameters(), c.color.parameters()) << name;
    }
    const auto depth = read_calibration(folder_ / "camchain.yaml").depth;
    ASSERT_TRUE(depth.has_value());
    EXPECT_EQ(lens_name(depth->lens), "none");
  }
}

TEST_F(ForeignCalibration, FourCoefficientsApproximateFive) {
  const RgbdCalibration five = rgbd_pair(0.05);
  const std::string text = camchain_yaml(five);
  const RgbdCalibration four = read(text);
  EXPECT_EQ(four.color.distortion[4], 0.0);
  double worst_px = 0.0, dropped_px = 0.0;
  Camera dropped = five.color;
  dropped.distortion[4] = 0.0;
  for (double u = 0.0; u < 640.0; u += 40.0)
    for (double v = 0.0; v < 480.0; v += 40.0) {
      const Eigen::Vector3d ray = five.color.unproject({u, v});
      ASSERT_TRUE(ray.allFinite());
      worst_px = std::max(worst_px, (four.color.project(ray) - Eigen::Vector2d(u, v)).norm());
      dropped_px = std::max(dropped_px, (dropped.project(ray) - Eigen::Vector2d(u, v)).norm());
    }
  EXPECT_LT(worst_px, 0.1 * dropped_px);
  const auto at = text.find("image ", text.find("radtan5"));
  EXPECT_LE(worst_px, std::stod(text.substr(at + 6)) + 1e-3) << text;
}

TEST_F(ForeignCalibration, ReadsCameraInfoMessagesAsRosPrintsThem) {
  const std::string rest =
      "height: 480\nwidth: 640\nheader:\n  stamp: {secs: 1, nsecs: 2}\n  frame_id: \"camera\"\n";
  const auto ros1 = read(rest +
                         "distortion_model: \"plumb_bob\"\nD: [-0.25, 0.0625, 0.0, 0.0, 0.0]\n"
                         "K: [500.5, 0.0, 320.0, 0.0, 501.5, 240.0, 0.0, 0.0, 1.0]\n---\n" +
                         rest + "K: [1.0]\n---\n");
  EXPECT_EQ(lens_name(ros1.color.lens), "radtan4");
  EXPECT_EQ(ros1.color.fx, 500.5);
  EXPECT_EQ(ros1.color.cy, 240.0);
  EXPECT_EQ(ros1.color.distortion[1], 0.0625);
  const auto ros2 = read(rest +
                         "distortion_model: Inverse Brown Conrady\nd: [0.0, 0.0]\nk:\n- 500.5\n"
                         "- 0.0\n- 320.0\n- 0.0\n- 501.5\n- 240.0\n- 0.0\n- 0.0\n- 1.0\n");
  EXPECT_EQ(lens_name(ros2.color.lens), "none");
  EXPECT_EQ(ros2.color.parameters()[1], 501.5);
  write_file(folder_ / "info.json",
             R"({"width": 640, "height": 480, "K": [500, 0, 320, 0, 500, 240, 0, 0, 1]})", true);
  EXPECT_EQ(read_calibration(folder_ / "info.json").color.width, 640);
  expect_rejected(rest + "K: [500.5, 0.0]\n");
  expect_rejected(rest + "distortion_model: fov\nD: [0.5]\nK: [5, 0, 3, 0, 5, 2, 0, 0, 1]\n");
}

TEST_F(ForeignCalibration, RejectsInvalidFiles) {
  write_calibration(folder_, rgbd_pair(), false);
  const std::string chain = read_file(folder_ / "camchain.yaml"),
                    info = read_file(folder_ / "camera.yaml");
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  expect_rejected("");
  expect_rejected("- 1\n- 2\n");
  expect_rejected("cam0: 3\n");
  expect_rejected("a: [1, 2\n");
  expect_rejected("camera_matrix: {data: [1, 2]}\n");
  expect_rejected(std::string(5000, '['));
  expect_rejected(std::string("\xff\xfe\x00\x01", 4));
  expect_rejected(with(chain, "radtan", "fov"));
  expect_rejected(with(chain, "camera_model: pinhole", "camera_model: omni"));
  expect_rejected(with(chain, "533.1234567890123", "-533.0"));
  expect_rejected(with(chain, "533.1234567890123", ".nan"));
  expect_rejected(with(chain, "[640, 480]", "[640]"));
  expect_rejected(with(chain, "- [0.0, 0.0, 0.0, 1.0]", "- [0.0, 0.0, 1.0, 1.0]"));
  expect_rejected(with(info, "plumb_bob", "thin_prism"));
  expect_rejected(with(info, "image_width: 640", "image_width: wide"));
}

TEST_F(ForeignCalibration, LimitsTheExpansionOfAliases) {
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 12; ++i) {
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int j = 0; j < 10; ++j) bomb += (j ? ", *a" : "*a") + std::to_string(i - 1);
    bomb += "]\n";
  }
  expect_rejected(bomb);
}

}  // namespace
}  // namespace touchtrace
