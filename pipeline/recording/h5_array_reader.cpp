#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <limits>
#include <numeric>

#include "pipeline/recording/h5_array.h"

namespace touchtrace::h5 {
namespace {

constexpr hsize_t max_compression = 1032;  // of deflate
constexpr hsize_t max_chunk_bytes = 256 << 20;
constexpr int max_rank = 8;

hsize_t product(std::span<const hsize_t> extents) {
  return std::accumulate(extents.begin(), extents.end(), hsize_t{1}, std::multiplies<>());
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

/// Bytes of a chunk in the file; 0 if it was never written. H5Dget_chunk_info_by_coord() walks over
/// all chunks, H5Dget_chunk_storage_size() fails for some that were never written.
hsize_t bytes_of_chunk(hid_t dataset, const std::vector<hsize_t>& offset) {
  hsize_t bytes = 0;
  if (H5Dget_chunk_storage_size(dataset, offset.data(), &bytes) >= 0) return bytes;
  unsigned skipped_filters = 0;
  haddr_t address = 0;
  check(H5Dget_chunk_info_by_coord(dataset, offset.data(), &skipped_filters, &address, &bytes),
        "cannot read its index");
  if (address != HADDR_UNDEF) throw H5Error("cannot read its index");
  return 0;
}

}  // namespace

std::vector<hsize_t> extents_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (H5Sget_simple_extent_type(space) != H5S_SIMPLE || rank < 1 || rank > max_rank)
    throw H5Error(
        fmt::format("expected an array of 1 to {} axes, found {}", max_rank, std::max(rank, 0)));
  std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
  check(H5Sget_simple_extent_dims(space, extents.data(), nullptr), "cannot read its shape");
  return extents;
}

ArrayReader::ArrayReader(hid_t group, const std::string& name, const ElementType& type,
                         hsize_t file_bytes, Unwritten unwritten)
    : element_bytes_(type.bytes) {
  const LibraryLock lock;
  dataset_ = Handle(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, "cannot open it");
  set_type(type);
  shape_ = extents_of(Handle(H5Dget_space(dataset_), H5Sclose, "cannot read its shape"));
  row_elements_ =
      bounded_bytes({shape_.begin() + 1, shape_.end()}, 1, file_bytes * max_compression);
  if (row_elements_ == 0) throw H5Error("expected rows with elements, found an axis of length 0");
  check_layout(file_bytes, unwritten);
}

void ArrayReader::set_type(const ElementType& type) {
  const Handle found(H5Dget_type(dataset_), H5Tclose, "cannot read its type");
  stored_bytes_ = H5Tget_size(found);
  if (H5Tequal(found, type.type) > 0) return;
  if (type.find_conversion == nullptr)
    throw H5Error(fmt::format("expected {}, found {}", type_name(type.type), type_name(found)));
  convert_ = type.find_conversion(found);
}

void ArrayReader::check_layout(hsize_t file_bytes, Unwritten unwritten) {
  const Handle creation(H5Dget_create_plist(dataset_), H5Pclose, "cannot read its layout");
  const auto layout = H5Pget_layout(creation);
  if (layout == H5D_VIRTUAL || H5Pget_external_count(creation) != 0)
    throw H5Error("expected values in this file, found a reference to another file");
  if (layout != H5D_CHUNKED) {
    bounded_bytes(shape_, stored_bytes_, file_bytes);
    return check_contiguous();
  }
  chunk_.resize(shape_.size());
  const int rank = static_cast<int>(chunk_.size());
  if (H5Pget_chunk(creation, rank, chunk_.data()) != rank || std::ranges::count(chunk_, 0u) != 0)
    throw H5Error("expected chunks of as many axes as the dataset");
  bounded_bytes(shape_, std::max(stored_bytes_, element_bytes_), file_bytes * max_compression);
  chunk_bytes_ = bounded_bytes(chunk_, stored_bytes_, max_chunk_bytes);
  check_filters(creation);
  check_chunks(file_bytes, unwritten);
}

void ArrayReader::check_contiguous() const {
  if (H5Dget_storage_size(dataset_) < product(shape_) * stored_bytes_)
    throw H5Error("expected values, found none (was the dataset created but never written?)");
}

void ArrayReader::check_filters(hid_t creation) {
  static const std::vector<H5Z_filter_t> order{H5Z_FILTER_SHUFFLE, H5Z_FILTER_DEFLATE,
                                               H5Z_FILTER_FLETCHER32};
  auto next = order.begin();
  const int count = H5Pget_nfilters(creation);
  for (int i = 0; i < count; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    std::array<char, 64> name{};
    const auto filter = H5Pget_filter2(creation, static_cast<unsigned>(i), &flags, &values, nullptr,
                                       name.size() - 1, name.data(), &config);
    next = std::find(next, order.end(), filter);
    if (next == order.end())
      throw H5Error(
          fmt::format("expected no filters other than shuffle, deflate (gzip) and "
                      "fletcher32, in this order, found '{}' ({})",
                      name.data(), filter));
    pipeline_.push_back(*next++);
  }
}

bool ArrayReader::next_chunk(Extents& offset) const {
  for (std::size_t axis = offset.size() - 1; axis > 0; --axis) {
    offset[axis] += chunk_[axis];
    if (offset[axis] < shape_[axis]) return true;
    offset[axis] = 0;
  }
  return false;
}

void ArrayReader::check_chunks(hsize_t file_bytes, Unwritten unwritten) const {
  Extents offset(shape_.size(), 0);
  for (; offset[0] < rows(); offset[0] += chunk_[0]) do {
      const hsize_t bytes = bytes_of_chunk(dataset_, offset);
      if (bytes == 0 && unwritten == Unwritten::faults)
        throw H5Error(fmt::format("the chunk of row {} is missing", offset[0]));
      if (bytes > file_bytes)
        throw H5Error(fmt::format("the chunk of row {} is larger than the file", offset[0]));
    } while (next_chunk(offset));
}

std::span<const std::uint8_t> ArrayReader::stored_chunk(const Extents& offset,
                                                        std::uint32_t& skipped_filters) const {
  thread_local std::vector<std::uint8_t> stored;  // allocating one per image costs much of its time
  const LibraryLock lock;
  const hsize_t bytes = bytes_of_chunk(dataset_, offset);
  if (bytes == 0) return {};
  stored.resize(bytes);
  check(H5Dread_chunk(dataset_, H5P_DEFAULT, offset.data(), &skipped_filters, stored.data()),
        "cannot read it");
  return stored;
}

void ArrayReader::decode(const Extents& offset, std::span<std::uint8_t> raw) const {
  std::uint32_t skipped = 0;
  const auto stored = stored_chunk(offset, skipped);
  if (stored.empty()) {
    std::ranges::fill(raw, std::uint8_t{0});
    return;
  }
  ChunkFilters filters{1, false, false};
  bool checksum_skipped = false;
  for (std::size_t i = 0; i < pipeline_.size(); ++i) {
    const bool applied = (skipped >> i & 1) == 0;
    if (pipeline_[i] == H5Z_FILTER_SHUFFLE && applied) filters.shuffle_bytes = stored_bytes_;
    if (pipeline_[i] == H5Z_FILTER_DEFLATE) filters.deflate = applied;
    if (pipeline_[i] == H5Z_FILTER_FLETCHER32)
      filters.fletcher32 = applied, checksum_skipped = !applied;
  }
  const auto fault = checksum_skipped ? std::optional<std::string>("it has no checksum")
                                      : decode_chunk(stored, filters, raw);
  if (fault) throw H5Error(fmt::format("the chunk of row {} is damaged: {}", offset[0], *fault));
}

void ArrayReader::copy(const Extents& offset, hsize_t first, hsize_t last, std::size_t axis,
                       const std::uint8_t* chunk, std::uint8_t* array) const {
  const hsize_t origin = axis == 0 ? first : 0;
  const hsize_t begin = std::max(offset[axis], origin),
                end = std::min(offset[axis] + chunk_[axis], axis == 0 ? last : shape_[axis]);
  const auto below = [&](const Extents& shape) {
    return product(std::span(shape).subspan(axis + 1)) * stored_bytes_;
  };
  const hsize_t array_stride = below(shape_), chunk_stride = below(chunk_);
  array += (begin - origin) * array_stride;
  chunk += (begin - offset[axis]) * chunk_stride;
  if (axis + 1 == shape_.size()) {
    std::memcpy(array, chunk, (end - begin) * stored_bytes_);
    return;
  }
  for (hsize_t i = begin; i < end; ++i, array += array_stride, chunk += chunk_stride)
    copy(offset, first, last, axis + 1, chunk, array);
}

void ArrayReader::read_chunk(const Extents& offset, hsize_t first,
                             std::span<std::uint8_t> out) const {
  const hsize_t row_bytes = row_elements_ * stored_bytes_, last = first + out.size() / row_bytes;
  const bool has_whole_rows = chunk_bytes_ == chunk_[0] * row_bytes;
  if (has_whole_rows && offset[0] >= first && offset[0] + chunk_[0] <= last)
    return decode(offset, out.subspan((offset[0] - first) * row_bytes, chunk_bytes_));
  thread_local std::vector<std::uint8_t> raw;
  raw.resize(chunk_bytes_);
  decode(offset, raw);
  copy(offset, first, last, 0, raw.data(), out.data());
}

void ArrayReader::read_contiguous(hsize_t first, std::span<std::uint8_t> out) const {
  Extents start(shape_.size(), 0), count = shape_;
  start[0] = first;
  count[0] = out.size() / (row_elements_ * stored_bytes_);
  const LibraryLock lock;
  const Handle type(H5Dget_type(dataset_), H5Tclose, "cannot read its type");
  const Handle space(H5Dget_space(dataset_), H5Sclose, "cannot read its shape");
  const Handle memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                      H5Sclose, "cannot read it");
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
        "cannot read it");
  check(H5Dread(dataset_, type, memory, space, H5P_DEFAULT, out.data()), "cannot read it");
}

void ArrayReader::read_stored(hsize_t first, std::span<std::uint8_t> out) const {
  if (out.empty()) return;
  if (chunk_.empty()) return read_contiguous(first, out);
  const hsize_t last = first + out.size() / (row_elements_ * stored_bytes_);
  Extents offset(shape_.size(), 0);
  for (offset[0] = first / chunk_[0] * chunk_[0]; offset[0] < last; offset[0] += chunk_[0]) do
      read_chunk(offset, first, out);
    while (next_chunk(offset));
}

void ArrayReader::read(hsize_t first, std::span<std::uint8_t> out) const {
  if (convert_ == nullptr) return read_stored(first, out);
  std::vector<std::uint8_t> stored(out.size() / element_bytes_ * stored_bytes_);
  read_stored(first, stored);
  convert_(stored, out);
}

}  // namespace touchtrace::h5
