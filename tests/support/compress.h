#pragma once

#include <bzlib.h>
#include <lz4frame.h>

#include <string>

namespace touchtrace::testing {

inline std::string lz4(const std::string& bytes) {
  std::string frame(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  frame.resize(LZ4F_compressFrame(frame.data(), frame.size(), bytes.data(), bytes.size(), nullptr));
  return frame;
}

inline std::string bz2(std::string bytes) {
  auto size = static_cast<unsigned>(bytes.size() + bytes.size() / 100 + 600);
  std::string compressed(size, '\0');
  BZ2_bzBuffToBuffCompress(compressed.data(), &size, bytes.data(),
                           static_cast<unsigned>(bytes.size()), 9, 0, 0);
  compressed.resize(size);
  return compressed;
}

}  // namespace touchtrace::testing
