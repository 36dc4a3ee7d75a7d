#include "pipeline/acquire/import/formats/name_words.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <string>

#include "engine/base/text.h"

namespace touchtrace {
namespace {

bool contains_any(std::string_view name, std::initializer_list<const char*> parts) {
  const std::string lower = lower_case(name);
  return std::ranges::any_of(
      parts, [&](const char* part) { return lower.find(part) != std::string::npos; });
}

/// Whether letters of a name form one of the words, between other characters: "ir" in "ir_0001".
bool has_word(std::string_view name, std::initializer_list<std::string_view> words) {
  const std::string lower = lower_case(name);
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  for (auto at = lower.begin(); at != lower.end();) {
    const auto first = std::find_if(at, lower.end(), is_letter);
    at = std::find_if_not(first, lower.end(), is_letter);
    if (std::ranges::find(words, std::string_view(first, at)) != words.end()) return true;
  }
  return false;
}

}  // namespace

bool names_depth(std::string_view name) {
  return contains_any(name, {"depth"}) || has_word(name, {"dpt"});
}

bool names_registered_depth(std::string_view name) {
  return names_depth(name) && contains_any(name, {"align", "regist", "to_color", "to_rgb"});
}

bool names_color(std::string_view name) {
  return !names_depth(name) && contains_any(name, {"rgb", "color", "colour", "image", "frame"});
}

bool names_other_image(std::string_view name) {
  return contains_any(name, {"mask", "label", "normal", "segment", "annotat", "infra", "confidence",
                             "colormap", "preview", "overlay", "pose"}) ||
         has_word(name, {"ir", "seg", "vis", "conf"});
}

}  // namespace touchtrace
