#pragma once

#include <string_view>

#include "engine/model/parameters.h"
#include "engine/ops/dense.h"

namespace touchtrace {

/// Weights of a model on a device and, in training, their gradient: flat, laid out by `table`.
struct Weights {
  const ParameterTable& table;
  Buffer<float> values, gradient;  ///< gradient: empty for prediction

  /// Views a parameter as a matrix [shape[0], shape[1]], or as one row.
  MatrixView value(std::string_view name) const { return view(values, name); }
  MatrixView grad(std::string_view name) const { return view(gradient, name); }

 private:
  MatrixView view(const Buffer<float>& buffer, std::string_view name) const {
    const auto& row = table.at(name);
    return {buffer, static_cast<int>(row.offset), row.shape.size() == 2 ? row.shape[1] : 0};
  }
};

/// Allocates weights and, if `training`, the gradient. `table` must be complete.
inline Weights allocate_weights(Runtime& runtime, const ParameterTable& table, bool training) {
  return {table, runtime.allocate<float>(table.size()),
          runtime.allocate<float>(training ? table.size() : 0)};
}

}  // namespace touchtrace
