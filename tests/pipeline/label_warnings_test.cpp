#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/recording/label_check.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

/// Labels of bodies that move smoothly.
Labels plausible_labels() {
  Labels labels = testing::sample_labels(testing::sample_recording().recording);
  for (auto* body : {&labels.hand, &labels.object}) {
    const Truth::Body motion = testing::sample_body(labels.time_s, 0.5);
    body->position_m = motion.position_m, body->velocity_m_per_s = motion.velocity_m_per_s;
    body->quality.assign(labels.time_s.size(), quality_good);
    body->covariance.assign(36 * labels.time_s.size(), 0.0);
  }
  return labels;
}

/// `count`: of all warnings.
void expect_warning(const Labels& labels, const std::string& text, std::size_t count = 1) {
  const auto warnings = label_warnings(labels);
  EXPECT_EQ(warnings.size(), count) << text;
  EXPECT_TRUE(std::ranges::any_of(warnings, [&](const std::string& warning) {
    return warning.find(text) != std::string::npos;
  })) << text;
}

TEST(LabelWarnings, NameMillimetres) {
  Labels labels = plausible_labels();
  EXPECT_TRUE(label_warnings(labels).empty());
  for (auto* values : {&labels.object.position_m, &labels.object.velocity_m_per_s})
    for (double& value : *values) value *= 1000.0;
  expect_warning(labels, "positions in millimetres", 2);
}

TEST(LabelWarnings, NameCausalStatesThatAreNot) {
  Labels labels = plausible_labels();
  labels.hand.causal_position_m = labels.hand.position_m;
  labels.hand.causal_velocity_m_per_s = labels.hand.velocity_m_per_s;
  expect_warning(labels, "the hand has causal states that equal the smoothed ones");
  for (auto* values : {&labels.hand.position_m, &labels.hand.velocity_m_per_s})
    values->assign(values->size(), 0.0);
  labels.hand.causal_position_m = labels.hand.position_m;
  labels.hand.causal_velocity_m_per_s = labels.hand.velocity_m_per_s;
  EXPECT_TRUE(label_warnings(labels).empty()) << "a body at rest";
}

TEST(LabelWarnings, NameVelocitiesThatAreNotThoseOfThePositions) {
  for (const double factor : {1000.0, -1.0, 0.0}) {
    Labels labels = plausible_labels();
    for (double& v : labels.hand.velocity_m_per_s) v *= factor;
    expect_warning(labels, "the hand has velocities that are");
  }
}

TEST(LabelWarnings, NameJumps) {
  Labels labels = plausible_labels();
  labels.object.position_m[3 * 7] += 30.0;
  expect_warning(labels, "the object jumps in 2 places, first by 30 m after label 6", 2);
  labels.object.quality[7] = quality_lost;
  EXPECT_TRUE(label_warnings(labels).empty());
}

TEST(LabelWarnings, NameCovariancesThatAreNone) {
  Labels labels = plausible_labels();
  labels.hand.covariance[36 * 4] = -1e-6;
  expect_warning(labels, "the hand has 1 good labels, the first 4, whose covariance");
  labels = plausible_labels();
  labels.hand.covariance[36 * 5 + 1] += 1.0;
  expect_warning(labels, "the hand has 1 good labels, the first 5, whose covariance");
}

TEST(LabelWarnings, NameUnknownQuality) {
  Labels labels = plausible_labels();
  labels.hand.quality[3] = 64;
  expect_warning(labels, "the hand has 1 labels whose quality has other bits");
}

TEST(LabelWarnings, NameTimesOutsideTheClips) {
  Labels labels = plausible_labels();
  for (double& time_s : labels.time_s) time_s += 1000.0;
  expect_warning(labels, "40 of 40 labels are outside their clips");
}

}  // namespace
}  // namespace touchtrace
