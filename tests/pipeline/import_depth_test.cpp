#include "pipeline/acquire/import/depth_values.h"
#include "tests/pipeline/import_samples.h"

namespace touchtrace {
namespace {

/// Imports whose 48 pixels have `most` in all but the first `num_others` pixels, which have
/// `others`. Floating-point numbers near `most` increase by 0.1 % per pixel.
class ImportDepth : public Import {
 protected:
  void write_images(double most, double others, int num_others, int type = CV_16UC1) {
    cv::Mat depth(import_height, import_width, type, cv::Scalar(most));
    for (int i = 0; type == CV_32FC1 && i < static_cast<int>(depth.total()); ++i)
      depth.ptr<float>()[i] *= 1.0f + 0.001f * static_cast<float>(i);
    depth.reshape(1, 1).colRange(0, num_others).setTo(others);
    for (int i = 0; i < import_frames; ++i) {
      add_file(fmt::format("in/rgb/{}.png", i), encoded(import_color(i)));
      add_file(fmt::format("in/depth/{}.tiff", i), encoded(depth, ".tiff"));
    }
  }
  static ImportOptions with_scale(double counts_per_m) {
    ImportOptions options = at_rate(30.0);
    options.camera.depth_scale = counts_per_m;
    return options;
  }
  /// First and last pixel of the first image.
  std::pair<int, int> import_pixels(double counts_per_m = 0.0) {
    const RgbdFrame frame = import("in", with_scale(counts_per_m)).read_camera_frame(0);
    return {frame.depth.front(), frame.depth.back()};
  }
};

TEST_F(ImportDepth, FloatingPointMillimetresWithAFewSmallValues) {
  write_images(2800.0, 9.0, 2, CV_32FC1);
  expect_rejected("in", "in metres the median depth would be 2867 m", with_scale(0.0));
  expect_rejected("in", "1000 (median 2.87 m)", with_scale(0.0));
  EXPECT_EQ(import_pixels(1000.0), std::pair(36, 11726));  // counts of 0.25 mm
}

TEST_F(ImportDepth, ACodeForMissingDepthIsLeftOut) {
  write_images(32001, 1800, 10);
  EXPECT_EQ(import_pixels(), std::pair(1800, 0));
  EXPECT_TRUE(warns_of("79 % of the depth pixels with a value have the value 32001")) << warnings_;
  EXPECT_FALSE(warns_of("median")) << warnings_;
}

TEST_F(ImportDepth, ACodeThatMayBeDepthIsNamed) {
  write_images(8191, 700, 10);
  EXPECT_EQ(import_pixels(), std::pair(700, 8191));
  EXPECT_TRUE(warns_of("79 % of the pixels have the value 8191")) << warnings_;
}

TEST_F(ImportDepth, AWallInASimulatedImageIsKept) {
  write_images(2400, 700, 10);
  EXPECT_EQ(import_pixels(), std::pair(700, 2400));
  EXPECT_FALSE(warns_of("value")) << warnings_;
  write_images(32001, 9000, 10);  // 3.2 m
  EXPECT_EQ(import_pixels(10000.0), std::pair(9000, 32001));
  EXPECT_FALSE(warns_of("value")) << warnings_;
}

TEST_F(ImportDepth, ImagesWithoutDepthAreRefused) {
  write_images(0, 65535, 10);
  expect_rejected("in", "no pixel with depth", with_scale(0.0));
}

TEST(DepthCode, IsFarFromAllOtherValues) {
  std::vector<double> values(100, 1000.0);
  EXPECT_FALSE(find_depth_code(values)) << "there are no others";
  std::fill_n(values.begin(), 20, 4000.0);
  ASSERT_TRUE(find_depth_code(values));
  EXPECT_EQ(find_depth_code(values)->value, 4000.0);
  EXPECT_NEAR(find_depth_code(values)->share, 0.2, 1e-12);
  std::fill_n(values.begin() + 20, 5, 2500.0);
  EXPECT_FALSE(find_depth_code(values));
  EXPECT_FALSE(find_depth_code({}));
}

}  // namespace
}  // namespace touchtrace
