#include "pipeline/cli/smooth_summary.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/base/statistics.h"

namespace touchtrace::cli {
namespace {

using nlohmann::json;

/// Median standard deviation of each axis.
json sigmas_of(const Track& track) {
  json sigmas = json::array();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& point : track) values.push_back(point.sigma_m[axis]);
    sigmas.push_back(median(std::move(values)));
  }
  return sigmas;
}

/// Root mean square of measured minus smoothed coordinates over their standard deviations.
double residual_rms(const Track& track, const SmoothedTrack& smoothed) {
  double squares = 0.0;
  for (const auto& point : track)
    squares += (point.position_m - smoothed.smoothed(point.time_s).position_m)
                   .cwiseQuotient(point.sigma_m)
                   .squaredNorm();
  return std::sqrt(squares / (3.0 * static_cast<double>(track.size())));
}

/// Measurements with hardly any weight.
std::size_t count_outliers(const SmoothedTrack& smoothed) {
  constexpr double max_weight = 0.1;  // a residual of 12 standard deviations
  return static_cast<std::size_t>(
      std::ranges::count_if(smoothed.weights, [](double weight) { return weight < max_weight; }));
}

json summary_of(const SmoothInput& input, const SmoothedTrack& smoothed) {
  const Track& track = input.track.track;
  json summary{{"name", input.files.name},
               {"input", input.track.file.string()},
               {"status", name_of(smoothed.status)},
               {"samples", track.size()},
               {"skipped_rows", input.track.num_skipped},
               {"start_s", time_text(input.track.origin_s, track.front().time_s)},
               {"duration_s", track.back().time_s - track.front().time_s},
               {"sigma_m", sigmas_of(track)},
               {"sigma_source", input.sigma_source}};
  const bool has_states = smoothed.status == SmoothStatus::converged;
  for (const char* name : {"residual_rms", "outliers", "flights", "output", "flights_output"})
    summary[name] = nullptr;
  if (!has_states) return summary;
  summary["residual_rms"] = residual_rms(track, smoothed);
  summary["outliers"] = count_outliers(smoothed);
  summary["flights"] = smoothed.flights.size();
  summary["output"] = input.files.states.string();
  if (!smoothed.flights.empty()) summary["flights_output"] = input.files.flights.string();
  return summary;
}

json noise_of(const MotionNoise& noise) {
  return {{"jerk_density_m2_per_s5", noise.jerk_density},
          {"bandwidth_rad_per_s", noise.bandwidth_rad_per_s},
          {"measurement_scale", noise.measurement_scale},
          {"flight_drag_per_s", noise.flight_drag_per_s},
          {"landing_velocity_fraction", noise.landing_velocity_fraction},
          {"landing_velocity_sigma_m_per_s", noise.landing_velocity_sigma_m_per_s},
          {"wander_sigma_m", noise.wander_sigma_m}};
}

std::string sigma_text(const json& track) {
  static const std::map<std::string, std::string> sources{
      {"file", "median of the file"}, {"option", "--sigma"}, {"data", "estimated from the data"}};
  const auto mm = [&](std::size_t axis) {
    return fmt::format("{:.3g}", 1e3 * track["sigma_m"][axis].get<double>());
  };
  const bool is_isotropic = mm(0) == mm(1) && mm(1) == mm(2);
  return fmt::format("{} mm ({})",
                     is_isotropic ? mm(0) : fmt::format("{}, {}, {}", mm(0), mm(1), mm(2)),
                     sources.at(track["sigma_source"]));
}

std::size_t name_width(const json& tracks) {
  std::size_t width = std::string("track").size();
  for (const auto& track : tracks) width = std::max(width, track["name"].get<std::string>().size());
  return width;
}

void print_track(const json& track, std::size_t width) {
  const bool has_failed = track["output"].is_null();
  const auto residual =
      has_failed ? "-" : fmt::format("{:.2f}", track["residual_rms"].get<double>());
  const auto flights = has_failed ? "-" : fmt::format("{}", track["flights"].get<std::size_t>());
  const auto outliers = has_failed ? "-" : fmt::format("{}", track["outliers"].get<std::size_t>());
  fmt::print("{:<{}} {:>8} {:>8} {:>9.1f} {:>9} {:>8} {:>8}  {}\n",
             track["name"].get<std::string>(), width, track["samples"].get<std::size_t>(),
             track["skipped_rows"].get<std::size_t>(), track["duration_s"].get<double>(), residual,
             outliers, flights,
             has_failed ? "failed: " + track["status"].get<std::string>()
                        : track["output"].get<std::string>());
  fmt::print("{:<{}} sigma {}\n", "", width, sigma_text(track));
}

}  // namespace

json smooth_summary(const std::vector<SmoothInput>& inputs, const SmoothedTracks& smoothed,
                    const Provenance& provenance) {
  json summary{{"tracks", json::array()},
               {"noise", noise_of(smoothed.noise)},
               {"causal_noise", noise_of(smoothed.causal_noise)},
               {"provenance", provenance}};
  for (std::size_t i = 0; i < inputs.size(); ++i)
    summary["tracks"].push_back(summary_of(inputs[i], smoothed.tracks[i]));
  return summary;
}

void print_smooth_summary(const json& summary) {
  const auto width = name_width(summary["tracks"]);
  fmt::print("{:<{}} {:>8} {:>8} {:>9} {:>9} {:>8} {:>8}  {}\n", "track", width, "samples",
             "skipped", "seconds", "residual", "outliers", "flights", "output");
  for (const auto& track : summary["tracks"]) print_track(track, width);
  const auto& noise = summary["noise"];
  fmt::print("residual: RMS over sigma; noise: errors {:.2f} sigma, jerk density {:.3g} m^2/s^5\n",
             noise["measurement_scale"].get<double>(),
             noise["jerk_density_m2_per_s5"].get<double>());
}

}  // namespace touchtrace::cli
