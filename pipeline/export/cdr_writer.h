#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "pipeline/export/byte_writer.h"

namespace touchtrace {

/// Serializes a ROS 2 message as CDR with the low byte first (OMG DDSI-RTPS 9.3.2 and 10.5): a
/// header of 4 bytes, then the members in order, each number at a multiple of its size from the
/// header's end.
class CdrWriter {
 public:
  template <class Number>
  void add(Number number) {
    align(sizeof number);
    append_number(bytes_, number);
  }
  void add(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    bytes_ += text;
    bytes_ += '\0';
  }
  /// Array of fixed length.
  void add_array(std::span<const double> numbers) {
    for (const double number : numbers) add(number);
  }
  /// Array of variable length.
  void add_sequence(std::span<const double> numbers) {
    add(static_cast<std::uint32_t>(numbers.size()));
    add_array(numbers);
  }
  void add_byte_sequence(std::span<const std::uint8_t> bytes) {
    add(static_cast<std::uint32_t>(bytes.size()));
    bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  const std::string& bytes() const { return bytes_; }

 private:
  static constexpr std::size_t header_bytes = 4;

  void align(std::size_t size) {
    while ((bytes_.size() - header_bytes) % size != 0) bytes_ += '\0';
  }

  std::string bytes_ = std::string("\0\1\0\0", header_bytes);
};

}  // namespace touchtrace
