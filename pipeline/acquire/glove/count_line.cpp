#include "pipeline/acquire/glove/count_line.h"

#include <algorithm>
#include <string_view>

namespace touchtrace {

bool CountLine::put(std::uint8_t byte) {
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

void CountLine::put_digit(unsigned digit) {
  if (in_number_ && value_ == 0) is_valid_ = false;
  value_ = in_number_ ? 10 * value_ + digit : digit;
  in_number_ = true;
  largest_ = std::max(largest_, value_);
  if (value_ > max_count_) is_valid_ = false, value_ = max_count_;
}

void CountLine::end_number() {
  if (!in_number_) return;
  if (size_ < counts_.size()) counts_[size_] = static_cast<std::uint16_t>(value_);
  ++size_;
  in_number_ = false;
}

}  // namespace touchtrace
