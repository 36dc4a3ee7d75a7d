#include <fmt/core.h>

#include <algorithm>
#include <random>

#include "engine/check/info_nce_check.h"
#include "tests/verify/engine/verify_engine.h"

namespace touchtrace {
namespace {

/// Largest error over anchors, nearly equal and different logits, dot products and unit vectors.
double worst_error(Runtime& runtime, double logit, std::uint64_t seed) {
  double worst = 0.0;
  for (bool alike : {false, true})
    for (bool unit : {false, true})
      worst = std::max(worst, info_nce_error(runtime, info_nce_extreme(logit, alike, unit, seed)));
  return worst;
}

}  // namespace

void verify_contrast(const std::function<void(Figure)>& emit) {
  const std::uint64_t seed = std::random_device{}();
  for (const auto& device : list_devices()) {
    Runtime runtime({device, "verified"});
    double worst = 0.0;
    for (double logit : {1e-3, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4})
      worst = std::max(worst, worst_error(runtime, logit, seed));
    emit(at_most(
        fmt::format("InfoNCE on device {}, logits 0 to 1e4, loss of an anchor", device.number),
        worst, "relative", 1e-6));
    emit(at_most(fmt::format("InfoNCE on device {}, logits 1e4, loss of an anchor", device.number),
                 worst_error(runtime, 1e4, seed), "relative", 1e-6));
  }
}

}  // namespace touchtrace
