#include "pipeline/acquire/import/registration_check.h"
#include "tests/pipeline/import_samples.h"

namespace touchtrace {
namespace {

constexpr int width = 640, height = 360, num_frames = 40;

/// A disc and a bar that move before a textured wall. Colour and depth of the same scene; depth is
/// displaced by `shift_x` pixels and shows what colour showed `late_images` images before.
struct Scene {
  int shift_x = 0, late_images = 0;
  bool is_still = false, is_background_removed = false;
  int num_images = num_frames;

  static cv::Mat wall() {
    cv::Mat image(height, width, CV_8UC3);
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u)
        image.at<cv::Vec3b>(v, u) =
            cv::Vec3b::all(static_cast<std::uint8_t>(100 + 40 * ((u / 23 + v / 17) % 3)));
    return image;
  }
  cv::Point disc(int frame) const {
    const double angle = is_still ? 0.0 : 0.3 * frame;
    return {320 + static_cast<int>(120 * std::cos(angle)),
            180 + static_cast<int>(70 * std::sin(angle))};
  }
  template <class Value>
  void draw(cv::Mat& image, int frame, int dx, const Value& disc_value, const Value& bar) const {
    const cv::Point centre = disc(frame) + cv::Point(dx, 0);
    cv::circle(image, centre, 30, disc_value, cv::FILLED);
    cv::rectangle(image, centre + cv::Point(-12, 25), centre + cv::Point(12, 140), bar, cv::FILLED);
  }
  SourceStream stream(bool is_depth) const {
    SourceStream result;
    for (int i = 0; i < num_images; ++i) result.images.push_back({"", i / 15.0, i / 15.0});
    result.read = [*this, is_depth](std::size_t index) {
      const int i = static_cast<int>(index);
      cv::Mat image =
          is_depth ? cv::Mat(height, width, CV_16UC1, cv::Scalar(is_background_removed ? 0 : 1200))
                   : wall();
      if (is_depth)
        draw(image, i - late_images, shift_x, cv::Scalar(700), cv::Scalar(800));
      else
        draw(image, i, 0, cv::Scalar(40, 160, 40), cv::Scalar(110, 140, 200));
      return image;
    };
    return result;
  }
  std::optional<MotionShift> measured() const {
    return measure_motion_shift(stream(false), stream(true));
  }
};

TEST(MotionShift, FindsDepthThatIsNotRegistered) {
  for (const int shift : {20, -31}) {
    const auto found = Scene{.shift_x = shift}.measured();
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->depth_from_color_px.x, shift, 2.0);
    EXPECT_NEAR(found->depth_from_color_px.y, 0.0, 2.0);
    EXPECT_FALSE(found->is_consistent_with_registration(width));
  }
}

TEST(MotionShift, AcceptsRegisteredDepthAlsoWithoutBackground) {
  for (const bool is_removed : {false, true}) {
    const auto found = Scene{.is_background_removed = is_removed}.measured();
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->is_consistent_with_registration(width));
    EXPECT_LE(cv::norm(found->depth_from_color_px), 2.0);
    EXPECT_GT(found->correlation, 0.6);
  }
}

TEST(MotionShift, SaysNothingOfStillScenesAndFewImages) {
  EXPECT_FALSE((Scene{.shift_x = 20, .is_still = true}.measured()));
  EXPECT_FALSE((Scene{.shift_x = 20, .num_images = 7}.measured()));
}

TEST(DepthDelay, IsFoundInWholeImages) {
  for (const int late_images : {-3, 0, 1, 4}) {
    const Scene scene{.late_images = late_images};
    const auto delay = measure_depth_delay(scene.stream(false), scene.stream(true));
    ASSERT_TRUE(delay);
    EXPECT_NEAR(delay->images, late_images, 0.25);
    EXPECT_NEAR(delay->seconds, delay->images / 15.0, 1e-9);
  }
}

/// Stamps of depth images lie between those of the colour images.
TEST(DepthDelay, IsOfTheStamps) {
  const Scene scene;
  SourceStream depth = scene.stream(true);
  for (auto& image : depth.images) image.host_time_s += 0.4 / 15.0;
  const auto delay = measure_depth_delay(scene.stream(false), depth);
  ASSERT_TRUE(delay);
  EXPECT_NEAR(delay->images, 0.4, 0.25);
}

TEST(DepthDelay, IsUnknownInStillScenesAndFewImages) {
  for (const Scene& scene : {Scene{.is_still = true}, Scene{.num_images = 20}})
    EXPECT_FALSE(measure_depth_delay(scene.stream(false), scene.stream(true)));
}

void write_images(const fs::path& folder, const Scene& scene) {
  const SourceStream color = scene.stream(false), depth = scene.stream(true);
  for (std::size_t i = 0; i < color.images.size(); ++i) {
    const std::string name = fmt::format("{:03}.png", i);
    write_file(folder / "rgb" / name, encoded(color.read(i)), true);
    write_file(folder / "depth" / name, encoded(depth.read(i)), true);
  }
}

TEST_F(Import, NamesTheDepthOffsetThatCorrectsADelay) {
  write_images(folder_ / "in", {.late_images = 1});
  ImportOptions options = at_rate(15.0);
  import("in", options);
  EXPECT_TRUE(
      warns_of("later than colour images of the same time; `touchtrace import --depth-offset -0.0"))
      << warnings_;
  options.camera.depth_offset_s = -1.0 / 15.0;
  import("in", options);
  EXPECT_FALSE(warns_of("--depth-offset")) << warnings_;
}

/// A folder that does not say whether its depth is registered.
TEST_F(Import, TakesDisplacedDepthAsNotRegistered) {
  ImportOptions options = at_rate(15.0);
  for (const int shift : {0, 20}) {
    write_images(folder_ / "in", {.shift_x = shift});
    EXPECT_EQ(import("in", options).recording().camera.is_registered, shift == 0);
  }
  options.camera.registered = true;
  EXPECT_TRUE(import("in", options).recording().camera.is_registered);
  EXPECT_TRUE(warns_of("as if depth were not registered"));
}

/// Folder with colour images of 8 x 6 pixels, depth images of another size, and intrinsics.
void write_resized(const fs::path& folder, cv::Size depth_size, bool has_intrinsics) {
  const cv::Mat depth(depth_size, CV_16UC1, cv::Scalar(1000));
  for (int i = 0; i < import_frames; ++i) {
    const std::string name = fmt::format("{}.png", i);
    write_file(folder / "rgb" / name, encoded(import_color(i)), true);
    write_file(folder / "depth" / name, encoded(depth), true);
  }
  if (has_intrinsics) write_file(folder / "camera_info.yaml", import_info, true);
}

TEST_F(Import, RegisteredDepthOfAnotherSizeHasACameraOfItsOwn) {
  ImportOptions options = at_rate(30.0);
  options.camera.registered = true;
  write_resized(folder_ / "a", {4, 3}, true);
  const CameraInfo camera = import("a", options).recording().camera;
  ASSERT_TRUE(camera.depth_camera && camera.depth_from_color);
  EXPECT_FALSE(camera.is_registered);
  EXPECT_EQ(camera.color_camera->fx, 7.0);
  EXPECT_EQ(camera.depth_camera->width, 4);
  EXPECT_EQ(camera.depth_camera->height, 3);
  EXPECT_EQ(camera.depth_camera->fx, 3.5);
  EXPECT_EQ(camera.depth_camera->cx, 0.5 * 4.5 - 0.5);
  EXPECT_EQ(camera.depth_camera->cy, 0.5 * 3.5 - 0.5);
  EXPECT_TRUE(camera.depth_from_color->isApprox(Eigen::Isometry3d::Identity()));
}

TEST_F(Import, RegisteredDepthOfAnotherSizeNeedsTheAspectRatioAndIntrinsics) {
  ImportOptions options = at_rate(30.0);
  options.camera.registered = true;
  write_resized(folder_ / "aspect", {8, 3}, true);
  expect_rejected("aspect", "depth of 8x3 pixels, colour of 8x6", options);
  write_resized(folder_ / "unknown", {4, 3}, false);
  expect_rejected("unknown", "need the intrinsics of the colour camera", options);
}

}  // namespace
}  // namespace touchtrace
