#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace touchtrace {

/// How a parameter starts: uniform in [centre - half_range, centre + half_range).
struct Initial {
  double centre = 0.0, half_range = 0.0;
};

/// One learnable array inside the flat buffer of all parameters, in C order. Names and shapes are
/// those of the PyTorch layer of the same kind: convolution weight [out, in, 3, 3], bias [out].
struct Parameter {
  std::string name;
  std::vector<int> shape;
  std::size_t offset, size;  ///< in floats, from the start of the buffer
  Initial initial;
};

/// Every parameter of a model. Weights, gradients and the optimiser's moments are flat buffers of
/// size() floats in this one layout. Each parameter starts at a multiple of 16 floats; the gaps
/// between them hold zeros, and so do the gaps of a gradient.
class ParameterTable {
 public:
  /// Places a new parameter behind the last one. Throws failure for a name that is taken.
  Parameter add(std::string name, std::vector<int> shape, Initial initial);

  const std::vector<Parameter>& rows() const { return rows_; }
  std::size_t size() const { return size_; }
  /// Throws failure for a name that is not in the table.
  const Parameter& at(std::string_view name) const;
  /// The flat buffer to start from. Each parameter draws from a RandomStream of its own name.
  std::vector<float> initial_values(std::uint64_t seed) const;

 private:
  std::vector<Parameter> rows_;
  std::size_t size_ = 0;
};

}  // namespace touchtrace
