// Masks and intrinsics that do not fit the images.
#include "pipeline/acquire/import/masks.h"
#include "pipeline/recording/check.h"
#include "pipeline/recording/intrinsics_check.h"
#include "tests/pipeline/import_samples.h"
#include "tests/support/command_line.h"

namespace touchtrace {
namespace {

class ImportMasks : public Import {
 protected:
  void SetUp() override {
    Import::SetUp();
    add_images();
    options_.masks = (folder_ / "masks").string();
  }
  void write_mask(const std::string& name, int value) {
    cv::Mat mask(import_height, import_width, CV_8UC1, cv::Scalar(0));
    mask.at<std::uint8_t>(0, 2) = static_cast<std::uint8_t>(value);
    add_file("masks/" + name, encoded(mask));
  }
  /// Whether the import warns of `text`.
  bool import_warns_of(const std::string& text) {
    import("in", options_);
    return warns_of(text);
  }

  ImportOptions options_ = at_rate(30.0);
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(ImportMasks, NameTheInstancesIfNoneIsHandOrObject) {
  write_mask("0.png", 35), write_mask("1.png", 120);
  expect_rejected("in", "no mask has the id 1 of the hand or 2 of the object; found: 0, 35, 120",
                  options_);
  cv::Mat palette(import_height, import_width, CV_8UC3, cv::Scalar(0, 0, 0));
  palette.at<cv::Vec3b>(0, 2) = {0, 128, 128};  // palette index 3
  palette.at<cv::Vec3b>(0, 3) = {7, 7, 7};
  fs::remove_all(folder_ / "masks");
  add_file("masks/0.png", encoded(palette));
  expect_rejected("in", "found: other colours, 0, 3", options_);
}

TEST_F(ImportMasks, MayBeGreyOrOfOneBody) {
  cv::Mat grey(import_height, import_width, CV_8UC3, cv::Scalar(0, 0, 0));
  grey.at<cv::Vec3b>(0, 2) = {255, 255, 255};
  add_file("masks/0.png", encoded(grey));
  options_.mask_ids.object = 255;
  EXPECT_EQ(import("in", options_).read_camera_frame(0).mask.at(2), mask_object);
  fs::remove_all(folder_ / "masks");
  write_mask("object/0.png", 9);
  EXPECT_EQ(import("in", options_).read_camera_frame(0).mask.at(2), mask_object);
}

TEST_F(ImportMasks, WarnIfOneBodyIsMissing) {
  write_mask("0.png", 35);
  options_.mask_ids.hand = 35;
  EXPECT_TRUE(import_warns_of(
      "warning: the masks show the hand only: none has the id 2 of the object (--object-id)"));
}

TEST_F(ImportMasks, WarnOfThoseWithoutAnImage) {
  write_mask("0.png", 1), write_mask("1.png", 2);
  EXPECT_FALSE(import_warns_of("warning: 2 of"));
  write_mask("17.png", 1), write_mask("18.png", 2);
  EXPECT_TRUE(import_warns_of(
      "warning: 2 of 4 masks are skipped: no colour image has the name of 17.png, .. 18.png"));
}

TEST_F(ImportMasks, OfAnotherSizeAreRefused) {
  for (const char* name : {"0.png", "1.png"})
    add_file(fmt::format("masks/{}", name), encoded(cv::Mat(2, 3, CV_8UC1, cv::Scalar(1))));
  expect_rejected("in", "2 of 2 masks cannot be used", options_);
}

TEST_F(ImportMasks, MayHaveOtherLeadingZeros) {
  write_mask("1.png", 1), write_mask("0010.png", 2), write_mask("b_7.50.png", 1);
  const auto files = mask_files(folder_ / "masks", {{"rgb/000001.png"},
                                                    {"rgb/000010.png"},
                                                    {"rgb/000100.png"},
                                                    {"b_007.50.png"},
                                                    {"b_7.050.png"}});
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files.at(0).instances.filename(), "1.png");
  EXPECT_EQ(files.at(1).instances.filename(), "0010.png");
  EXPECT_EQ(files.at(3).instances.filename(), "b_7.50.png");
}

TEST_F(ImportMasks, MayHaveAFileForEachBody) {
  cv::Mat hand(import_height, import_width, CV_8UC1, cv::Scalar(0)), object = hand.clone();
  hand.at<std::uint8_t>(0, 2) = 255, object.at<std::uint8_t>(1, 3) = 1;
  add_file("masks/hand/0.png", encoded(hand));
  add_file("masks/object/0.png", encoded(object));
  const auto masks = import("in", options_).read_mask(0);
  EXPECT_EQ(masks.at(2), mask_hand);
  EXPECT_EQ(masks.at(import_width + 3), mask_object);
  EXPECT_EQ(std::ranges::count(masks, mask_other), std::ptrdiff_t(masks.size() - 2));
}

TEST_F(ImportMasks, OfBodiesMayHaveSixteenBits) {
  cv::Mat hand(import_height, import_width, CV_16UC1, cv::Scalar(0));
  hand.at<std::uint16_t>(0, 2) = 1;
  add_file("masks/hand/0.png", encoded(hand));
  EXPECT_EQ(import("in", options_).read_mask(0).at(2), mask_hand);
}

TEST_F(ImportMasks, MayNotAllBeEmpty) {
  const cv::Mat empty(import_height, import_width, CV_8UC1, cv::Scalar(0));
  add_file("masks/hand/0.png", encoded(empty));
  expect_rejected("in", "all pixels of all masks are 0", options_);
}

TEST_F(ImportMasks, AreNotNeededForAWarningOfIntrinsics) {
  options_.masks.clear();
  add_file("in/K.txt", "14 0 8\n0 14 6\n0 0 1\n");  // of 16x12
  EXPECT_TRUE(import_warns_of("images of about 16 x 12 pixels, before scaling"));
  const auto check = check_file(folder_ / "out.h5", true);
  ASSERT_EQ(check.warnings.size(), 1u);
  EXPECT_TRUE(has(check.warnings[0], "principal point (8.0, 6.0) is far from the centre"));
}

TEST(IntrinsicsCheck, AcceptsCroppedImagesAndRejectsOtherUnits) {
  EXPECT_EQ(implausible_intrinsics(Camera{640, 480, 600.0, 600.0, 320.0, 240.0}), "");
  EXPECT_EQ(implausible_intrinsics(Camera{640, 240, 600.0, 600.0, 320.0, 30.0}), "");
  EXPECT_EQ(implausible_intrinsics(Camera{1280, 720, 608.0, 607.0, 641.0, 366.0}), "");
  EXPECT_TRUE(has(implausible_intrinsics(Camera{640, 480, 3.6, 3.6, 320.0, 240.0}), "unit"));
  EXPECT_TRUE(has(implausible_intrinsics(Camera{640, 480, 290.0, 290.0, 160.0, 120.0}),
                  "about 320 x 240 pixels"));
}

TEST_F(ImportMasks, CommandsReadAMatrixAsCalibration) {
  options_.masks.clear();
  import("in", options_);
  add_file("matrix.txt", "7 0 4\n0 7 3\n0 0 1\n");
  const std::string file = folder_ / "out.h5", matrix = folder_ / "matrix.txt",
                    labels = folder_ / "labels.h5";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"check", file, "--calibration", matrix},
        {"label", file, "--calibration", matrix, "--output", labels}}) {
    ::testing::internal::CaptureStderr(), ::testing::internal::CaptureStdout();
    testing::run_touchtrace(arguments);
    const std::string text =
        ::testing::internal::GetCapturedStderr() + ::testing::internal::GetCapturedStdout();
    EXPECT_TRUE(has(text, "neither boxes nor masks")) << text;
    EXPECT_FALSE(has(text, "matrix.txt")) << text;
    EXPECT_FALSE(has(text, "intrinsics")) << text;
  }
}

}  // namespace
}  // namespace touchtrace
