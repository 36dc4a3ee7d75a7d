#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "pipeline/acquire/glove/protocol.h"

namespace touchtrace {
namespace {

/// Line of decimal counts that are separated by tabs or blanks, read byte by byte.
class CountLine {
 public:
  CountLine(std::size_t max_counts, std::uint16_t max_count)
      : counts_(max_counts), max_count_(max_count) {}

  /// Returns true at the end of a line; then clear() must be called before the next byte.
  bool put(std::uint8_t byte) {
    ++bytes_;
    if (byte >= '0' && byte <= '9') {
      put_digit(byte - unsigned{'0'});
      return false;
    }
    end_number();
    is_valid_ &=
        std::string_view(" \t,;\r\n").find(static_cast<char>(byte)) != std::string_view::npos;
    return byte == '\n';
  }
  void clear() {
    size_ = bytes_ = 0;
    value_ = largest_ = 0;
    in_number_ = false, is_valid_ = true;
  }

  std::uint64_t largest() const { return largest_; }
  std::size_t size() const { return size_; }  ///< also beyond the maximum
  std::size_t bytes() const { return bytes_; }
  bool is_blank() const { return is_valid_ && size_ == 0; }
  /// All counts of a line without another character, a leading zero, or a count that is too large,
  /// if it has exactly the maximum number of them; else empty.
  std::span<const std::uint16_t> complete() const {
    if (!is_valid_ || size_ != counts_.size()) return {};
    return counts_;
  }

 private:
  void put_digit(unsigned digit) {
    if (in_number_ && value_ == 0) is_valid_ = false;
    value_ = in_number_ ? 10 * value_ + digit : digit;
    in_number_ = true;
    largest_ = std::max(largest_, value_);
    if (value_ > max_count_) is_valid_ = false, value_ = max_count_;
  }
  void end_number() {
    if (!in_number_) return;
    if (size_ < counts_.size()) counts_[size_] = static_cast<std::uint16_t>(value_);
    ++size_;
    in_number_ = false;
  }

  std::vector<std::uint16_t> counts_;
  std::uint16_t max_count_;
  std::size_t size_ = 0, bytes_ = 0;
  unsigned value_ = 0, largest_ = 0;  ///< of the current number; of the line
  bool in_number_ = false, is_valid_ = true;
};

/// Parser of frames of `lines` lines of text. A frame of several lines ends with a blank one. The
/// first frame may lack its start, which cannot be seen. It is never passed on.
class TextParser : public GloveParser {
 public:
  TextParser(const GloveInfo& info, FrameSink sink, std::size_t lines, bool ends_with_blank)
      : GloveParser(info, std::move(sink)),
        lines_(lines),
        ends_with_blank_(ends_with_blank),
        line_(taxels() / lines, max_count()),
        frame_(taxels()) {}

  void feed(std::span<const std::uint8_t> bytes, double host_time_s) override {
    for (const std::uint8_t byte : bytes) {
      if (!line_.put(byte)) continue;
      const bool is_separator = ends_with_blank_ && line_.is_blank();
      if (!is_separator) end_line();
      if (is_separator || !ends_with_blank_) end_frame(host_time_s);
      line_.clear();
    }
  }

 private:
  void end_line() {
    const auto counts = line_.complete();
    is_valid_ &= !counts.empty();
    if (is_synchronized_) is_in_range(line_.largest());
    if (is_valid_ && num_lines_ < lines_)
      std::ranges::copy(counts,
                        frame_.begin() + static_cast<std::ptrdiff_t>(num_lines_ * counts.size()));
    ++num_lines_;
    num_counts_ += line_.size(), num_bytes_ += line_.bytes();
  }

  void end_frame(double host_time_s) {
    const std::size_t lines = std::exchange(num_lines_, 0), counts = std::exchange(num_counts_, 0),
                      bytes = std::exchange(num_bytes_, 0);
    const bool is_valid = std::exchange(is_valid_, true);
    if (!std::exchange(is_synchronized_, true) || lines == 0) return;
    if (is_valid && lines == lines_) return pass_on(number_++, frame_, host_time_s);
    const std::size_t frames = std::max<std::size_t>(1, (counts + taxels() / 2) / taxels());
    count_torn(frames), count_skipped(bytes);
    number_ += frames;
  }

  std::size_t lines_;
  bool ends_with_blank_;
  CountLine line_;
  std::vector<std::uint16_t> frame_;
  std::size_t num_lines_ = 0, num_counts_ = 0, num_bytes_ = 0;  ///< of the current frame
  bool is_valid_ = true, is_synchronized_ = false;
  std::uint64_t number_ = 0;
};

/// Counts of a frame, each with `separator` behind it, the last one of a line with "\n".
std::string encode_lines(const GloveStream& glove, std::size_t frame, std::size_t line_counts,
                         char separator) {
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  std::string text;
  for (std::size_t i = 0; i < taxels; ++i)
    text += fmt::format("{}{}", glove.counts[frame * taxels + i],
                        (i + 1) % line_counts ? separator : '\n');
  return text;
}

}  // namespace

/// Decimal counts separated by tabs, "\n" at the end. Source: firmware of ETH's replica of STAG
/// (STM32F769).
std::string encode_stag(const GloveStream& glove, std::size_t frame) {
  return encode_lines(glove, frame, static_cast<std::size_t>(glove.info.taxels()), '\t');
}

std::unique_ptr<GloveParser> parse_stag(const GloveInfo& info, FrameSink sink) {
  return std::make_unique<TextParser>(info, std::move(sink), 1, false);
}

/// One line of decimal counts per row, a blank line behind the last one. Source: 3D-ViTac (Huang et
/// al. 2024).
std::string encode_vitac(const GloveStream& glove, std::size_t frame) {
  return encode_lines(glove, frame, static_cast<std::size_t>(glove.info.cols), ' ') + '\n';
}

std::unique_ptr<GloveParser> parse_vitac(const GloveInfo& info, FrameSink sink) {
  return std::make_unique<TextParser>(info, std::move(sink), static_cast<std::size_t>(info.rows),
                                      true);
}

}  // namespace touchtrace
