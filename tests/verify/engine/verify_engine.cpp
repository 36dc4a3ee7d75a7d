#include "tests/verify/engine/verify_engine.h"

#include "tests/verify/verifications.h"

namespace touchtrace {

Verification verify_engine() {
  return [](const std::function<void(Figure)>& emit) {
    for (const auto& group : {verify_processes, verify_extremes, verify_encoder, verify_training})
      group(emit);
  };
}

}  // namespace touchtrace
