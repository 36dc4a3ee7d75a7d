#pragma once

#include <string_view>

#include "engine/model/parameters.h"
#include "engine/ops/dense.h"

namespace touchtrace {

/// All weights of a model on a device and, in training, their gradient: flat, as `table` lays out.
struct Weights {
  const ParameterTable& table;
  Buffer<float> values, gradient;

  /// A parameter as a matrix [shape[0], shape[1]], or as one row.
  MatrixView value(std::string_view name) const { return view(values, name); }
  MatrixView grad(std::string_view name) const { return view(gradient, name); }

 private:
  MatrixView view(const Buffer<float>& buffer, std::string_view name) const {
    const auto& row = table.at(name);
    return {buffer, static_cast<int>(row.offset), row.shape.size() == 2 ? row.shape[1] : 0};
  }
};

/// Room for the weights of a complete table and, for training, for their gradient.
inline Weights allocate_weights(Runtime& runtime, const ParameterTable& table, bool training) {
  return {table, runtime.allocate<float>(table.size()),
          runtime.allocate<float>(training ? table.size() : 0)};
}

}  // namespace touchtrace
