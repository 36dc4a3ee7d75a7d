#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <numeric>

#include "pipeline/recording/h5_array.h"

namespace touchtrace::h5 {
namespace {

constexpr std::size_t target_chunk_bytes = 128 << 10;

hsize_t product(const std::vector<hsize_t>& extents) {
  return std::accumulate(extents.begin(), extents.end(), hsize_t{1}, std::multiplies<>());
}

std::vector<hsize_t> with_rows(hsize_t rows, const std::vector<hsize_t>& row_shape) {
  std::vector<hsize_t> shape{rows};
  shape.insert(shape.end(), row_shape.begin(), row_shape.end());
  return shape;
}

Handle creation_properties(const std::vector<hsize_t>& chunk, bool shuffled) {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "dataset properties");
  check(H5Pset_obj_track_times(properties, false), "dataset properties");
  check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), "chunks");
  if (shuffled) check(H5Pset_shuffle(properties), "shuffle");
  check(H5Pset_deflate(properties, 1), "deflate");
  check(H5Pset_fletcher32(properties), "fletcher32");
  return properties;
}

}  // namespace

ArrayWriter::ArrayWriter(hid_t group, const std::string& name, const ElementType& type,
                         const std::vector<hsize_t>& row_shape, hsize_t chunk_rows)
    : name_(name), row_shape_(row_shape), row_bytes_(product(row_shape) * type.bytes) {
  const LibraryLock lock;
  chunk_rows_ = chunk_rows > 0 ? chunk_rows : std::max<hsize_t>(1, target_chunk_bytes / row_bytes_);
  filters_.shuffle_bytes = H5Tget_class(type.type) == H5T_STRING ? 1 : type.bytes;
  const auto extents = with_rows(0, row_shape), limits = with_rows(H5S_UNLIMITED, row_shape);
  const Handle space(
      H5Screate_simple(static_cast<int>(extents.size()), extents.data(), limits.data()), H5Sclose,
      name);
  const auto properties =
      creation_properties(with_rows(chunk_rows_, row_shape), filters_.shuffle_bytes > 1);
  dataset_ = Handle(
      H5Dcreate2(group, name.c_str(), type.type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
      H5Dclose, name);
}

void ArrayWriter::append(std::span<const std::uint8_t> rows) {
  const std::size_t chunk_bytes = chunk_rows_ * row_bytes_;
  while (!rows.empty()) {
    const auto part = rows.first(std::min(rows.size(), chunk_bytes - pending_.size()));
    pending_.insert(pending_.end(), part.begin(), part.end());
    rows = rows.subspan(part.size());
    if (pending_.size() == chunk_bytes) write_pending(chunk_rows_);
  }
}

void ArrayWriter::write_pending(hsize_t rows) {
  pending_.resize(chunk_rows_ * row_bytes_);
  const auto stored = encode_chunk(pending_, filters_);
  const auto shape = with_rows(rows_ + rows, row_shape_);
  std::vector<hsize_t> offset(shape.size(), 0);
  offset[0] = rows_;
  const LibraryLock lock;
  check(H5Dset_extent(dataset_, shape.data()), name_);
  check(H5Dwrite_chunk(dataset_, H5P_DEFAULT, 0, offset.data(), stored.size(), stored.data()),
        name_);
  rows_ += rows;
  pending_.clear();
}

void ArrayWriter::close() {
  if (!pending_.empty()) write_pending(pending_.size() / row_bytes_);
  const LibraryLock lock;
  dataset_.close(name_);
}

}  // namespace touchtrace::h5
