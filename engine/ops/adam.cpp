#include "engine/ops/adam.h"

#include <cmath>

#include "engine/base/integer_math.h"

namespace touchtrace {
namespace {

constexpr cl_uint clip_norm_argument = 8;

/// Kernel with `chunk` parameters per work-item.
Kernel adam_kernel(Runtime& runtime, const char* name, int chunk) {
  return runtime.kernel({"common.clh", "adam.cl"}, name, {{"CHUNK", std::to_string(chunk)}});
}

/// Partial sums of the squared gradient values, one for each `chunk` of them.
Launch squares_launch(Runtime& runtime, int chunk, const Buffer<float>& gradient, int size,
                      const Buffer<float>& partial) {
  const int chunks = ceil_div(size, chunk), group = 256;
  if (runtime.kernel_variant() == KernelVariant::cpu)
    return {adam_kernel(runtime, "squares", chunk), range(chunks), gradient, size, partial};
  return Launch(adam_kernel(runtime, "squares_gpu", chunk), range(chunks), gradient, size, partial)
      .with_local_size(group);
}

Launch update_launch(Runtime& runtime, int size, const auto&... arguments) {
  constexpr int chunk = 1024, group = 256;
  if (runtime.kernel_variant() == KernelVariant::cpu)
    return {adam_kernel(runtime, "adam", chunk), range(ceil_div(size, chunk)), arguments...};
  return Launch(adam_kernel(runtime, "adam", 1), range(ceil_div(size, group)), arguments...)
      .with_local_size(group);
}

}  // namespace

Adam::Adam(Runtime& runtime, const Buffer<float>& parameters, const Buffer<float>& gradient,
           const Buffer<float>& decay, const Buffer<float>& loss)
    : runtime_(runtime) {
  const int size = static_cast<int>(parameters.size());
  const int chunk = runtime.kernel_variant() == KernelVariant::gpu ? 4096 : 1024,
            chunks = ceil_div(size, chunk);
  first_ = runtime.allocate_zeros<float>(parameters.size());
  second_ = runtime.allocate_zeros<float>(parameters.size());
  partial_ = runtime.allocate<float>(static_cast<std::size_t>(chunks));
  norm_ = runtime.allocate<float>(1);
  const bool exact = runtime.accuracy() == Accuracy::exact;
  if (exact) compensation_ = runtime.allocate_zeros<float>(parameters.size());
  measure_ = {squares_launch(runtime, chunk, gradient, size, partial_)
                  .with_cost(2.0 * size, 4.0 * size)
                  .with_purpose(Purpose::optimiser),
              Launch(adam_kernel(runtime, "norm", chunk), range(1), partial_, chunks, norm_)
                  .with_cost(chunks, 4.0 * chunks)
                  .with_purpose(Purpose::optimiser)};
  update_ = {update_launch(runtime, size, parameters, gradient, first_, second_, decay, size, norm_,
                           loss, 0.0f, 0.0f, 0.0f, 0.0f, exact ? compensation_ : norm_)
                 .with_cost(17.0 * size, 4.0 * size * (exact ? 10.0 : 8.0))
                 .with_purpose(Purpose::optimiser)};
}

std::vector<std::pair<std::string, Buffer<float>>> Adam::state() const {
  std::vector<std::pair<std::string, Buffer<float>>> arrays{{"adam.first_moment", first_},
                                                            {"adam.second_moment", second_}};
  if (compensation_.size() > 0) arrays.emplace_back("adam.compensation", compensation_);
  return arrays;
}

void Adam::enqueue(const AdamStep& step) {
  const float arguments[] = {static_cast<float>(step.clip_norm),
                             static_cast<float>(step.learning_rate),
                             static_cast<float>(1.0 / (1.0 - std::pow(0.9, step.count))),
                             static_cast<float>(1.0 / (1.0 - std::pow(0.999, step.count)))};
  for (cl_uint i = 0; i < 4; ++i) update_[0].set(clip_norm_argument + i, arguments[i]);
  touchtrace::enqueue(runtime_, measure_);
  touchtrace::enqueue(runtime_, update_);
}

}  // namespace touchtrace
