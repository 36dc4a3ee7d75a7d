#include "engine/ops/info_nce.h"

namespace touchtrace {

Launches info_nce(Runtime& runtime, const InfoNceArrays& a) {
  const bool normalised = a.temperature > 0;
  const auto kernel = [&](const char* name) {
    return runtime.kernel(
        {"common.clh", "info_nce.cl"}, name,
        {{"COLUMNS", std::to_string(a.columns)}, {"NORMALISED", normalised ? "1" : "0"}});
  };
  const auto count = static_cast<std::size_t>(a.count), pairs = count * count;
  const auto logit = runtime.allocate<float>(2 * pairs), slope = runtime.allocate<float>(pairs);
  const auto scale = runtime.allocate<float>(normalised ? 2 * count : 0);
  Launches launches;
  const auto add = [&](const char* name, const cl::NDRange& global, const auto&... arguments) {
    launches.push_back(Launch(kernel(name), global, arguments...).with_purpose(Purpose::loss));
  };
  if (normalised) add("info_nce_scales", range(a.count), a.embedding, a.temperature, scale);
  add("info_nce_logits", range(a.count, a.count), a.embedding, scale, logit);
  add("info_nce_rows", range(a.count), logit, a.object, a.weight, a.row_loss, a.row_loss_at, slope);
  add("info_nce_gradient", range(a.columns / 16, a.count), a.embedding, scale, a.temperature, logit,
      slope, a.grad_embedding);
  return launches;
}

}  // namespace touchtrace
