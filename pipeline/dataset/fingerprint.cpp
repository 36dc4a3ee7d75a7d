#include "pipeline/dataset/fingerprint.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "engine/base/files.h"

namespace touchtrace {
namespace {

constexpr std::size_t digits = 16, stretch_frames = 10;
/// Minimum number of different frames in a stretch. At rest a glove may send equal frames, or the
/// four of two taxels that flicker, everywhere.
constexpr std::size_t min_different_frames = 5;
constexpr std::ptrdiff_t min_common_stretches = 2;
constexpr double motion_unit_m = 1e-4;

template <class T>
std::string bytes_of(std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string short_hash(const std::string& bytes) { return sha256_of(bytes).substr(0, digits); }

/// One in eight.
bool is_kept(const std::string& hash) { return hash.front() < '2'; }

/// `frames`: one text for each frame.
std::set<std::string> stretch_hashes(std::span<const std::string> frames) {
  std::set<std::string> kept;
  for (std::size_t i = 0; i + stretch_frames <= frames.size(); ++i) {
    const auto stretch = frames.subspan(i, stretch_frames);
    if (std::set(stretch.begin(), stretch.end()).size() < min_different_frames) continue;
    if (auto hash = short_hash(fmt::format("{}", fmt::join(stretch, ""))); is_kept(hash))
      kept.insert(std::move(hash));
  }
  return kept;
}

/// One text for each step, ";" where a label is not good.
std::vector<std::string> motion_frames(const Labels& labels, IndexRange of_clip) {
  const auto is_good = [&](std::size_t i) {
    return labels.hand.quality[i] == quality_good && labels.object.quality[i] == quality_good;
  };
  const auto distance = [](const LabelledBody& a, std::size_t i, const LabelledBody& b,
                           std::size_t j) {
    return std::lround(std::hypot(a.position_m[3 * i] - b.position_m[3 * j],
                                  a.position_m[3 * i + 1] - b.position_m[3 * j + 1],
                                  a.position_m[3 * i + 2] - b.position_m[3 * j + 2]) /
                       motion_unit_m);
  };
  const LabelledBody &hand = labels.hand, &object = labels.object;
  std::vector<std::string> frames;
  for (std::size_t i = of_clip.first + 1; i < of_clip.last; ++i)
    frames.push_back(is_good(i - 1) && is_good(i)
                         ? fmt::format("{},{},{};", distance(hand, i, hand, i - 1),
                                       distance(object, i, object, i - 1),
                                       distance(hand, i, object, i))
                         : ";");
  return frames;
}

}  // namespace

std::vector<std::string> touch_fingerprints(const GloveStream& glove, const Clip& clip) {
  const auto range = arrived_in(clip, glove.host_time_s);
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  const auto counts = std::span(glove.counts).subspan(range.first * taxels, range.size() * taxels);
  const auto times = std::span(glove.host_time_s).subspan(range.first, range.size());
  std::vector<std::string> result{short_hash(bytes_of(counts) + bytes_of(times))};
  std::vector<std::string> frames;
  for (std::size_t at = 0; at < counts.size(); at += taxels)
    frames.push_back(short_hash(bytes_of(counts.subspan(at, taxels))));
  std::ranges::copy(stretch_hashes(frames), std::back_inserter(result));
  return result;
}

std::vector<std::string> motion_fingerprints(const Labels& labels, IndexRange of_clip) {
  const auto hashes = stretch_hashes(motion_frames(labels, of_clip));
  return {hashes.begin(), hashes.end()};
}

bool is_known_clip(const std::vector<std::string>& fingerprints,
                   const std::vector<std::string>& known) {
  const auto is_known = [&](const std::string& hash) {
    return std::ranges::binary_search(known, hash);
  };
  return is_known(fingerprints.front()) ||
         std::ranges::count_if(fingerprints, is_known) >= min_common_stretches;
}

}  // namespace touchtrace
