#include "pipeline/cli/smooth_inputs.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/progress.h"

namespace touchtrace::cli {
namespace {

/// Sets the standard deviations if the file has none. Returns their source.
std::string set_sigmas(TrackFile& file, double sigma_m) {
  if (file.has_sigmas) return "file";
  const Eigen::Vector3d sigma =
      sigma_m > 0.0 ? Eigen::Vector3d::Constant(sigma_m) : estimate_white_sigma(file.track);
  if (sigma.hasNaN())
    throw data_error(fmt::format("the standard deviation of {} cannot be estimated from its {} "
                                 "samples",
                                 file.file.string(), file.track.size()),
                     "give --sigma METRES");
  for (auto& point : file.track) point.sigma_m = sigma;
  return sigma_m > 0.0 ? "option" : "data";
}

/// Skips positions that a program wrote several times, at later times, between two measurements.
void skip_held(TrackFile& file) {
  constexpr double min_held_fraction = 0.3;
  constexpr std::size_t min_samples = 20;
  Track& track = file.track;
  std::vector<bool> is_held(track.size());
  for (const auto& [first, count] : find_repeats(track))
    for (std::size_t i = first; count <= max_held_repeats && i < first + count; ++i)
      is_held[i] = track[i].time_s > track[i - 1].time_s;
  const auto held = static_cast<std::size_t>(std::ranges::count(is_held, true));
  if (track.size() < min_samples ||
      static_cast<double>(held) < min_held_fraction * static_cast<double>(track.size()))
    return;
  Progress::warn(
      fmt::format("{}: {} of {} positions repeat the one before them, as if written faster than "
                  "measured; these are skipped",
                  file.file.string(), held, track.size()));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < track.size(); ++i)
    if (!is_held[i]) track[kept++] = track[i];
  track.resize(kept);
  file.num_skipped += held;
}

}  // namespace

std::vector<RepeatedRun> find_repeats(const Track& track) {
  std::vector<RepeatedRun> runs;
  for (std::size_t i = 1; i < track.size(); ++i) {
    if (track[i].position_m != track[i - 1].position_m) continue;
    if (runs.empty() || runs.back().first + runs.back().count != i) runs.push_back({i, 0});
    ++runs.back().count;
  }
  return runs;
}

std::vector<SmoothInput> read_smooth_inputs(const std::vector<std::string>& paths,
                                            const std::vector<SmoothedFiles>& files,
                                            const TrackOptions& options, double sigma_m) {
  std::vector<SmoothInput> inputs;
  Progress progress("reading tracks", paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    TrackFile track = read_track(paths[i], options);
    skip_held(track);
    const auto source = set_sigmas(track, sigma_m);
    inputs.push_back({std::move(track), files[i], source});
    progress.advance();
  }
  return inputs;
}

}  // namespace touchtrace::cli
