#include "engine/train/verify_engine.h"

#include <utility>
#include <vector>

namespace touchtrace {
namespace {

/// One row a group of figures.
const std::vector<Verification>& groups() {
  static const std::vector<Verification> table{};
  return table;
}

}  // namespace

Verification verify_engine() {
  return [](const std::function<void(Figure)>& emit) {
    for (const auto& group : groups()) group(emit);
  };
}

}  // namespace touchtrace
