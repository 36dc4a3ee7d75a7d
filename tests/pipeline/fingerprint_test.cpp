#include "pipeline/dataset/fingerprint.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/base/random.h"

namespace touchtrace {
namespace {

Clip clip_of(double start_s, double end_s, const std::string& object) {
  Clip clip;
  clip.start_s = start_s, clip.end_s = end_s, clip.object = object;
  return clip;
}

TEST(Fingerprints, OfAShiftedOrTrimmedCopyAreKnown) {
  RandomStream random(1, "touch");
  const auto glove_at = [&](double start_s) {
    GloveStream glove;
    glove.info.rows = 2, glove.info.cols = 3;
    for (int i = 0; i < 100; ++i) {
      glove.host_time_s.push_back(start_s + 0.1 * i);
      for (int taxel = 0; taxel < 6; ++taxel)
        glove.counts.push_back(static_cast<std::uint16_t>(random.below(1000)));
    }
    return glove;
  };
  const GloveStream glove = glove_at(0.0);
  auto known = touch_fingerprints(glove, clip_of(0.0, 9.95, "ball"));
  EXPECT_GT(known.size(), 2u);
  std::ranges::sort(known);
  GloveStream shifted = glove, changed = glove;
  for (double& time_s : shifted.host_time_s) time_s += 5.0;
  changed.counts[300] ^= 1;
  EXPECT_TRUE(is_known_clip(touch_fingerprints(shifted, clip_of(5.0, 14.95, "box")), known));
  EXPECT_TRUE(is_known_clip(touch_fingerprints(changed, clip_of(0.0, 9.95, "ball")), known));
  EXPECT_TRUE(is_known_clip(touch_fingerprints(glove, clip_of(2.0, 9.95, "ball")), known));
  EXPECT_FALSE(is_known_clip(touch_fingerprints(glove_at(0.0), clip_of(0.0, 9.95, "ball")), known));
  // nothing but rest, in which two taxels flicker: only an exact copy is known
  GloveStream rest = glove;
  for (std::size_t i = 0; i < rest.counts.size(); ++i)
    rest.counts[i] = i % 6 < 2 ? static_cast<std::uint16_t>(random.below(2)) : 7;
  known = touch_fingerprints(rest, clip_of(0.0, 9.95, "ball"));
  EXPECT_EQ(known.size(), 1u);
  EXPECT_FALSE(is_known_clip(touch_fingerprints(rest, clip_of(2.0, 9.95, "ball")), known));
}

TEST(Fingerprints, OfAShortExcerptOfALongClipAreKnown) {
  RandomStream random(2, "touch");
  GloveStream glove;
  glove.info.rows = 2, glove.info.cols = 3;
  for (int i = 0; i < 3000; ++i) {
    glove.host_time_s.push_back(0.1 * i);
    for (int taxel = 0; taxel < 6; ++taxel)
      glove.counts.push_back(static_cast<std::uint16_t>(random.below(1000)));
  }
  auto known = touch_fingerprints(glove, clip_of(0.0, 299.95, "ball"));
  std::ranges::sort(known);
  int found = 0;
  for (int i = 0; i < 50; ++i)
    found +=
        is_known_clip(touch_fingerprints(glove, clip_of(5.0 * i, 5.0 * i + 5.95, "ball")), known);
  EXPECT_GE(found, 47) << "99 % are expected: of fifty, fewer in 2 of 1000 cases";
}

TEST(Fingerprints, OfMotionAreKnownInAnotherFrameOfReference) {
  RandomStream random(3, "motion");
  const auto walk = [&] {
    LabelledBody body;
    body.position_m = {0.0, 0.0, 1.0};
    for (int i = 3; i < 900; ++i)
      body.position_m.push_back(body.position_m[i - 3] + 0.1 * (random.uniform() - 0.5));
    body.quality.assign(300, quality_good);
    return body;
  };
  Labels labels;
  labels.hand = walk(), labels.object = walk();
  auto known = motion_fingerprints(labels, {0, 300});
  EXPECT_GT(known.size(), 20u);
  std::ranges::sort(known);
  Labels turned = labels, other = labels;
  for (auto* body : {&turned.hand, &turned.object})
    for (std::size_t i = 0; i < 900; i += 3) {
      const double x = body->position_m[i];
      body->position_m[i] = -body->position_m[i + 1] + 1e-6, body->position_m[i + 1] = x + 2.0;
    }
  other.object = walk();
  const auto count_known = [&](const Labels& copy) {
    return std::ranges::count_if(motion_fingerprints(copy, {20, 280}), [&](const auto& hash) {
      return std::ranges::binary_search(known, hash);
    });
  };
  EXPECT_GT(count_known(turned), 10);
  EXPECT_EQ(count_known(other), 0);
  labels.hand.position_m.assign(900, 0.0), labels.object.position_m.assign(900, 0.0);
  EXPECT_TRUE(motion_fingerprints(labels, {0, 300}).empty()) << "at rest";
}

}  // namespace
}  // namespace touchtrace
