#include "pipeline/study/label_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/random.h"
#include "pipeline/study/truth_samples.h"
#include "tests/pipeline/label_stage.h"
#include "tests/verify/labels/label_trials.h"

namespace touchtrace::staged {
namespace {

TEST(LabelError, OfExactPositionsComesFromTheFrameRateAlone) {
  const Stage stage(false);
  const auto error = study::error_of_exact_positions(recording_of(stage), truth_of(stage));
  EXPECT_EQ(error.object.wrong_share, 0.0);
  EXPECT_LE(error.object.lost_share, 1.0 / 88.0);  // the last label, after the last image
  EXPECT_LT(error.object.position_spread_m.maxCoeff(), 0.001);
  EXPECT_LT(error.object.aligned_velocity_rms_m_per_s, 0.05);
}

constexpr double latency_s = 2.0 / camera_rate_hz;  // taken for the camera's, which has none

/// Labels whose raw positions have white noise and an error with a period of 4 s, and whose time
/// stamps are late.
Labels raw_labels(const Stage& stage, double white_m, double swing_m, double late_s) {
  auto labels =
      label_recording(recording_of(stage), frame_source(stage), calibration(), component_options());
  const auto truth = truth_of(stage);
  RandomStream random(1, "raw places");
  auto& raw = labels.raw;
  for (std::size_t i = 0; i < raw.time_s.size(); ++i)
    if (const auto place = study::find_interval(truth, raw.clip[i], raw.time_s[i] + latency_s)) {
      Eigen::Map<Eigen::Vector3d> seen(&raw.object_m[3 * i]);
      seen = study::interpolate(truth.object.position_m, *place);
      for (double& value : seen)
        value += white_m * random.normal() + swing_m * std::sin(0.5 * M_PI * raw.time_s[i]);
    }
  for (auto* stamps_s : {&labels.time_s, &raw.time_s})
    for (double& time_s : *stamps_s) time_s += late_s;
  return labels;
}

TEST(LabelError, SeparatesWhiteFromCorrelatedErrors) {
  const Stage stage(false);
  const auto velocity_error = [&](double white_m, double swing_m, double late_s) {
    return study::error_of_white_positions(recording_of(stage), truth_of(stage),
                                           raw_labels(stage, white_m, swing_m, late_s))
        .object.aligned_velocity_rms_m_per_s;
  };
  const double exact = study::error_of_exact_positions(recording_of(stage), truth_of(stage))
                           .object.aligned_velocity_rms_m_per_s,
               white = velocity_error(0.002, 0.0, 0.0);
  EXPECT_NEAR(velocity_error(0.0, 0.0, 0.0), exact, 0.1 * exact);
  EXPECT_GT(white, 1.2 * exact);
  EXPECT_NEAR(velocity_error(0.002, 0.01, 0.0), white, 0.05 * white);
  // a whole frame, so that labels stay at the same places between frames
  EXPECT_LT(velocity_error(0.0, 0.0, 1.0 / camera_rate_hz), 1.1 * exact);
}

TEST(LabelError, IsMeasuredAfterRemovingTheDelay) {
  const Stage stage(false);
  auto recording = recording_of(stage);
  for (auto& time_s : recording.camera_times.host_time_s) time_s += 0.018;
  const auto labels =
      label_recording(recording, frame_source(stage), calibration(), component_options());
  const auto error = study::compare_labels_with_truth(labels, truth_of(stage)).object;
  EXPECT_NEAR(error.delay_s, 0.018 - latency_s, 0.001);
  EXPECT_LT(error.aligned_velocity_rms_m_per_s, 0.5 * error.velocity_rms_m_per_s);
}

TEST(LabelError, IsNaNWhereNothingCanBeMeasured) {
  const Stage stage(false);
  const auto labels =
      label_recording(recording_of(stage), frame_source(stage), calibration(), component_options());
  auto truth = truth_of(stage);
  auto& velocity = truth.object.velocity_m_per_s;
  for (std::size_t i = 0; i < velocity.size(); ++i) velocity[i] = i / 3 % 2 ? 10.0 : -10.0;
  const auto error = study::compare_labels_with_truth(labels, truth).object;
  EXPECT_EQ(error.impact_share, 1.0);
  EXPECT_TRUE(std::isfinite(error.position_spread_m.norm()));
  for (const double unknown : {error.velocity_rms_m_per_s, error.causal_velocity_rms_m_per_s,
                               error.aligned_velocity_rms_m_per_s, error.position_coverage,
                               error.velocity_coverage, error.nees})
    EXPECT_TRUE(std::isnan(unknown));
}

}  // namespace
}  // namespace touchtrace::staged
