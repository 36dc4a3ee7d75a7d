#pragma once

#include <span>

#include "engine/model/parameters.h"
#include "engine/train/safetensors.h"

namespace touchtrace {

/// Every parameter of `values`, a flat array laid out by `table`, as a tensor of its own.
std::vector<Tensor> tensors_of(const ParameterTable& table, std::span<const float> values);
/// The flat array, read back. Throws data_error if a parameter is missing or has another size.
std::vector<float> values_of(const ParameterTable& table, const TensorFile& file);

}  // namespace touchtrace
