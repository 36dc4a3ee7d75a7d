#include "engine/ops/sum.h"

namespace touchtrace {

Launch sum(Runtime& runtime, const Buffer<float>& values, const Buffer<float>& total) {
  return Launch(runtime.kernel({"common.clh", "sum.cl"}, "sum"), range(1), values,
                static_cast<int>(values.size()), total)
      .with_cost(1.0 * values.size(), 4.0 * values.size());
}

}  // namespace touchtrace
