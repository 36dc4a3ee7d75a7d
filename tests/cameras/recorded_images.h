#pragma once

#include <hdf5.h>
#include <hdf5_hl.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace touchtrace::testing {

inline hid_t type_of(std::uint8_t) { return H5T_NATIVE_UINT8; }
inline hid_t type_of(std::uint16_t) { return H5T_NATIVE_UINT16; }
inline hid_t type_of(std::uint64_t) { return H5T_NATIVE_UINT64; }
inline hid_t type_of(double) { return H5T_NATIVE_DOUBLE; }

/// All values of a data set. The file was written by the test.
template <class Value>
std::vector<Value> read_values(hid_t file, const std::string& name) {
  hsize_t dimensions[4]{1, 1, 1, 1};
  if (H5LTget_dataset_info(file, name.c_str(), dimensions, nullptr, nullptr) < 0)
    throw std::runtime_error("no data set " + name);
  std::vector<Value> values(dimensions[0] * dimensions[1] * dimensions[2] * dimensions[3]);
  if (H5LTread_dataset(file, name.c_str(), type_of(Value{}), values.data()) < 0)
    throw std::runtime_error("cannot read " + name);
  return values;
}

/// Images of one stream with their stamps, as the file stores them: RecordingReader returns only
/// pairs of colour and depth.
template <class Value>
struct RecordedImages {
  std::vector<std::uint64_t> sequence;
  std::vector<double> device_time_s, host_time_s;
  std::vector<Value> values;  ///< [images, ...]

  /// `stream`: "color" or "depth".
  RecordedImages(const std::filesystem::path& path, const std::string& stream) {
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    sequence = read_values<std::uint64_t>(file, stream + "/sequence");
    device_time_s = read_values<double>(file, stream + "/device_time_s");
    host_time_s = read_values<double>(file, stream + "/host_time_s");
    values = read_values<Value>(file, stream + "/image");
    H5Fclose(file);
  }

  std::size_t size() const { return sequence.size(); }
  std::vector<Value> image(std::size_t index) const {
    const std::size_t length = values.size() / size();
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(index * length);
    return {first, first + static_cast<std::ptrdiff_t>(length)};
  }
};

}  // namespace touchtrace::testing
