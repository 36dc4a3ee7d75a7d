#include "pipeline/acquire/import/lz4.h"

#include <algorithm>
#include <stdexcept>

namespace touchtrace {
namespace {

constexpr std::uint32_t frame_magic = 0x184D2204;
constexpr std::uint32_t is_stored = 1u << 31;
constexpr std::size_t min_match = 4;
constexpr std::size_t max_ratio = 255;

/// Output of known size.
class Output {
 public:
  explicit Output(std::size_t size) : size_(size) { bytes_.reserve(size); }

  void append(ByteSpan literals) {
    require_room(literals.size());
    bytes_.insert(bytes_.end(), literals.begin(), literals.end());
  }
  /// Appends bytes from `offset` before the end; they may overlap with the appended ones.
  void repeat(std::size_t offset, std::size_t length) {
    if (offset == 0 || offset > bytes_.size())
      throw std::runtime_error("LZ4 data refer to bytes before their start");
    require_room(length);
    for (std::size_t from = bytes_.size() - offset; length > 0; --length)
      bytes_.push_back(bytes_[from++]);
  }
  std::vector<std::uint8_t> finish() && {
    if (bytes_.size() != size_) throw std::runtime_error("LZ4 data end early");
    return std::move(bytes_);
  }

 private:
  void require_room(std::size_t length) const {
    if (length > size_ - bytes_.size()) throw std::runtime_error("LZ4 data are too long");
  }

  std::size_t size_;
  std::vector<std::uint8_t> bytes_;
};

/// Length of a sequence: 4 bits of its token, and further bytes if these are all ones.
std::size_t read_length(ByteReader& reader, std::size_t nibble) {
  std::size_t length = nibble;
  if (nibble == 15)
    for (std::uint8_t more = 255; more == 255; length += more) more = reader.number<std::uint8_t>();
  return length;
}

void decode_block(ByteSpan block, Output& output) {
  ByteReader reader(block);
  while (!reader.is_at_end()) {
    const auto token = reader.number<std::uint8_t>();
    output.append(reader.take(read_length(reader, token >> 4)));
    if (reader.is_at_end()) return;  // the last sequence has no match
    const auto offset = reader.number<std::uint16_t>();
    output.repeat(offset, min_match + read_length(reader, token & 15));
  }
}

/// Flags of the frame's header, which is skipped.
std::uint8_t read_header(ByteReader& reader) {
  if (reader.number<std::uint32_t>() != frame_magic) throw std::runtime_error("not an LZ4 frame");
  const auto flags = reader.number<std::uint8_t>();
  reader.take(1u + (flags & 0x08 ? 8 : 0) + (flags & 0x01 ? 4 : 0) + 1u);
  return flags;
}

}  // namespace

std::vector<std::uint8_t> decode_lz4_frame(ByteSpan frame, std::size_t size) {
  if (size / max_ratio > frame.size()) throw std::runtime_error("LZ4 data state a wrong size");
  ByteReader reader(frame);
  const auto flags = read_header(reader);
  Output output(size);
  while (const auto block_size = reader.number<std::uint32_t>()) {
    const ByteSpan block = reader.take(block_size & ~is_stored);
    if (block_size & is_stored)
      output.append(block);
    else
      decode_block(block, output);
    if (flags & 0x10) reader.take(4);  // checksum of the block
  }
  return std::move(output).finish();
}

}  // namespace touchtrace
