#include "engine/train/weight_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/finite.h"

namespace touchtrace {

std::vector<Tensor> tensors_of(const ParameterTable& table, std::span<const float> values) {
  std::vector<Tensor> tensors;
  for (const auto& row : table.rows()) {
    const auto slice = values.subspan(row.offset, row.size);
    tensors.push_back(
        {row.name, {row.shape.begin(), row.shape.end()}, {slice.begin(), slice.end()}});
  }
  return tensors;
}

std::vector<float> values_of(const ParameterTable& table, const TensorFile& file) {
  std::vector<float> values(table.size(), 0.0f);
  for (const auto& row : table.rows()) {
    const auto& stored = file.at(row.name, row.size).values;
    if (!all_finite(stored))
      throw data_error(fmt::format("{}: tensor '{}' has values that are not finite",
                                   file.path.string(), row.name),
                       "use a file that touchtrace train wrote");
    std::ranges::copy(stored, values.begin() + static_cast<std::ptrdiff_t>(row.offset));
  }
  return values;
}

}  // namespace touchtrace
