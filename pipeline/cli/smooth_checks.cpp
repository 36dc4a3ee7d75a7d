#include "pipeline/cli/smooth_checks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "calib/smooth/find_flights.h"
#include "engine/base/progress.h"
#include "engine/base/statistics.h"

namespace touchtrace::cli {
namespace {

constexpr double max_speed_m_per_s = 100.0;  // of half of a hand's, tool's or ball's positions
constexpr double max_distance_m = 20.0;      // of a motion capture volume
/// Between what motion and correlated errors make of correct standard deviations (recorded hands,
/// tools and balls at 20 and 60 Hz: 0.1 to 13) and millimetres in place of metres.
constexpr double max_sigma_ratio = 30.0;
constexpr double earth_m_per_s2 = 9.81, max_gravity_error = 0.05;
constexpr double max_repeated_times = 0.1;   ///< of the samples
constexpr double max_flight_error_s = 0.06;  // of the times of named flights
constexpr double min_slow_step_s = 1.0, max_gap_s = 3600.0;

double median_speed(const Track& track) {
  std::vector<double> speeds;
  for (std::size_t i = 1; i < track.size(); ++i)
    if (const double step_s = track[i].time_s - track[i - 1].time_s; step_s > 0.0)
      speeds.push_back((track[i].position_m - track[i - 1].position_m).norm() / step_s);
  return speeds.empty() ? 0.0 : median(std::move(speeds));
}

/// Smallest and largest ratio over the axes of white errors, estimated from neighbouring positions,
/// to the stated median standard deviation.
struct SigmaRatio {
  double min, max;
};

SigmaRatio sigma_ratio(const Track& track) {
  const Eigen::Vector3d scatter_m = estimate_white_sigma(track);
  Eigen::Vector3d ratio;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> stated_m;
    for (const auto& point : track) stated_m.push_back(point.sigma_m[axis]);
    ratio[axis] = scatter_m[axis] / median(std::move(stated_m));
  }
  return {ratio.minCoeff(), ratio.maxCoeff()};
}

void warn_of_sigma(const SmoothInput& input) {
  const auto [min, max] = sigma_ratio(input.track.track);  // NaN if there are too few samples
  if (!(min > max_sigma_ratio) && !(max < 1.0 / max_sigma_ratio)) return;
  Progress::warn(fmt::format(
      "{}: neighbouring positions scatter by {:.2g} times their stated standard deviation; hint: "
      "give it and the positions in metres, or name the columns x_mm, y_mm, z_mm",
      input.track.file.string(), min > 1.0 ? min : max));
}

/// Number of positions that repeat the one before them too often to be held between measurements.
std::size_t count_repeats(const Track& track) {
  std::size_t count = 0;
  for (const RepeatedRun& run : find_repeats(track))
    if (run.count > max_held_repeats) count += run.count;
  return count;
}

double median_distance_m(const Track& track) {
  std::vector<double> distances_m;
  for (const auto& point : track) distances_m.push_back(point.position_m.norm());
  return median(std::move(distances_m));
}

void warn_of_times(const Track& track, const std::string& file) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < track.size(); ++i)
    steps_s.push_back(track[i].time_s - track[i - 1].time_s);
  if (steps_s.empty()) return;
  const auto repeated = static_cast<std::size_t>(std::ranges::count(steps_s, 0.0));
  const double largest_s = std::ranges::max(steps_s), typical_s = median(std::move(steps_s));
  if (static_cast<double>(repeated) > max_repeated_times * static_cast<double>(track.size()))
    Progress::warn(fmt::format(
        "{}: {} of {} samples have the time of the one before them; hint: check which column has "
        "the times, and rows that are in the file twice",
        file, repeated, track.size()));
  if (typical_s >= min_slow_step_s)
    Progress::warn(fmt::format(
        "{}: samples are {:g} s apart; hint: name times in milliseconds time_ms, and divide frame "
        "numbers by the rate",
        file, typical_s));
  else if (largest_s > max_gap_s)
    Progress::warn(fmt::format("{}: a gap of {:.3g} s between samples; hint: check the time stamps",
                               file, largest_s));
}

std::string text_of(const Eigen::Vector3d& v) {
  return fmt::format("{:g} {:g} {:g}", v.x(), v.y(), v.z());
}

std::size_t count_flights(const std::vector<SmoothInput>& inputs, const Eigen::Vector3d& gravity) {
  std::size_t count = 0;
  for (const auto& input : inputs) count += find_flights(input.track.track, gravity).size();
  return count;
}

void warn_of_axis(const Eigen::Vector3d& gravity, const std::vector<SmoothInput>& inputs) {
  Eigen::Vector3d best = gravity;
  std::size_t most = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (const double size : {-earth_m_per_s2, earth_m_per_s2}) {
      const Eigen::Vector3d candidate = size * Eigen::Vector3d::Unit(axis);
      if (const auto count = count_flights(inputs, candidate); count > most)
        most = count, best = candidate;
    }
  if (most > 0 && best.normalized().dot(gravity.normalized()) < 0.9)
    Progress::warn(
        fmt::format("no flight accelerates by --gravity {}, {} by {}; hint: check the "
                    "direction of gravity in the track's frame",
                    text_of(gravity), most, text_of(best)));
}

}  // namespace

void warn_of_implausible(const SmoothInput& input) {
  const Track& track = input.track.track;
  const auto file = input.track.file.string();
  warn_of_times(track, file);
  if (const double speed = median_speed(track); speed > max_speed_m_per_s)
    Progress::warn(
        fmt::format("{}: half of the positions move faster than {:.2g} m/s; hint: if "
                    "they are in millimetres, name the columns x_mm, y_mm, z_mm",
                    file, speed));
  else if (const double distance_m = median_distance_m(track); distance_m > max_distance_m)
    Progress::warn(
        fmt::format("{}: half of the positions are over {:.3g} m from the origin; hint: if they "
                    "are in millimetres, name the columns x_mm, y_mm, z_mm",
                    file, distance_m));
  else if (input.sigma_source != "data")
    warn_of_sigma(input);
  if (const auto repeats = count_repeats(track); repeats > 0 && repeats + 1 < track.size())
    Progress::warn(fmt::format(
        "{}: {} of {} positions repeat the one before them; hint: if the tracker holds its last "
        "value while it sees nothing, leave x, y and z of these rows empty",
        file, repeats, track.size()));
}

void warn_of_moved_flights(const TrackFile& file, const std::vector<Flight>& named,
                           const SmoothedTrack& smoothed) {
  const auto span = [&](const Flight& flight) {
    return fmt::format("from {} to {} s", time_text(file.origin_s, flight.release_s),
                       time_text(file.origin_s, flight.landing_s));
  };
  for (const Flight& flight : named) {
    const auto overlap_s = [&](const Flight& other) {
      return std::min(flight.landing_s, other.landing_s) -
             std::max(flight.release_s, other.release_s);
    };
    const auto found = std::ranges::max_element(smoothed.flights, {}, overlap_s);
    const bool is_lost = found == smoothed.flights.end() || !(overlap_s(*found) > 0.0);
    if (!is_lost && std::abs(found->release_s - flight.release_s) <= max_flight_error_s &&
        std::abs(found->landing_s - flight.landing_s) <= max_flight_error_s)
      continue;
    Progress::warn(
        fmt::format("{}: the flight {} {}; hint: its motion does not fit free fall "
                    "(drag, spin, a bounce), or its times or --gravity are wrong",
                    file.file.string(), span(flight),
                    is_lost ? "is not in the smoothed motion" : "became that " + span(*found)));
  }
}

void warn_of_gravity(const Eigen::Vector3d& gravity_m_per_s2,
                     const std::vector<SmoothInput>& inputs, const SmoothedTracks& smoothed) {
  const double size = gravity_m_per_s2.norm();
  if (std::abs(size / earth_m_per_s2 - 1.0) > max_gravity_error)
    Progress::warn(fmt::format(
        "--gravity {} has a size of {:.3g} m/s^2 in place of 9.81; hint: give it in m/s^2",
        text_of(gravity_m_per_s2), size));
  if (std::ranges::all_of(smoothed.tracks, [](const auto& track) { return track.flights.empty(); }))
    warn_of_axis(gravity_m_per_s2, inputs);
}

}  // namespace touchtrace::cli
