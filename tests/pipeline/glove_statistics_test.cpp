#include "tests/verify/scene/glove_statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/error.h"
#include "engine/base/random.h"
#include "pipeline/scene/base/parameter_registry.h"

namespace touchtrace::scene {
namespace {

constexpr int rows = 4, cols = 4, taxels = rows * cols;
constexpr double noise_counts = 3.0, force_counts = 400.0;

/// Taxels 0 to 7 follow a square wave of 4 s, 8 to 14 leak -1 % of it, 15 is constant.
GloveStream known_glove(int frames) {
  GloveStream glove;
  glove.info.rows = rows, glove.info.cols = cols, glove.info.rate_hz = 10.0;
  glove.info.baseline_counts.assign(taxels, 500.0f);
  glove.info.mask.assign(taxels, 1);
  RandomStream random(1, "known glove");
  for (int frame = 0; frame < frames; ++frame) {
    const double force = frame / 20 % 2 ? force_counts : 0.0;
    for (int taxel = 0; taxel < taxels; ++taxel) {
      const double pressure = taxel < 8 ? force : -0.01 * force;
      const double count = 500.0 + pressure + random.normal(0.0, noise_counts);
      glove.counts.push_back(taxel == 15 ? 510 : static_cast<std::uint16_t>(std::lround(count)));
    }
    glove.sequence.push_back(std::uint64_t(frame) + (frame >= 50 ? 3 : 0) +
                             (frame >= 100 ? 500 : 0));
    glove.host_time_s.push_back(0.1 * double(glove.sequence.back()));
  }
  return glove;
}

TEST(GloveStatistics, AreThoseOfAKnownGlove) {
  const GloveStatistics s = glove_statistics(known_glove(400));
  constexpr double scale = 1023.0;
  EXPECT_NEAR(scale * s.rest_level, 500.0, 1.0);
  EXPECT_NEAR(scale * s.noise, std::hypot(noise_counts, std::sqrt(1.0 / 12.0)), 0.5);
  EXPECT_NEAR(scale * s.peak_pressure, force_counts, 4.0 * noise_counts);
  EXPECT_NEAR(s.loaded_taxels, 0.25, 0.01);  // half of the taxels, half of the time
  EXPECT_NEAR(s.constant_taxels, 1.0 / taxels, 1e-9);
  EXPECT_LT(s.quiet_correlation, -0.5);
  EXPECT_NEAR(s.lost_frames, 3.0 / 403.0, 1e-9) << "the pause of 50 s is none";
  EXPECT_NEAR(s.correlation_half_second, 0.5, 0.05);  // of a square wave after an eighth of it
  EXPECT_THROW(glove_statistics(known_glove(10)), Error);
}

TEST(GloveStatistics, SettingsOfEveryGloveModelAreValid) {
  for (const GloveModel& model : glove_models())
    EXPECT_NO_THROW(parse_parameters(model.settings)) << model.name;
}

}  // namespace
}  // namespace touchtrace::scene
