#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pipeline/recording/chunk_codec.h"
#include "pipeline/recording/h5_handle.h"

namespace touchtrace::h5 {

/// Element type of a dataset; little-endian, also in memory.
struct ElementType {
  Handle type;
  std::size_t bytes;
};

template <class T>
ElementType element_type();
template <>
ElementType element_type<double>();
template <>
ElementType element_type<float>();
template <>
ElementType element_type<std::uint8_t>();
template <>
ElementType element_type<std::uint16_t>();
template <>
ElementType element_type<std::int32_t>();
template <>
ElementType element_type<std::int64_t>();
template <>
ElementType element_type<std::uint64_t>();
/// UTF-8 text of `bytes` bytes, padded with zeros.
ElementType text_type(std::size_t bytes);
/// Name of a type for messages, such as "uint16" or "big-endian float64".
std::string type_name(hid_t type);
/// Throws H5Error unless `found` is `expected`, byte order included.
void require_type(hid_t found, const ElementType& expected);

/// Writes one dataset row by row along its first axis: chunked, shuffled, deflated, with fletcher32
/// checksums. Throws H5Error, also if the disk is full.
class ArrayWriter {
 public:
  /// `row_shape`: extents of the other axes. `chunk_rows`: 0 for chunks of about 128 KiB.
  ArrayWriter(hid_t group, const std::string& name, const ElementType& type,
              const std::vector<hsize_t>& row_shape, hsize_t chunk_rows = 0);

  void append(std::span<const std::uint8_t> rows);
  hid_t dataset() const { return dataset_; }
  hsize_t rows() const { return rows_; }
  /// Writes the last chunk.
  void close();

 private:
  void write_pending(hsize_t rows);

  std::string name_;
  std::vector<hsize_t> row_shape_;
  std::size_t row_bytes_;
  hsize_t chunk_rows_, rows_ = 0;
  ChunkFilters filters_;
  std::vector<std::uint8_t> pending_;
  Handle dataset_;
};

/// Reads one dataset of an untrusted file. The constructor throws H5Error unless the dataset has
/// this type, is chunked along its first axis only, has checksums and no filters other than
/// shuffle, deflate and fletcher32, and its chunks are in the file.
class ArrayReader {
 public:
  ArrayReader(hid_t group, const std::string& name, const ElementType& type, hsize_t file_bytes);

  const std::vector<hsize_t>& shape() const { return shape_; }
  hsize_t rows() const { return shape_.front(); }
  std::size_t row_bytes() const { return row_bytes_; }
  hid_t dataset() const { return dataset_; }
  /// Reads rows from `first` on until `out` is full. Throws H5Error for a damaged chunk.
  /// Thread-safe.
  void read(hsize_t first, std::span<std::uint8_t> out) const;

 private:
  void check_layout();
  void check_filters(hid_t creation);
  void check_chunks(hsize_t file_bytes) const;
  /// Valid until the thread's next call.
  std::span<const std::uint8_t> stored_chunk(hsize_t chunk, std::uint32_t& skipped_filters) const;
  void decode(hsize_t chunk, std::span<std::uint8_t> raw) const;

  std::vector<hsize_t> shape_;
  std::size_t element_bytes_, row_bytes_ = 0;
  hsize_t chunk_rows_ = 1;
  std::vector<H5Z_filter_t> pipeline_;
  Handle dataset_;
};

}  // namespace touchtrace::h5
