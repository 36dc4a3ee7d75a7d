#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pipeline/recording/chunk_codec.h"
#include "pipeline/recording/h5_convert.h"
#include "pipeline/recording/h5_handle.h"

namespace touchtrace::h5 {

/// Element type of a dataset as written and in memory; little-endian.
struct ElementType {
  Handle type;
  std::size_t bytes;
  /// Conversion from other types when reading; nullptr: text, which is not converted.
  Conversion (*find_conversion)(hid_t found) = nullptr;
};

/// `T`: float, double or an unsigned or signed integer that files have.
template <class T>
ElementType element_type();

/// UTF-8 text of `bytes` bytes, padded with zeros.
ElementType text_type(std::size_t bytes);
/// Name of a type for messages, such as "uint16" or "big-endian float64".
std::string type_name(hid_t type);

/// Extents of a dataset's axes. Throws H5Error unless it has 1 to 8.
std::vector<hsize_t> extents_of(hid_t space);

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

/// Reads one dataset of an untrusted file as elements of `type`. The dataset may be contiguous, or
/// chunked with the filters shuffle, deflate and fletcher32. The constructor throws H5Error for
/// other storage, an element type that cannot be converted, and chunks that are not in the file.
class ArrayReader {
 public:
  /// What chunks are that were never written.
  enum class Unwritten { faults, zeros };

  ArrayReader(hid_t group, const std::string& name, const ElementType& type, hsize_t file_bytes,
              Unwritten unwritten = Unwritten::faults);

  const std::vector<hsize_t>& shape() const { return shape_; }
  hsize_t rows() const { return shape_.front(); }
  std::size_t row_bytes() const { return row_elements_ * element_bytes_; }
  hid_t dataset() const { return dataset_; }
  /// Reads rows from `first` on until `out` is full. Throws H5Error for a damaged chunk or a value
  /// that `type` cannot hold. Thread-safe.
  void read(hsize_t first, std::span<std::uint8_t> out) const;

 private:
  using Extents = std::vector<hsize_t>;

  void set_type(const ElementType& type);
  void check_layout(hsize_t file_bytes, Unwritten unwritten);
  void check_contiguous() const;
  void check_filters(hid_t creation);
  void check_chunks(hsize_t file_bytes, Unwritten unwritten) const;
  /// Moves `offset` to the next chunk of the same rows; false after the last one.
  bool next_chunk(Extents& offset) const;
  void read_stored(hsize_t first, std::span<std::uint8_t> out) const;
  void read_contiguous(hsize_t first, std::span<std::uint8_t> out) const;
  void read_chunk(const Extents& offset, hsize_t first, std::span<std::uint8_t> out) const;
  /// Copies the part of a chunk within rows [first, last) into an array that begins at `first`.
  void copy(const Extents& offset, hsize_t first, hsize_t last, std::size_t axis,
            const std::uint8_t* chunk, std::uint8_t* array) const;
  /// Valid until the thread's next call; empty if the chunk was never written.
  std::span<const std::uint8_t> stored_chunk(const Extents& offset,
                                             std::uint32_t& skipped_filters) const;
  void decode(const Extents& offset, std::span<std::uint8_t> raw) const;

  Extents shape_, chunk_;  ///< chunk_ is empty if the dataset is contiguous
  std::size_t element_bytes_, stored_bytes_ = 0, row_elements_ = 0, chunk_bytes_ = 0;
  Conversion convert_ = nullptr;  ///< nullptr: the stored type is that in memory
  std::vector<H5Z_filter_t> pipeline_;
  Handle dataset_;
};

}  // namespace touchtrace::h5
