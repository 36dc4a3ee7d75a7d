#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "pipeline/recording/h5_array.h"

namespace touchtrace::h5 {
namespace {

constexpr hsize_t max_compression = 1032;  // of deflate
constexpr hsize_t max_chunk_bytes = 256 << 20;
constexpr int max_rank = 8;

std::vector<hsize_t> extents_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (H5Sget_simple_extent_type(space) != H5S_SIMPLE || rank < 1 || rank > max_rank)
    throw H5Error(fmt::format("expected an array of 1 to {} axes, found {}", max_rank, rank));
  std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
  check(H5Sget_simple_extent_dims(space, extents.data(), nullptr), "cannot read its shape");
  return extents;
}

/// Bytes of a block of this shape. Throws if they exceed `limit`.
hsize_t bounded_bytes(const std::vector<hsize_t>& shape, hsize_t element_bytes, hsize_t limit) {
  hsize_t bytes = element_bytes;
  for (hsize_t extent : shape) {
    if (extent != 0 && bytes > limit / extent)
      throw H5Error("its shape needs more bytes than the file can hold");
    bytes *= extent;
  }
  return bytes;
}

}  // namespace

ArrayReader::ArrayReader(hid_t group, const std::string& name, const ElementType& type,
                         hsize_t file_bytes)
    : element_bytes_(type.bytes) {
  const LibraryLock lock;
  dataset_ = Handle(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, "cannot open it");
  require_type(Handle(H5Dget_type(dataset_), H5Tclose, "cannot read its type"), type);
  shape_ = extents_of(Handle(H5Dget_space(dataset_), H5Sclose, "cannot read its shape"));
  const hsize_t limit =
      std::min(file_bytes, std::numeric_limits<hsize_t>::max() / max_compression) * max_compression;
  bounded_bytes(shape_, element_bytes_, limit);
  row_bytes_ = bounded_bytes({shape_.begin() + 1, shape_.end()}, element_bytes_, limit);
  if (row_bytes_ == 0) throw H5Error("expected rows with elements, found an axis of length 0");
  check_layout();
  bounded_bytes({chunk_rows_}, row_bytes_, max_chunk_bytes);
  check_chunks(file_bytes);
}

void ArrayReader::check_layout() {
  const Handle creation(H5Dget_create_plist(dataset_), H5Pclose, "cannot read its layout");
  std::vector<hsize_t> chunk(shape_.size());
  if (H5Pget_layout(creation) != H5D_CHUNKED || H5Pget_external_count(creation) != 0 ||
      H5Pget_chunk(creation, static_cast<int>(chunk.size()), chunk.data()) !=
          static_cast<int>(chunk.size()))
    throw H5Error("expected chunked storage inside this file (h5py: chunks=...)");
  if (chunk[0] == 0 || !std::equal(chunk.begin() + 1, chunk.end(), shape_.begin() + 1))
    throw H5Error("expected chunks along the first axis only");
  chunk_rows_ = chunk[0];
  check_filters(creation);
}

void ArrayReader::check_filters(hid_t creation) {
  static const std::vector<H5Z_filter_t> order{H5Z_FILTER_SHUFFLE, H5Z_FILTER_DEFLATE,
                                               H5Z_FILTER_FLETCHER32};
  auto next = order.begin();
  const int count = H5Pget_nfilters(creation);
  for (int i = 0; i < count; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const auto filter = H5Pget_filter2(creation, static_cast<unsigned>(i), &flags, &values, nullptr,
                                       0, nullptr, &config);
    next = std::find(next, order.end(), filter);
    if (next == order.end())
      throw H5Error(
          "expected no filters other than shuffle, deflate and fletcher32, in this order");
    pipeline_.push_back(*next++);
  }
  if (pipeline_.empty() || pipeline_.back() != H5Z_FILTER_FLETCHER32)
    throw H5Error("expected fletcher32 checksums (h5py: fletcher32=True), found none");
}

void ArrayReader::check_chunks(hsize_t file_bytes) const {
  std::vector<hsize_t> offset(shape_.size(), 0);
  for (hsize_t row = 0; row < rows(); row += chunk_rows_) {
    offset[0] = row;
    hsize_t bytes = 0;  // H5Dget_chunk_info_by_coord would walk over all chunks each time
    check(H5Dget_chunk_storage_size(dataset_, offset.data(), &bytes), "cannot read its index");
    if (bytes == 0) throw H5Error(fmt::format("the chunk of row {} is missing", row));
    if (bytes > file_bytes)
      throw H5Error(fmt::format("the chunk of row {} is larger than the file", row));
  }
}

std::span<const std::uint8_t> ArrayReader::stored_chunk(hsize_t chunk,
                                                        std::uint32_t& skipped_filters) const {
  thread_local std::vector<std::uint8_t> stored;  // allocating one per image costs much of its time
  std::vector<hsize_t> offset(shape_.size(), 0);
  offset[0] = chunk * chunk_rows_;
  const LibraryLock lock;
  hsize_t bytes = 0;
  check(H5Dget_chunk_storage_size(dataset_, offset.data(), &bytes), "cannot read its index");
  stored.resize(bytes);
  check(H5Dread_chunk(dataset_, H5P_DEFAULT, offset.data(), &skipped_filters, stored.data()),
        "cannot read it");
  return stored;
}

void ArrayReader::decode(hsize_t chunk, std::span<std::uint8_t> raw) const {
  std::uint32_t skipped = 0;
  const auto stored = stored_chunk(chunk, skipped);
  ChunkFilters filters{1, false, false};
  for (std::size_t i = 0; i < pipeline_.size(); ++i) {
    if (skipped >> i & 1) continue;
    if (pipeline_[i] == H5Z_FILTER_SHUFFLE) filters.shuffle_bytes = element_bytes_;
    if (pipeline_[i] == H5Z_FILTER_DEFLATE) filters.deflate = true;
    if (pipeline_[i] == H5Z_FILTER_FLETCHER32) filters.fletcher32 = true;
  }
  const auto fault = filters.fletcher32 ? decode_chunk(stored, filters, raw)
                                        : std::optional<std::string>("it has no checksum");
  if (fault)
    throw H5Error(fmt::format("the chunk of row {} is damaged: {}", chunk * chunk_rows_, *fault));
}

void ArrayReader::read(hsize_t first, std::span<std::uint8_t> out) const {
  const std::size_t chunk_bytes = chunk_rows_ * row_bytes_;
  std::vector<std::uint8_t> raw;
  for (hsize_t row = first; !out.empty();) {
    const hsize_t chunk = row / chunk_rows_, inside = row % chunk_rows_ * row_bytes_;
    const std::size_t bytes = std::min<std::size_t>(out.size(), chunk_bytes - inside);
    if (bytes == chunk_bytes) {
      decode(chunk, out.first(bytes));
    } else {
      raw.resize(chunk_bytes);
      decode(chunk, raw);
      std::memcpy(out.data(), raw.data() + inside, bytes);
    }
    out = out.subspan(bytes);
    row += bytes / row_bytes_;
  }
}

}  // namespace touchtrace::h5
