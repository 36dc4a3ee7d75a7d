#include "engine/ops/operation.h"

namespace touchtrace {

const std::vector<Operation>& operations() {
  static const std::vector<Operation> table{};
  return table;
}

}  // namespace touchtrace
