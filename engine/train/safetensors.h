#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace touchtrace {

/// Named array of 32-bit floats in C order.
struct Tensor {
  std::string name;
  std::vector<std::size_t> shape;
  std::vector<float> values;
};

/// Contents of a safetensors file (huggingface.co/docs/safetensors): u64 header size, JSON header,
/// values.
struct TensorFile {
  std::map<std::string, std::string> metadata;  ///< "__metadata__" without the checksum
  std::vector<Tensor> tensors;                  ///< in file order
  std::filesystem::path path{};                 ///< that it was read from, for messages

  /// Throws data_error if there is no such tensor or it does not have `size` values.
  const Tensor& at(const std::string& name, std::size_t size) const;
};

/// Writes a file; its metadata "checksum" covers all its bytes.
void write_safetensors(const std::filesystem::path& path, const TensorFile& file, bool overwrite);

/// Safe for untrusted files. Throws data_error for anything but a complete, well-formed file of
/// float tensors, such as: a header beyond the end of the file, duplicate keys, offsets with gaps
/// or overlaps, sizes that do not match shapes, a wrong checksum. Files of other programs have
/// none.
TensorFile read_safetensors(const std::filesystem::path& path);

}  // namespace touchtrace
