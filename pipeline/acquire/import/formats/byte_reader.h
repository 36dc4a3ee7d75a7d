#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

namespace touchtrace {

using ByteSpan = std::span<const std::uint8_t>;

/// Reads little-endian values from untrusted bytes. Throws std::out_of_range beyond their end.
class ByteReader {
 public:
  explicit ByteReader(ByteSpan bytes) : bytes_(bytes) {}

  bool is_at_end() const { return bytes_.empty(); }

  ByteSpan take(std::size_t size) {
    if (size > bytes_.size()) throw std::out_of_range("data end early");
    const ByteSpan taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }

  template <class T>
  requires std::is_arithmetic_v<T> T number() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }

  std::string text(std::size_t size) {
    const ByteSpan taken = take(size);
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }

 private:
  ByteSpan bytes_;
};

inline ByteSpan bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Whether a path is a regular file that begins with these bytes.
inline bool begins_with(const std::filesystem::path& file, std::string_view magic) {
  std::string start(magic.size(), '\0');
  return std::filesystem::is_regular_file(file) &&
         std::ifstream(file, std::ios::binary)
             .read(start.data(), static_cast<std::streamsize>(start.size())) &&
         start == magic;
}

}  // namespace touchtrace
