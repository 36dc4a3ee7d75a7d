#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace touchtrace {

/// Message of Protocol Buffers in its wire format (protobuf.dev/programming-guides/encoding).
class ProtobufWriter {
 public:
  /// An int32, int64 or enum.
  void add(int field, std::int64_t value) {
    add_varint(std::uint64_t(field) << 3);
    add_varint(static_cast<std::uint64_t>(value));
  }
  void add(int field, float value) {
    constexpr std::uint64_t fixed32 = 5;
    add_varint(std::uint64_t(field) << 3 | fixed32);
    add_fixed(std::bit_cast<std::uint32_t>(value), 32);
  }
  void add(int field, double value) {
    constexpr std::uint64_t fixed64 = 1;
    add_varint(std::uint64_t(field) << 3 | fixed64);
    add_fixed(std::bit_cast<std::uint64_t>(value), 64);
  }
  /// Text, bytes or another message.
  void add(int field, std::string_view content) {
    constexpr std::uint64_t length_delimited = 2;
    add_varint(std::uint64_t(field) << 3 | length_delimited);
    add_varint(content.size());
    bytes_ += content;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void add_fixed(std::uint64_t bits, int size) {
    for (int shift = 0; shift < size; shift += 8) bytes_ += static_cast<char>(bits >> shift & 0xff);
  }
  void add_varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_ += static_cast<char>(value | 0x80);
    bytes_ += static_cast<char>(value);
  }

  std::string bytes_;
};

}  // namespace touchtrace
