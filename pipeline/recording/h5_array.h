#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pipeline/recording/chunk_codec.h"
#include "pipeline/recording/h5_handle.h"

namespace touchtrace::h5 {

/// A type that a dataset may have: little-endian in the file, the machine's own in memory.
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
/// Text of at most `bytes` bytes, padded with zeros, UTF-8.
ElementType text_type(std::size_t bytes);

/// Writes one dataset, row after row along its first axis: chunked, shuffled, deflated, fletcher32.
class ArrayWriter {
 public:
  /// `row_shape`: the extents behind the first axis. `chunk_rows`: 0 leaves the choice to the
  /// writer.
  ArrayWriter(hid_t group, const std::string& name, const ElementType& type,
              const std::vector<hsize_t>& row_shape, hsize_t chunk_rows = 0);

  void append(std::span<const std::uint8_t> rows);
  hid_t dataset() const { return dataset_; }
  hsize_t rows() const { return rows_; }
  /// Writes the last chunk. Throws H5Error if the disk is full; so does `append`.
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
/// the type, is chunked along its first axis only, uses no filter but ours, checks its chunks, and
/// lies inside the file.
class ArrayReader {
 public:
  ArrayReader(hid_t group, const std::string& name, const ElementType& type, hsize_t file_bytes);

  const std::vector<hsize_t>& shape() const { return shape_; }
  hsize_t rows() const { return shape_.front(); }
  std::size_t row_bytes() const { return row_bytes_; }
  hid_t dataset() const { return dataset_; }
  /// Rows from `first` on, as many as `out` holds. Throws H5Error if a chunk is missing or damaged.
  /// May be called by several threads.
  void read(hsize_t first, std::span<std::uint8_t> out) const;

 private:
  void check_layout();
  void check_filters(hid_t creation);
  void check_chunks(hsize_t file_bytes) const;
  /// Until the thread's next call.
  std::span<const std::uint8_t> stored_chunk(hsize_t chunk, std::uint32_t& skipped_filters) const;
  void decode(hsize_t chunk, std::span<std::uint8_t> raw) const;

  std::string name_;
  std::vector<hsize_t> shape_;
  std::size_t element_bytes_, row_bytes_ = 0;
  hsize_t chunk_rows_ = 1;
  std::vector<H5Z_filter_t> pipeline_;
  Handle dataset_;
};

}  // namespace touchtrace::h5
