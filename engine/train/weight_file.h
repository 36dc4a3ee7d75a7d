#pragma once

#include <span>
#include <vector>

#include "engine/model/parameters.h"
#include "engine/train/safetensors.h"

namespace touchtrace {

/// Splits `values`, a flat array laid out by `table`, into one tensor per parameter.
std::vector<Tensor> tensors_of(const ParameterTable& table, std::span<const float> values);
/// Reads them back into a flat array. Throws data_error if a parameter is missing, has another size
/// or is not finite.
std::vector<float> values_of(const ParameterTable& table, const TensorFile& file);

}  // namespace touchtrace
