#include "pipeline/dataset/fingerprint.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <span>

#include "engine/base/files.h"
#include "pipeline/recording/clip_range.h"

namespace touchtrace {
namespace {

constexpr std::size_t digits = 16, stretch_frames = 10;
/// Minimum number of different frames in a stretch. At rest a glove may send equal frames, or the
/// four of two taxels that flicker, everywhere.
constexpr std::size_t min_different_frames = 5;
constexpr std::ptrdiff_t min_common_stretches = 2;

template <class T>
std::string bytes_of(std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string short_hash(const std::string& bytes) { return sha256_of(bytes).substr(0, digits); }

/// One in eight.
bool is_kept(const std::string& hash) { return hash.front() < '2'; }

std::set<std::string> stretch_hashes(std::span<const std::uint16_t> counts, std::size_t taxels) {
  std::vector<std::string> frames;
  for (std::size_t at = 0; at < counts.size(); at += taxels)
    frames.push_back(short_hash(bytes_of(counts.subspan(at, taxels))));
  std::set<std::string> kept;
  for (std::size_t i = 0; i + stretch_frames <= frames.size(); ++i) {
    const auto stretch = std::span(frames).subspan(i, stretch_frames);
    if (std::set(stretch.begin(), stretch.end()).size() < min_different_frames) continue;
    if (auto hash = short_hash(fmt::format("{}", fmt::join(stretch, ""))); is_kept(hash))
      kept.insert(std::move(hash));
  }
  return kept;
}

}  // namespace

std::vector<std::string> clip_fingerprints(const GloveStream& glove, const Clip& clip) {
  const auto range = arrived_in(clip, glove.host_time_s);
  const auto taxels = static_cast<std::size_t>(glove.info.taxels());
  const auto counts = std::span(glove.counts).subspan(range.first * taxels, range.size() * taxels);
  const auto times = std::span(glove.host_time_s).subspan(range.first, range.size());
  std::vector<std::string> result{short_hash(bytes_of(counts) + bytes_of(times))};
  std::ranges::copy(stretch_hashes(counts, taxels), std::back_inserter(result));
  return result;
}

bool is_known_touch(const std::vector<std::string>& fingerprints,
                    const std::vector<std::string>& known) {
  const auto is_known = [&](const std::string& hash) {
    return std::ranges::binary_search(known, hash);
  };
  return is_known(fingerprints.front()) ||
         std::ranges::count_if(fingerprints, is_known) >= min_common_stretches;
}

}  // namespace touchtrace
