#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

/// Initial distribution of a parameter: uniform in [centre - half_range, centre + half_range).
struct Initial {
  double centre = 0.0, half_range = 0.0;
};

/// One learnable array inside the flat parameter buffer, in C order. Names and shapes follow the
/// PyTorch layer of the same kind: convolution weight [out, in, 3, 3], bias [out].
struct Parameter {
  std::string name;
  std::vector<int> shape;
  std::size_t offset, size;  ///< floats, from the start of the buffer
  Initial initial;
};

/// Layout of all parameters of a model. Weights, gradients and the optimiser's moments are flat
/// buffers of size() floats in this layout. Each parameter starts at a multiple of 16 floats; the
/// gaps are zero, also in gradients.
class ParameterTable {
 public:
  /// Appends a parameter. Throws failure if the name exists.
  Parameter add(std::string name, std::vector<int> shape, Initial initial);

  const std::vector<Parameter>& rows() const { return rows_; }
  std::size_t size() const { return size_; }
  /// Throws failure if the name does not exist.
  const Parameter& at(std::string_view name) const;
  /// Random initial values, flat. Each parameter draws from a RandomStream of its own name.
  std::vector<float> initial_values(std::uint64_t seed) const;

 private:
  std::vector<Parameter> rows_;
  std::size_t size_ = 0;
};

}  // namespace touchtrace
