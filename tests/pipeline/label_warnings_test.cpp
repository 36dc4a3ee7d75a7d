#include <gtest/gtest.h>

#include "pipeline/recording/check.h"
#include "tests/pipeline/recording_samples.h"

namespace touchtrace {
namespace {

TEST(LabelWarnings, NameMillimetresAndCausalStatesThatAreNot) {
  Labels labels = testing::sample_labels(testing::sample_recording().recording);
  EXPECT_TRUE(label_warnings(labels).empty());
  labels.hand.causal_position_m = labels.hand.position_m;
  labels.hand.causal_velocity_m_per_s = labels.hand.velocity_m_per_s;
  for (double& p : labels.object.position_m) p *= 1000.0;
  const auto warnings = label_warnings(labels);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("causal states of the hand"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("millimetres"), std::string::npos) << warnings[1];
  labels.hand.velocity_m_per_s.assign(labels.hand.velocity_m_per_s.size(), 0.0);
  labels.hand.causal_velocity_m_per_s = labels.hand.velocity_m_per_s;
  EXPECT_EQ(label_warnings(labels).size(), 1u) << "a body at rest";
}

}  // namespace
}  // namespace touchtrace
