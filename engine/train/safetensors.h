#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace touchtrace {

/// A named array of 32-bit floats in C order.
struct Tensor {
  std::string name;
  std::vector<std::size_t> shape;
  std::vector<float> values;
};

/// A safetensors file (huggingface.co/docs/safetensors): u64 size of the header, JSON header,
/// values.
struct TensorFile {
  std::map<std::string, std::string> metadata;  ///< "__metadata__"
  std::vector<Tensor> tensors;                  ///< in the order of their values

  /// Throws data_error if there is no such tensor or it does not hold `size` values.
  const Tensor& at(const std::string& name, std::size_t size) const;
};

void write_safetensors(const std::filesystem::path& path, const TensorFile& file, bool overwrite);

/// Throws data_error for anything but a whole, well-formed file of float tensors: a header beyond
/// the file, duplicate keys, offsets with gaps or overlaps, sizes that do not fit their shapes.
TensorFile read_safetensors(const std::filesystem::path& path);

}  // namespace touchtrace
