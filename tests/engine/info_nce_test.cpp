// The contrastive loss where float is weak: large logits, tiny losses, anchors without a pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "engine/base/random.h"
#include "engine/check/info_nce_check.h"

namespace touchtrace {
namespace {

/// Largest relative error of the anchors' losses, not counting underflow near float's smallest
/// normal number. Infinite if a value is not finite.
double info_nce_error(Runtime& runtime, const InfoNceProblem& problem) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const auto reference = info_nce_reference(problem).row_loss,
             actual = info_nce_on_device(runtime, problem).row_loss;
  double worst = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double off = std::abs(actual[i] - reference[i]);
    if (!std::isfinite(off)) return infinite;
    if (off > std::numeric_limits<float>::min()) worst = std::max(worst, off / reference[i]);
  }
  return worst;
}

/// Sixteen embeddings of 64 values of four objects, with logits up to `logit`. `alike`: logits
/// differ by some tens only, so that a loss is a small difference of large numbers. `unit`:
/// embeddings have random lengths, and the temperature sets the logits.
InfoNceProblem info_nce_extreme(double logit, bool alike, bool unit, std::uint64_t seed) {
  constexpr int count = 16, columns = 64, objects = 4;
  RandomStream random(seed, "extreme embeddings");
  const double length = std::sqrt(logit / columns);
  const double noise = alike ? std::min(length, 10.0 / std::sqrt(1.0 + logit)) : length;
  InfoNceProblem problem{columns, unit ? static_cast<float>(1.0 / logit) : 0.0f, {}, {}, {}};
  for (int i = 0; i < count; ++i) {
    const double scale = unit ? random.uniform(0.1, 10.0) : 1.0;
    for (int d = 0; d < columns; ++d)
      problem.embedding.push_back(
          static_cast<float>(scale * ((alike ? length : 0.0) + noise * random.normal())));
    problem.object.push_back(i % objects);
    problem.weight.push_back(1.0);
  }
  return problem;
}

class InfoNce : public ::testing::Test {
 protected:
  InfoNceResult on_device(const InfoNceProblem& problem) {
    return info_nce_on_device(runtime_, problem);
  }
  Runtime runtime_{choose_device("")};
};

TEST_F(InfoNce, IsAccurateForLogitsUpToTenThousand) {
  const std::uint64_t seed = std::random_device{}();
  for (const auto& device : list_devices()) {
    Runtime runtime({device, "test"});
    for (double logit : {1e-3, 0.01, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4})
      for (bool alike : {false, true})
        for (bool unit : {false, true})
          EXPECT_LE(info_nce_error(runtime, info_nce_extreme(logit, alike, unit, seed)), 1e-6)
              << device.name << ", logits " << logit << ", alike " << alike << ", unit " << unit
              << ", seed " << seed;
  }
}

TEST_F(InfoNce, GradientsStayFiniteAtLargeLogits) {
  for (double logit : {1e4, 1e8, 1e12})
    for (double value : on_device(info_nce_extreme(logit, false, false, 1)).grad_embedding)
      ASSERT_TRUE(std::isfinite(value)) << logit;
}

TEST_F(InfoNce, IsTheLogarithmOfTheNumberOfCandidatesWhereNothingIsLearnt) {
  InfoNceProblem problem = info_nce_extreme(0.0, false, false, 1);
  // Each anchor has 3 positives and 12 negatives.
  for (double loss : on_device(problem).row_loss) EXPECT_NEAR(loss, 3 * std::log(13.0), 1e-6);
}

TEST_F(InfoNce, AnchorsWithoutAPositiveOrANegativeCountNothing) {
  for (auto object :
       {std::vector<int>(16, 5), {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}}) {
    auto problem = info_nce_extreme(10.0, false, false, 1);
    problem.object = object;
    const auto result = on_device(problem);
    EXPECT_EQ(result.row_loss, std::vector<double>(16, 0.0));
    EXPECT_TRUE(std::ranges::all_of(result.grad_embedding, [](double g) { return g == 0.0; }));
  }
}

TEST_F(InfoNce, AddsToTheGradientInTheSameOrderEachTime) {
  const auto problem = info_nce_extreme(5.0, false, true, 3);
  EXPECT_EQ(on_device(problem).grad_embedding, on_device(problem).grad_embedding);
}

TEST_F(InfoNce, FallsAlongItsNegativeGradient) {
  auto problem = info_nce_extreme(1.0, false, false, 2);
  const auto total = [&] {
    const auto rows = on_device(problem).row_loss;
    return std::accumulate(rows.begin(), rows.end(), 0.0);
  };
  const double before = total();
  for (int step = 0; step < 200; ++step) {
    const auto gradient = on_device(problem).grad_embedding;
    for (std::size_t i = 0; i < gradient.size(); ++i) problem.embedding[i] -= 0.03 * gradient[i];
  }
  EXPECT_LT(total(), 0.01 * before);
}

}  // namespace
}  // namespace touchtrace
