#include "tests/verify/engine/verify_engine.h"

namespace touchtrace {

Verification verify_engine() {
  return [](const std::function<void(Figure)>& emit) {
    for (const auto& group : {verify_bits, verify_extremes, verify_operations, verify_contrast,
                              verify_encoder, verify_training})
      group(emit);
  };
}

}  // namespace touchtrace
