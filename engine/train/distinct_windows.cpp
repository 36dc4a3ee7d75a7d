#include "engine/train/distinct_windows.h"

#include <string_view>
#include <unordered_map>

namespace touchtrace {
namespace {

template <class T>
std::string_view bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

/// Assigns equal keys equal numbers, counting from 0 in the order of appearance.
class Numbering {
 public:
  std::int32_t operator()(std::string_view key) {
    return numbers_.emplace(key, static_cast<std::int32_t>(numbers_.size())).first->second;
  }

 private:
  std::unordered_map<std::string_view, std::int32_t> numbers_;
};

/// A number for each frame; equal frames have equal numbers.
std::vector<std::int32_t> contents_of(std::span<const float> stream, std::size_t frame_size) {
  Numbering numbering;
  std::vector<std::int32_t> contents;
  for (std::size_t at = 0; at + frame_size <= stream.size(); at += frame_size)
    contents.push_back(numbering(bytes_of(stream.subspan(at, frame_size))));
  return contents;
}

}  // namespace

DistinctWindows distinct_windows(std::span<const float> stream, const TactileWindowShape& shape,
                                 std::span<const std::int32_t> window_end) {
  const auto contents = contents_of(stream, std::size_t(shape.rows) * shape.cols);
  const auto frames = static_cast<std::size_t>(shape.frames);
  Numbering numbering;
  DistinctWindows windows;
  for (const auto last : window_end) {
    const auto window = std::span(contents).subspan(last + 1 - frames, frames);
    windows.row.push_back(numbering(bytes_of(std::span<const std::int32_t>(window))));
    if (windows.row.back() == std::ssize(windows.window_end)) windows.window_end.push_back(last);
  }
  return windows;
}

}  // namespace touchtrace
