#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace touchtrace {

/// Line of decimal counts that are separated by tabs or blanks, read byte by byte.
class CountLine {
 public:
  CountLine(std::size_t max_counts, std::uint16_t max_count)
      : counts_(max_counts), max_count_(max_count) {}

  /// Returns true at the end of a line; then clear() must be called before the next byte.
  bool put(std::uint8_t byte);
  void clear() { *this = CountLine(std::move(counts_), max_count_); }

  /// False after another character, a leading zero, or a count that is too large.
  bool is_valid() const { return is_valid_; }
  std::uint64_t largest() const { return largest_; }
  std::size_t size() const { return size_; }  ///< also beyond the maximum
  std::size_t bytes() const { return bytes_; }
  bool is_blank() const { return is_valid_ && size_ == 0; }
  /// All counts of a line that is valid and has exactly the maximum number of them; else empty.
  std::span<const std::uint16_t> complete() const {
    if (!is_valid_ || size_ != counts_.size()) return {};
    return counts_;
  }

 private:
  CountLine(std::vector<std::uint16_t>&& counts, std::uint16_t max_count)
      : counts_(std::move(counts)), max_count_(max_count) {}
  void put_digit(unsigned digit);
  void end_number();

  std::vector<std::uint16_t> counts_;
  std::uint16_t max_count_;
  std::size_t size_ = 0, bytes_ = 0;
  unsigned value_ = 0, largest_ = 0;  ///< of the current number; of the line
  bool in_number_ = false, is_valid_ = true;
};

}  // namespace touchtrace
