#pragma once

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/base/files.h"
#include "engine/base/progress.h"
#include "engine/base/random.h"
#include "pipeline/acquire/import/import.h"
#include "pipeline/recording/recording_file.h"
#include "tests/pipeline/recording_samples.h"
#include "tests/support/expect_error.h"

namespace touchtrace {

namespace fs = std::filesystem;
using testing::TemporaryFolder;

inline constexpr int import_width = 8, import_height = 6, import_frames = 4;
inline constexpr double import_start_s = 1700000000.25;

/// Colour image whose pixel (1, 0) tells its number.
inline cv::Mat import_color(int i) {
  cv::Mat image(import_height, import_width, CV_8UC3, cv::Scalar(10, 20, 30));
  image.at<cv::Vec3b>(0, 1) = {1, 2, static_cast<std::uint8_t>(100 + i)};  // blue, green, red
  return image;
}

inline cv::Mat import_depth(int i, int per_m) {
  cv::Mat image(import_height, import_width, CV_16UC1, cv::Scalar(per_m));
  image.at<std::uint16_t>(2, 3) = static_cast<std::uint16_t>(per_m + 5 * i);
  return image;
}

inline std::string encoded(const cv::Mat& image, const char* extension = ".png") {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, image, bytes);
  return {bytes.begin(), bytes.end()};
}

inline std::string pixels(const cv::Mat& image) {
  return {reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()};
}

inline const char* const import_info =
    "height: 6\nwidth: 8\ndistortion_model: plumb_bob\nD: []\n"
    "K: [7.0, 0.0, 4.0, 0.0, 7.0, 3.0, 0.0, 0.0, 1.0]\n---\n";

/// TUM folder: 30 Hz, depth 4 ms after colour. `per_second`: stamps.
inline void write_import_tum(const fs::path& folder, int per_m = 5000, double per_second = 1.0,
                             double start_s = import_start_s) {
  std::string rgb = "# timestamp filename\n", depth = rgb;
  for (int i = 0; i < import_frames; ++i) {
    const std::string name = std::to_string(i) + ".png";
    write_file(folder / "rgb" / name, encoded(import_color(i)), true);
    write_file(folder / "depth" / name, encoded(import_depth(i, per_m)), true);
    const double time_s = start_s + i / 30.0;
    rgb += fmt::format("{:.6f} rgb/{}\n", per_second * time_s, name);
    depth += fmt::format("{:.6f} depth/{}\n", per_second * (time_s + 0.004), name);
  }
  write_file(folder / "rgb.txt", rgb, true), write_file(folder / "depth.txt", depth, true);
  write_file(folder / "camera_info.yaml", import_info, true);
}

inline ImportOptions at_rate(double rate_hz) {
  ImportOptions options;
  options.source.rate_hz = rate_hz;
  return options;
}

/// Stores what is written to stderr during its life in `text`.
class CapturedStderr {
 public:
  explicit CapturedStderr(std::string& text) : text_(text) { ::testing::internal::CaptureStderr(); }
  ~CapturedStderr() { text_ = ::testing::internal::GetCapturedStderr(); }
  CapturedStderr(const CapturedStderr&) = delete;
  CapturedStderr& operator=(const CapturedStderr&) = delete;

 private:
  std::string& text_;
};

/// Imports of small samples into a temporary folder.
class Import : public ::testing::Test {
 protected:
  void SetUp() override { Progress::silence(); }
  void add_file(const std::string& name, const std::string& bytes) {
    write_file(folder_ / name, bytes, true);
  }
  /// Adds the images 0.png, 1.png, ... to two folders.
  void add_images(int per_m = 1000, const std::string& rgb = "in/rgb",
                  const std::string& depth = "in/depth") {
    for (int i = 0; i < import_frames; ++i) {
      add_file(fmt::format("{}/{}.png", rgb, i), encoded(import_color(i)));
      add_file(fmt::format("{}/{}.png", depth, i), encoded(import_depth(i, per_m)));
    }
  }
  /// Imports from scratch; without a source, a glove alone.
  RecordingReader import(const std::string& source, const ImportOptions& options = {}) {
    fs::remove(folder_ / "out.h5");
    const CapturedStderr captured(warnings_);
    summary_ =
        import_recording(source.empty() ? fs::path() : folder_ / source, folder_ / "out.h5",
                         options, start_provenance("touchtrace/recording/2", "import"), false);
    return RecordingReader(folder_ / "out.h5");
  }
  bool warns_of(const std::string& text) const { return warnings_.find(text) != std::string::npos; }
  /// Returns the message.
  std::string expect_rejected(const std::string& source, const std::string& text,
                              const ImportOptions& options = {},
                              std::optional<ExitCode> code = {}) {
    const auto message = testing::expect_error([&] { import(source, options); }, text, code);
    EXPECT_FALSE(fs::exists(folder_ / "out.h5"));
    return message;
  }
  /// Imports the first part of the path `file` while bytes of that file, behind the first `kept`,
  /// change at random.
  void expect_damage_survived(const std::string& file, const std::string& bytes, int times,
                              const ImportOptions& options = {}, std::size_t kept = 0) {
    RandomStream random(1, file);
    for (int i = 0; i < times; ++i) {
      std::string damaged = bytes;
      for (int j = 0; j < 1 + i % 5; ++j)
        damaged[kept + random.below(bytes.size() - kept)] = static_cast<char>(random.below(256));
      if (i % 3 == 0) damaged.resize(random.below(bytes.size()));
      add_file(file, damaged);
      testing::expect_read_or_refused([&] { import(*fs::path(file).begin(), options); });
    }
  }
  /// Expects all frames of the samples above, at 30 Hz.
  void expect_samples(const RecordingReader& reader, int counts_at_1m) {
    const Recording& r = reader.recording();
    ASSERT_EQ(r.camera_times.frames(), std::size_t(import_frames));
    EXPECT_NEAR(r.camera_times.host_time_s[3] - r.camera_times.host_time_s[0], 0.1, 1e-5);
    EXPECT_NEAR(r.camera.depth_unit_m * counts_at_1m, 1.0, 1e-9);
    for (int i = 0; i < import_frames; ++i) {
      const RgbdFrame frame = reader.read_camera_frame(i);
      EXPECT_EQ(frame.color[3], 100 + i) << "red comes first";
      EXPECT_EQ(frame.color[5], 1);
      EXPECT_EQ(frame.depth[0], counts_at_1m);
      EXPECT_EQ(frame.depth[2 * import_width + 3], counts_at_1m + 5 * i);
    }
    ASSERT_EQ(r.clips.size(), 1u);
    EXPECT_LE(r.clips[0].start_s, r.camera_times.host_time_s[0]);
    EXPECT_GT(r.clips[0].end_s, r.camera_times.host_time_s[3]);
  }

  /// Expects them with what a bag has besides images.
  void expect_bag_samples(const RecordingReader& reader) {
    expect_samples(reader, 1000);
    const Recording& r = reader.recording();
    EXPECT_TRUE(r.camera.is_registered);
    ASSERT_TRUE(r.camera.color_camera);
    EXPECT_EQ(r.camera.color_camera->fx, 7.0);
    EXPECT_EQ(r.camera.color_camera->cy, 3.0);
    EXPECT_NEAR(r.epoch_unix_s, import_start_s, 1e-6);
    EXPECT_NEAR(r.camera_times.device_time_s[1] - r.camera_times.host_time_s[1], -0.25, 1e-6);
  }

  TemporaryFolder folder_;
  nlohmann::json summary_;
  std::string warnings_;  ///< of the last import
};

}  // namespace touchtrace
