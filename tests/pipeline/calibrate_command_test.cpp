#include <fmt/core.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "calib/board/image_matrix.h"
#include "calib/rgbd/calibration.h"
#include "calib/rig/rig.h"
#include "engine/base/files.h"
#include "pipeline/acquire/board_views.h"
#include "tests/pipeline/calibrate_runs.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

namespace fs = std::filesystem;
using testing::photographs, testing::run_calibrate, testing::write_grey;
using testing::put, testing::TemporaryFolder;

TEST(CalibrateCommand, PhotographsOfOpenCv) {
  ASSERT_TRUE(fs::exists(photographs / "left01.jpg")) << "install the package opencv-doc";
  const TemporaryFolder folder;
  ASSERT_EQ(run_calibrate({"--images", (photographs / "left0?.jpg").string(), "--columns", "9",
                           "--rows", "6", "--square-mm", "25", "-o", (folder / "left").string()}),
            0);
  const RgbdCalibration c = read_calibration(folder / "left");
  EXPECT_LE(c.rms_px, 0.24);
  EXPECT_NEAR(c.color.fx, 533.6, 1.5);
  EXPECT_FALSE(c.depth.has_value());
  EXPECT_EQ(c.details["verdict"], "GOOD");
  EXPECT_EQ(c.details["provenance"]["inputs"].size(), 9u);
  EXPECT_TRUE(fs::exists(folder / "left" / "camera.yaml"));
  EXPECT_FALSE(fs::exists(folder / "left" / "camera_depth.yaml"));
}

TEST(CalibrateCommand, NamesWhatIsThereInsteadOfImages) {
  const TemporaryFolder folder;
  const auto message = [](std::vector<std::string> arguments, int exit_code) {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run_calibrate(std::move(arguments)), exit_code);
    return ::testing::internal::GetCapturedStderr();
  };
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  const std::string path = (folder / "photos").string();
  expect(message({"--images", path}, 3), "nothing has this name");
  fs::create_directory(path);
  expect(message({"--images", path}, 3), "it is empty");
  expect(message({path}, 3), "it is empty");
  write_file(folder / "photos" / "a.HEIC", "not an image", false);
  write_file(folder / "photos" / "b.heic", "not an image", false);
  expect(message({"--images", path}, 3), "it has 2 files of .heic");
  expect(message({"--images", path + "/*"}, 3), "none of 2 files is an image");
  write_grey(folder / "grey.pgm", 320, 240);
  expect(message({(folder / "grey.pgm").string()}, 3), "no image shows a chessboard");
}

TEST(CalibrateCommand, RejectsInvalidMarkers) {
  const TemporaryFolder folder;
  write_grey(folder / "grey.pgm", 320, 240);
  const auto with = [&](const char* markers, const char* marker_mm) {
    return run_calibrate({"--images", (folder / "*.pgm").string(), "--markers", markers,
                          "--marker-mm", marker_mm, "-o", (folder / "out").string()});
  };
  EXPECT_EQ(with("5x5_99", "18"), 2);
  EXPECT_EQ(with("5x5_100", "25"), 2);
  EXPECT_EQ(with("5x5_100", "18"), 3);  // there is no board
}

TEST(CalibrateCommand, RejectsInvalidTargets) {
  const TemporaryFolder folder;
  write_grey(folder / "grey.pgm", 320, 240);
  const auto with = [&](const char* target, const char* columns) {
    return run_calibrate({"--images", (folder / "*.pgm").string(), "--target", target, "--columns",
                          columns, "--rows", "6", "-o", (folder / "out").string()});
  };
  EXPECT_EQ(with("circles", "2"), 2);
  EXPECT_EQ(with("aprilgrid", "100"), 2);  // more tags than there are
  for (const TargetKind* kind : target_kinds()) {
    const bool lacks_markers = kind->dictionary == any_dictionary;
    EXPECT_EQ(with(kind->name, "5"), lacks_markers ? 2 : 3) << kind->name;  // not visible
  }
}

TEST(CalibrateCommand, NeverOverwritesSilently) {
  const TemporaryFolder folder;
  write_file(folder / "out/calibration.json", "precious", false);
  EXPECT_EQ(run_calibrate({"--images", photographs.string(), "-o", (folder / "out").string()}), 2);
  EXPECT_EQ(read_file(folder / "out/calibration.json"), "precious");
}

TEST(CalibrateCommand, SaysWhatIsWrongWithTheImages) {
  const TemporaryFolder folder;
  const auto calibrate_folder = [&](const std::string& name) {
    return run_calibrate({"--images", (folder / name).string(), "-o", (folder / "out").string()});
  };
  EXPECT_EQ(calibrate_folder("missing"), 3);
  fs::create_directory(folder / "empty");
  EXPECT_EQ(calibrate_folder("empty"), 3);
  for (const char* name : {"boardless/1.pgm", "boardless/2.pgm", "boardless/3.pgm"})
    write_grey(folder / name, 64, 48);
  EXPECT_EQ(calibrate_folder("boardless"), 3);
  write_grey(folder / "tiny/1.pgm", 1, 1);
  EXPECT_EQ(calibrate_folder("tiny"), 3);
  write_grey(folder / "mixed/1.pgm", 64, 48);
  write_grey(folder / "mixed/2.pgm", 64, 32);
  EXPECT_EQ(calibrate_folder("mixed"), 3);
  write_file(folder / "broken/1.jpg", "this is no picture", false);
  EXPECT_EQ(calibrate_folder("broken"), 3);
  write_file(folder / "nothing/1.jpg", "", false);
  EXPECT_EQ(calibrate_folder("nothing"), 3);
  EXPECT_FALSE(fs::exists(folder / "out/calibration.json"));
}

TEST(CalibrateCommand, SaysWhatIsWrongWithTheRecording) {
  const TemporaryFolder folder;
  const auto calibrate_recording = [&](const std::string& name) {
    return run_calibrate({(folder / name).string(), "-o", (folder / "out").string()});
  };
  EXPECT_EQ(calibrate_recording("missing.h5"), 3);
  auto sample = testing::sample_recording();
  testing::write(sample, folder / "no_board_seen.h5");
  EXPECT_EQ(calibrate_recording("no_board_seen.h5"), 3);
  sample.board.clear();
  testing::write(sample, folder / "no_views.h5");
  EXPECT_EQ(calibrate_recording("no_views.h5"), 3);
}

TEST(CalibrateCommand, RequiresEitherARecordingOrImages) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_calibrate({"-o", (folder / "out").string()}), 2);
  EXPECT_EQ(run_calibrate({"recording.h5", "--images", "photos", "-o", (folder / "out").string()}),
            2);
  EXPECT_EQ(run_calibrate({"--images", "photos"}),
            3);  // into the default folder, but there are none
}

/// Nine photographs, an empty file, a text file, and an image of another size.
TEST(CalibrateCommand, SkipsAndListsFilesThatAreNotViews) {
  const TemporaryFolder folder;
  for (int i = 1; i <= 9; ++i) {
    const auto name = "left0" + std::to_string(i) + ".jpg";
    put(folder / name, read_file(photographs / name));
  }
  put(folder / "empty.jpg", "");
  put(folder / "text.png", "this is no picture");
  write_grey(folder / "thumbnail.pgm", 64, 48);
  ASSERT_EQ(run_calibrate({"--images", folder.path().string(), "-o", (folder / "out").string()}),
            0);
  const auto details = read_calibration(folder / "out").details;
  std::vector<std::string> skipped;
  for (const auto& image : details["skipped_images"]) skipped.push_back(image["name"]);
  EXPECT_EQ(skipped, (std::vector<std::string>{"empty.jpg", "text.png", "thumbnail.pgm"}));
  EXPECT_EQ(details["views"].size(), 9u);
}

/// Ends when the calibration is good; reads a file again that could not be read and has changed.
TEST(CalibrateCommand, WatchesAFolderUntilTheCalibrationIsGood) {
  ASSERT_TRUE(fs::exists(photographs / "left01.jpg")) << "install the package opencv-doc";
  const TemporaryFolder folder;
  fs::create_directory(folder / "photos");
  write_file(folder / "photos/left01.jpg", "not written yet", false);
  std::thread photographer([&] {
    for (int i = 2; i <= 8; ++i) {  // GOOD takes eight views
      const std::string name = "left0" + std::to_string(i) + ".jpg";
      fs::copy_file(photographs / name, folder / "photos" / name);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    fs::copy_file(photographs / "left01.jpg", folder / "photos/left01.jpg",
                  fs::copy_options::overwrite_existing);
  });
  EXPECT_EQ(run_calibrate({"--images", (folder / "photos").string(), "--watch", "--output",
                           (folder / "camera").string()}),
            0);
  photographer.join();
  EXPECT_EQ(read_calibration(folder / "camera").details["verdict"], "GOOD");
}

TEST(CalibrateCommand, WatchTakesOneFolder) {
  const TemporaryFolder folder;
  const std::string photos = folder / "photos";
  EXPECT_EQ(run_calibrate({"--watch", "--corners", photos}), 2);
  EXPECT_EQ(run_calibrate({"--watch", "--camera", "a=" + photos, "b=" + photos}), 2);
  EXPECT_EQ(run_calibrate({"--watch", "--images", photos, "--output", folder / "camera"}), 3);
}

/// cv::stereoCalibrate on the same corners: 83.16 mm, or 83.18 mm without the frame 08.
TEST(CalibrateCommand, CalibratesTheStereoPairOfOpenCv) {
  const TemporaryFolder folder;
  const auto calibrate_pair = [&](const std::string& output) {
    return run_calibrate({"--camera", "left=" + (photographs / "left[01]?.jpg").string(),
                          "right=" + (photographs / "right[01]?.jpg").string(), "--lens", "radtan4",
                          "--output", (folder / output).string()});
  };
  ASSERT_EQ(calibrate_pair("stereo"), 0);
  EXPECT_EQ(calibrate_pair("stereo"), 2);  // does not overwrite
  const RigCalibration rig = read_rig(folder / "stereo");
  const RelativePose pose = relative_pose(rig, 1);
  EXPECT_NEAR(pose.baseline_m, 0.08318, 4.0 * pose.baseline_sigma_m);
  EXPECT_LT(pose.baseline_sigma_m, 2e-4);
  EXPECT_LT(rig.details["epipolar"][0]["rms_px"].get<double>(), 0.2);
  EXPECT_EQ(rig.details["verdict"],
            "WEAK");  // as the left camera alone: its board moves cy by 4 px
  EXPECT_NE(rig.details["advice"].dump().find("left: free corners"), std::string::npos);
  EXPECT_EQ(read_calibration(folder / "stereo/right").color.parameters(),
            rig.cameras[1].color.parameters());
  for (const char* name : {"camchain.yaml", "left_right_opencv.yaml", "left/camera.yaml"})
    EXPECT_TRUE(fs::exists(folder / "stereo" / name)) << name;
  EXPECT_EQ(run_calibrate({"--compare", (folder / "stereo").string(),
                           (folder / "stereo/camchain.yaml").string()}),
            0);
}

TEST(CalibrateCommand, SaysWhatIsWrongWithTheCameras) {
  const TemporaryFolder folder;
  write_grey(folder / "a/1.pgm", 64, 48);
  write_grey(folder / "b/1.pgm", 64, 48);
  const std::string a = folder / "a", b = folder / "b", out = folder / "out";
  const auto with = [&](std::vector<std::string> cameras) {
    cameras.insert(cameras.begin(), "--camera");
    cameras.insert(cameras.end(), {"--output", out});
    return run_calibrate(cameras);
  };
  EXPECT_EQ(with({a}), 2);
  EXPECT_EQ(with({"x=" + a, "x=" + b}), 2);
  EXPECT_EQ(with({"../x=" + a, "y=" + b}), 2);
  EXPECT_EQ(with({"x=", "y=" + b}), 2);
  EXPECT_EQ(with({a, b, "--images", a}), 2);
  EXPECT_EQ(with({a, b}), 3);  // there is no board
  EXPECT_EQ(with({a, "y=" + (folder / "missing").string()}), 3);
  EXPECT_FALSE(fs::exists(folder / "out/rig.json"));
}

TEST(CalibrateCommand, AcceptsAnExpandedPattern) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments{"-o", (folder / "out").string(), "--images"};
  for (int i = 1; i <= 5; ++i)
    arguments.push_back((photographs / ("left0" + std::to_string(i) + ".jpg")).string());
  EXPECT_EQ(run_calibrate(arguments), 0);
}

/// A photograph enlarged four times: the corners are those of the photograph, within the error of
/// either detection.
TEST(CalibrateCommand, FindsTheBoardInALargeImage) {
  const GreyImage small = read_grey(photographs / "left01.jpg");
  const cv::Mat original(small.height, small.width, CV_8U,
                         const_cast<std::uint8_t*>(small.pixels.data()));
  cv::Mat enlarged;
  cv::resize(original, enlarged, {}, 4.0, 4.0, cv::INTER_CUBIC);
  const auto expected = find_chessboard(small, CalibrationTarget{}).corners_px;
  const auto found = find_chessboard(grey_image(enlarged), CalibrationTarget{}).corners_px;
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Vector2d in_original = (found[i].array() + 0.5) / 4.0 - 0.5;
    EXPECT_LT((in_original - expected[i]).norm(), 0.3) << i;
  }
  cv::Mat without(enlarged.size(), CV_8U, cv::Scalar(128));
  EXPECT_TRUE(find_chessboard(grey_image(without), CalibrationTarget{}).corners_px.empty());
}

TEST(CalibrateCommand, NamesTheSizeOfTheBoardThatTheImagesShow) {
  const TemporaryFolder folder;
  ::testing::internal::CaptureStderr();
  const int code = run_calibrate({"--images", (photographs / "left0?.jpg").string(), "--columns",
                                  "8", "--rows", "5", "-o", (folder / "out").string()});
  const std::string message = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(code, 3);
  EXPECT_NE(message.find("--columns 9 --rows 6"), std::string::npos) << message;
}

TEST(CalibrateCommand, FindsTheSizeOfTheBoardInTheImages) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_calibrate(
                {"--images", (photographs / "left0?.jpg").string(), "-o", folder.path().string()}),
            0);
  const auto board = read_calibration(folder.path()).details["board"];
  EXPECT_EQ(board["columns"], 9);
  EXPECT_EQ(board["rows"], 6);
  EXPECT_EQ(run_calibrate({"--images", photographs.string(), "--columns", "9", "-o",
                           folder.path().string(), "--overwrite"}),
            2);
}

}  // namespace
}  // namespace touchtrace
