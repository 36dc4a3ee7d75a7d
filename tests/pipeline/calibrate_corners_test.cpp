// `touchtrace calibrate --corners`.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "calib/rgbd/calibration.h"
#include "engine/base/files.h"
#include "tests/pipeline/calibrate_runs.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

using testing::photographs, testing::run_calibrate, testing::write_grey;
using testing::put, testing::TemporaryFolder;

/// The corners of calibration.json, and the same as text of mrcal with one view partly seen.
TEST(CalibrateCorners, AreReadFromAFile) {
  const TemporaryFolder folder;
  const auto out = [&](const char* name) { return (folder / name).string(); };
  ASSERT_EQ(run_calibrate({"--images", (photographs / "left0?.jpg").string(), "-o", out("images")}),
            0);
  const RgbdCalibration images = read_calibration(folder / "images");
  ASSERT_EQ(run_calibrate({"--corners", out("images/calibration.json"), "-o", out("json")}), 0);
  EXPECT_EQ(read_calibration(folder / "json").color.parameters(), images.color.parameters());

  std::string lines = "# filename x y level\n";
  for (const auto& view : images.details["views"]) {
    const std::string name = view["name"];
    put(folder / name, read_file(photographs / name));
    for (std::size_t i = 0; i < view["corners_px"].size(); ++i) {
      const auto& corner = view["corners_px"][i];
      lines += name == "left01.jpg" && i < 9
                   ? name + " - - -\n"
                   : fmt::format("{} {:.17g} {:.17g} 0\n", name, corner[0].get<double>(),
                                 corner[1].get<double>());
    }
  }
  put(folder / "corners.vnl", lines);
  ASSERT_EQ(run_calibrate({"--corners", out("corners.vnl"), "-o", out("vnl")}), 0);
  const RgbdCalibration vnl = read_calibration(folder / "vnl");
  EXPECT_EQ(vnl.details["views"][0]["corners_px"].size(), 45u);
  EXPECT_NEAR(vnl.color.fx, images.color.fx, 3.0);
  put(folder / "corners.vnl", "left01.jpg 1 2 x\nleft01.jpg here there 0\n");
  EXPECT_EQ(run_calibrate({"--corners", out("corners.vnl"), "-o", out("broken")}), 3);
  put(folder / "corners.json", "{\"color\": 3}");
  EXPECT_EQ(run_calibrate({"--corners", out("corners.json"), "-o", out("broken")}), 3);
}

/// Eight views of 6x4 tags, circles or corners, 640x480 pixels, each without its first corner.
std::string projected_corners(const CalibrationTarget& target) {
  std::string lines;
  for (int view = 0; view < 8; ++view) {
    const Eigen::Vector3d turn(0.5 * (view % 3 - 1) + 0.1, view % 2 ? 0.5 : -0.4, 0.2 * view);
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    const Eigen::Vector3d centre_m = 0.5 * target.corner_m(target.num_corners() - 1);
    for (int id = 0; id < target.num_corners(); ++id) {
      const Eigen::Vector3d at_m = rotation * (target.corner_m(id) - centre_m) +
                                   Eigen::Vector3d(0.02 * (view % 3 - 1), 0.0, 0.6);
      lines += id == 0 ? fmt::format("{}.pgm - - -\n", view)
                       : fmt::format("{}.pgm {:.9g} {:.9g} 0\n", view,
                                     600.0 * at_m.x() / at_m.z() + 320.0,
                                     600.0 * at_m.y() / at_m.z() + 240.0);
    }
  }
  return lines;
}

TEST(CalibrateCorners, OfEveryKindOfTargetAreRead) {
  const TemporaryFolder folder;
  for (int view = 0; view < 8; ++view)
    write_grey(folder / (std::to_string(view) + ".pgm"), 640, 480);
  for (const TargetKind* kind : target_kinds()) {
    CalibrationTarget target{6, 4, 0.03, CalibrationTarget::Markers{"5x5_100", 0.02}, kind};
    target.columns *= kind->element_corners, target.rows *= kind->element_corners;
    const auto corners = folder / "corners.vnl", out = folder / kind->name;
    put(corners, projected_corners(target));
    SCOPED_TRACE(kind->name);
    const int code = run_calibrate(
        {"--corners", corners.string(), "--target", kind->name, "--columns", "6", "--rows", "4",
         "--square-mm", "30", "--marker-mm", "20", "--tag-spacing", "0.5", "--markers",
         kind->dictionary == any_dictionary ? "5x5_100" : "none", "-o", out.string()});
    ASSERT_EQ(code, 0);
    const RgbdCalibration found = read_calibration(out);
    EXPECT_NEAR(found.color.fx, 600.0, 0.01);
    EXPECT_NEAR(found.color.cx, 320.0, 0.01);
    EXPECT_EQ(found.details["views"][0]["corner_ids"][0], 1);
  }
}

}  // namespace
}  // namespace touchtrace
