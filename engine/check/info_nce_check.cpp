#include "engine/check/info_nce_check.h"

#include <cmath>
#include <limits>

#include "engine/base/random.h"
#include "engine/check/host_arrays.h"
#include "engine/ops/info_nce.h"

namespace touchtrace {

InfoNceResult info_nce_on_device(Runtime& runtime, const InfoNceProblem& problem) {
  constexpr int lead = 3;  // floats before the row losses, which must not change
  const auto count = problem.weight.size();
  const InfoNceArrays arrays{
      .count = static_cast<int>(count),
      .columns = problem.columns,
      .temperature = problem.temperature,
      .embedding = upload(runtime, problem.embedding),
      .object = runtime.upload<int>(problem.object),
      .weight = upload(runtime, problem.weight),
      .row_loss = runtime.allocate_zeros<float>(lead + count),
      .row_loss_at = lead,
      .grad_embedding = runtime.allocate_zeros<float>(problem.embedding.size())};
  enqueue(runtime, info_nce(runtime, arrays));
  return {split(download(runtime, arrays.row_loss), lead).second,
          download(runtime, arrays.grad_embedding)};
}

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

}  // namespace touchtrace
