#include "engine/check/info_nce_check.h"

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

}  // namespace touchtrace
