#include "pipeline/acquire/glove/packet_parser.h"

#include <algorithm>

namespace touchtrace {

PacketParser::PacketParser(const GloveInfo& info, FrameSink sink, std::size_t packet_bytes,
                           std::uint64_t modulus, std::size_t lookahead_bytes)
    : GloveParser(info, std::move(sink)),
      length_(packet_bytes),
      lookahead_(lookahead_bytes),
      modulus_(modulus),
      buffer_(4 * packet_bytes),
      needed_(packet_bytes + lookahead_bytes) {}

void PacketParser::feed(std::span<const std::uint8_t> bytes, double host_time_s) {
  for (const std::uint8_t byte : bytes) {
    if (end_ == buffer_.size()) {
      std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), buffer_.end(),
                buffer_.begin());
      end_ -= std::exchange(begin_, 0);
    }
    buffer_[end_++] = byte;
    if (end_ - begin_ == length_) head_time_s_ = host_time_s;
    if (end_ - begin_ == needed_) scan(host_time_s);
  }
}

void PacketParser::finish(double host_time_s) {
  if (lookahead_ == 0 || end_ - begin_ != length_) return;
  const auto start = buffer_.begin() + static_cast<std::ptrdiff_t>(begin_);
  const std::vector<std::uint8_t> behind(start, start + static_cast<std::ptrdiff_t>(lookahead_));
  feed(behind, host_time_s);
}

/// True if the packet behind the one with `number` shows that packets were lost, not that
/// `number` is wrong.
bool PacketParser::confirms(std::uint64_t number, std::uint64_t next) const {
  constexpr std::uint64_t max_advance = 16;
  const std::uint64_t step = advance(number, next);
  if (step == 0 || step > max_advance) return false;
  if (!last_number_) return true;
  const std::uint64_t gap = advance(*last_number_, number);
  return gap > 0 && gap + step == advance(*last_number_, next);
}

/// Decides about the packets at the start of the buffer while there are enough bytes.
void PacketParser::scan(double host_time_s) {
  needed_ = length_ + lookahead_;
  while (end_ - begin_ >= needed_) {
    const auto number = number_of(&buffer_[begin_]);
    bool is_accepted =
        number && (modulus_ == 1 || (last_number_ && advance(*last_number_, *number) == 1));
    if (number && !is_accepted) {
      needed_ = 2 * length_ + lookahead_;
      if (end_ - begin_ < needed_) return;
      const auto next = number_of(&buffer_[begin_ + length_]);
      is_accepted = next && confirms(*number, *next);
    }
    needed_ = length_ + lookahead_;
    if (is_accepted) take(*number);
    if (!is_accepted) ++skipped_, count_skipped(1);
    remove(is_accepted ? length_ : 1, host_time_s);
  }
}

void PacketParser::take(std::uint64_t number) {
  const std::uint64_t step = last_number_ ? advance(*last_number_, number) : 0;
  accept({&buffer_[begin_], number, step, std::exchange(skipped_, 0), head_time_s_});
  last_number_ = number;
}

void PacketParser::remove(std::size_t bytes, double host_time_s) {
  begin_ += bytes;
  if (end_ - begin_ >= length_) head_time_s_ = host_time_s;
}

}  // namespace touchtrace
