#include "calib/rig/frames.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>

#include "calib/rgbd/calibrate.h"
#include "engine/base/error.h"

namespace touchtrace {
namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::string stem(const std::string& name) { return std::filesystem::path(name).stem().string(); }

/// Names of all images of a camera, sorted.
std::vector<std::string> image_names(const BoardObservations& camera) {
  std::vector<std::string> names = camera.views_without_board;
  for (const auto& view : camera.views) names.push_back(view.name);
  for (const auto& image : camera.skipped) names.push_back(image.name);
  std::ranges::sort(names);
  if (const auto twice = std::ranges::adjacent_find(names); twice != names.end())
    throw data_error(fmt::format("a camera has two images with the name {}", *twice),
                     "keep the images of a camera in one folder");
  return names;
}

/// Length of the common beginning of all texts that does not end within a number.
std::size_t common_length(const std::vector<std::string>& texts) {
  std::size_t length = texts.front().size();
  for (const auto& text : texts)
    length = std::size_t(std::ranges::mismatch(text, texts.front().substr(0, length)).in1 -
                         text.begin());
  while (length > 0 && is_digit(texts.front()[length - 1])) --length;
  return length;
}

void remove_common_beginning(std::vector<std::string>& texts) {
  const std::size_t length = common_length(texts);
  for (auto& text : texts) text.erase(0, length);
}

void reverse_all(std::vector<std::string>& texts) {
  for (auto& text : texts) std::ranges::reverse(text);
}

/// Keys of images; equal ones are one frame. Sorted by number.
struct Key {
  std::size_t length;
  std::string text;

  auto operator<=>(const Key&) const = default;
};

using KeyOfName = std::map<std::string, Key>;

KeyOfName keys_by_name(const std::vector<std::string>& names) {
  KeyOfName keys;
  if (names.empty()) return keys;
  std::vector<std::string> texts;
  for (const auto& name : names) texts.push_back(stem(name));
  remove_common_beginning(texts);
  reverse_all(texts), remove_common_beginning(texts), reverse_all(texts);
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string& text = texts[i];
    text.erase(0, std::min(text.find_first_not_of('0'), text.size()));
    keys[names[i]] = {text.size(), text};
  }
  return keys;
}

KeyOfName keys_by_order(const std::vector<std::string>& names) {
  KeyOfName keys;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string text = std::to_string(i);
    keys[names[i]] = {text.size(), text};
  }
  return keys;
}

std::vector<RigFrame> frames_by_key(const std::vector<BoardObservations>& cameras,
                                    const std::vector<std::vector<bool>>& used,
                                    const std::vector<KeyOfName>& keys) {
  std::map<Key, RigFrame> frames;
  for (std::size_t camera = 0; camera < cameras.size(); ++camera)
    for (std::size_t view = 0; view < cameras[camera].views.size(); ++view) {
      if (!used[camera][view]) continue;
      const std::string& name = cameras[camera].views[view].name;
      RigFrame& frame = frames[keys[camera].at(name)];
      frame.views.resize(cameras.size());
      frame.views[camera] = view;
      if (frame.name.empty()) frame.name = name;
    }
  std::vector<RigFrame> result;
  for (auto& [key, frame] : frames) result.push_back(std::move(frame));
  return result;
}

std::ptrdiff_t num_shared(const std::vector<RigFrame>& frames) {
  return std::ranges::count_if(frames, [](const RigFrame& f) { return f.num_views() > 1; });
}

}  // namespace

std::size_t RigFrame::num_views() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(views, [](const auto& v) { return v.has_value(); }));
}

std::vector<RigFrame> pair_frames(const std::vector<BoardObservations>& cameras,
                                  const std::vector<std::vector<bool>>& used) {
  std::vector<KeyOfName> by_name, by_order;
  for (const auto& camera : cameras) {
    const auto names = image_names(camera);
    by_name.push_back(keys_by_name(names)), by_order.push_back(keys_by_order(names));
  }
  auto frames = frames_by_key(cameras, used, by_name);
  const bool same_count = std::ranges::all_of(
      by_order, [&](const auto& keys) { return keys.size() == by_order.front().size(); });
  if (num_shared(frames) >= min_views || !same_count) return frames;
  return frames_by_key(cameras, used, by_order);
}

}  // namespace touchtrace
