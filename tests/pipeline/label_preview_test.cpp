#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "engine/base/error.h"
#include "pipeline/label/preview/contact_sheet.h"
#include "pipeline/label/preview/preview.h"
#include "tests/pipeline/label_stage.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace::staged {
namespace {

using testing::TemporaryFolder;

constexpr int num_frames = 40;

/// The first two seconds of the staged scene, labelled.
class LabelPreview : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    recording_ = recording_of(stage_);
    recording_.clips[0].end_s = 1.5;
    for (auto* times :
         {&recording_.camera_times.device_time_s, &recording_.camera_times.host_time_s})
      times->resize(num_frames);
    recording_.camera_times.sequence.resize(num_frames);
    labels_ = label_recording(recording_, frame_source(stage_), calibration(), component_options());
  }
  void write(const std::string& name, bool overwrite = false) const {
    label::write_preview(folder_ / name, recording_, frame_source(stage_), calibration(), labels_,
                         overwrite);
  }

  inline static const Stage stage_{false};
  inline static Recording recording_;
  inline static Labels labels_;
  TemporaryFolder folder_;
};

TEST_F(LabelPreview, VideoHasEveryFrameAtTheCamerasRate) {
  for (const char* name : {"preview.mp4", "preview.avi"}) {
    SCOPED_TRACE(name);
    write(name);
    cv::VideoCapture video((folder_ / name).string());
    ASSERT_TRUE(video.isOpened());
    EXPECT_EQ(std::lround(video.get(cv::CAP_PROP_FRAME_COUNT)), num_frames);
    EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), camera_rate_hz, 0.1);
    cv::Mat frame;
    ASSERT_TRUE(video.read(frame));
    EXPECT_EQ(frame.cols, 640);
    EXPECT_GT(frame.rows, 480);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 2)
      << "temporary files";
}

TEST_F(LabelPreview, MarksTheObjectInFramesOfTheClipOnly) {
  const label::LabelOverlay overlay(recording_, calibration(), labels_);
  const auto changed_at = [&](int index, const Eigen::Vector3d& point_m) {
    const auto images = stage_.render(index / camera_rate_hz, true);
    const Eigen::Vector2d at = camera().project(point_m);
    const cv::Vec3b drawn = overlay.draw(static_cast<std::size_t>(index), images, width)
                                .at<cv::Vec3b>(static_cast<int>(std::lround(at.y())),
                                               static_cast<int>(std::lround(at.x())));
    return drawn != cv::Vec3b(20, 40, 200);  // the ball's colour
  };
  EXPECT_TRUE(changed_at(20, stage_.ball(20 / camera_rate_hz)));
  EXPECT_FALSE(changed_at(38, stage_.ball(38 / camera_rate_hz)));
}

TEST_F(LabelPreview, ShowsBoxesWhereTheyWereDrawn) {
  auto other = recording_;
  other.clips[0].hand_box = {5, 5, 20, 20};
  const auto difference = [&](std::size_t index) {
    const auto images = stage_.render(static_cast<double>(index) / camera_rate_hz, true);
    const auto draw = [&](const Recording& recording) {
      return label::LabelOverlay(recording, calibration(), labels_).draw(index, images, width);
    };
    return cv::norm(draw(other), draw(recording_));
  };
  EXPECT_GT(difference(0), 0.0);
  EXPECT_EQ(difference(1), 0.0);
}

TEST_F(LabelPreview, ContactSheetShowsFlaggedFramesToo) {
  EXPECT_LE(labels_.contact_sheet_jpeg.size(), 400'000u);
  const cv::Mat sheet = cv::imdecode(labels_.contact_sheet_jpeg, cv::IMREAD_COLOR);
  EXPECT_EQ(sheet.cols, 1600);
  auto flagged = labels_;
  flagged.object.quality.assign(flagged.object.quality.size(), quality_good);
  flagged.hand.quality = flagged.object.quality;
  const auto height = [&](const Labels& labels) {
    const label::LabelOverlay overlay(recording_, calibration(), labels);
    return cv::imdecode(label::contact_sheet_jpeg(overlay, frame_source(stage_), 1),
                        cv::IMREAD_COLOR)
        .rows;
  };
  const int good_height = height(flagged);
  flagged.object.quality[8] = quality_lost;
  EXPECT_EQ(height(flagged), good_height / 3 * 4);
}

TEST_F(LabelPreview, DrawsLabelsWithoutStates) {
  auto lost = labels_;
  for (auto* values : {&lost.object.position_m, &lost.object.velocity_m_per_s,
                       &lost.object.covariance, &lost.raw.object_m})
    values->assign(values->size(), std::nan(""));
  lost.hand.covariance.assign(lost.hand.covariance.size(), 1e300);
  const label::LabelOverlay overlay(recording_, calibration(), lost);
  EXPECT_FALSE(overlay.draw(20, stage_.render(1.0, true), width).empty());
}

TEST_F(LabelPreview, RejectsOtherEndingsAndExistingFiles) {
  EXPECT_THROW(write("preview.mov"), Error);
  testing::put(folder_ / "old.mp4", "old");
  EXPECT_THROW(write("old.mp4"), Error);
  write("old.mp4", true);
  EXPECT_GT(std::filesystem::file_size(folder_ / "old.mp4"), 1000u);
}

TEST_F(LabelPreview, LeavesNoFileIfAnImageCannotBeRead) {
  auto frames = frame_source(stage_);
  const auto read = frames.camera_frame;
  frames.camera_frame = [&](std::size_t i) {
    if (i == 5) throw data_error("image 5 is damaged", "copy it again");
    return read(i);
  };
  EXPECT_THROW(label::write_preview(folder_ / "preview.mp4", recording_, frames, calibration(),
                                    labels_, false),
               Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace touchtrace::staged
