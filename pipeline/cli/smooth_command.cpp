#include <fmt/core.h>

#include <algorithm>

#include "calib/smooth/find_flights.h"
#include "engine/base/files.h"
#include "pipeline/cli/commands.h"
#include "pipeline/cli/smooth_checks.h"
#include "pipeline/cli/smooth_summary.h"

namespace touchtrace::cli {
namespace {

using nlohmann::json;

struct SmoothCommandOptions {
  std::vector<std::string> tracks;
  std::string output = "smoothed", flights = "none";
  TrackOptions input;
  std::vector<double> gravity_m_per_s2;
  double sigma_m = 0.0, rate_hz = 0.0;

  bool has_flights() const { return flights != "none"; }
  Eigen::Vector3d gravity() const { return Eigen::Vector3d(gravity_m_per_s2.data()); }
  std::filesystem::path summary_file() const {
    return std::filesystem::path(output) / "smooth.json";
  }
};

void describe(OptionSet& set, SmoothCommandOptions& o) {
  set.inputs("track", o.tracks,
             "measured positions of a body, a file per recording: CSV with columns time_s, x_m, "
             "y_m, z_m, or TUM trajectory");
  set.text("output", o.output, "folder for TRACK.csv, TRACK.flights.csv and smooth.json")
      .value("DIR");
  set.text("x-column", o.input.x_column,
           "column of x in a file with several bodies, e.g. hand_x for hand_x, hand_y, hand_z")
      .value("NAME");
  set.number("input-rate", o.input.rate_hz, "samples per second of a file without times [Hz]", 0.0,
             1e6)
      .value("HZ");
  set.number("sigma", o.sigma_m,
             "standard deviation of measured coordinates [m] in files without; 0: estimated from "
             "the data",
             0.0, 1e3)
      .value("METRES");
  set.number("rate", o.rate_hz, "rate of the written states [Hz]; 0: one per sample", 0.0, 1e6)
      .value("HZ");
  set.group("Free flight of a thrown body");
  set.text("flights", o.flights, "find, none, or CSV file with columns release_s, landing_s")
      .value("{find,none,FILE}");
  set.numbers("gravity", o.gravity_m_per_s2,
              "gravity in the track's frame [m/s^2]; z up: 0 0 -9.81; camera frame: 0 9.81 0", 3,
              -100.0, 100.0)
      .value("X Y Z");
}

void require_valid(const SmoothCommandOptions& o) {
  if (!o.has_flights()) return;
  if (o.gravity_m_per_s2.empty())
    throw usage_error("--flights needs --gravity X Y Z",
                      "give --gravity 0 0 -9.81 if z is up, 0 9.81 0 in a camera's frame");
  if (o.gravity().norm() == 0.0)
    throw usage_error("--gravity must not be 0 0 0",
                      "give gravity, or --flights none for motion without it");
  if (o.flights != "find" && o.tracks.size() > 1)
    throw usage_error(
        fmt::format("--flights {} cannot be used with {} tracks", o.flights, o.tracks.size()),
        "give one track, or --flights find");
  if (o.flights != "find" && !std::filesystem::exists(o.flights))
    throw data_error(fmt::format("cannot read {}: no such file", o.flights),
                     "give --flights find, --flights none, or an existing CSV file");
}

/// Fails before the work if an output exists.
void require_writable(const SmoothCommandOptions& o, const std::vector<SmoothedFiles>& files,
                      bool overwrite) {
  const OutputFile summary(o.summary_file(), overwrite);
  for (const auto& [name, states, flights] : files)
    for (const auto& path : {states, flights}) const OutputFile file(path, overwrite);
}

std::vector<std::vector<Flight>> guess_flights(const SmoothCommandOptions& o,
                                               const std::vector<SmoothInput>& inputs) {
  std::vector<std::vector<Flight>> flights;
  if (!o.has_flights()) return flights;
  for (const auto& input : inputs)
    flights.push_back(o.flights == "find" ? find_flights(input.track.track, o.gravity())
                                          : read_flights(o.flights, input.track));
  return flights;
}

SmoothedTracks smooth_inputs(const SmoothCommandOptions& o, const std::vector<SmoothInput>& inputs,
                             const std::vector<std::vector<Flight>>& flights) {
  SmoothOptions options;
  if (o.has_flights()) options.gravity_m_per_s2 = o.gravity();
  std::vector<Track> tracks;
  for (const auto& input : inputs) tracks.push_back(input.track.track);
  return smooth(tracks, flights, options);
}

/// Writes the files of a track; removes those of an earlier run that it does not have any more.
void write_outputs(const SmoothInput& input, const SmoothedTrack& smoothed, double rate_hz,
                   bool overwrite) {
  const bool has_states = smoothed.status == SmoothStatus::converged,
             has_flights = has_states && !smoothed.flights.empty();
  const auto& [name, states, flights] = input.files;
  if (has_states)
    write_states(states, input.track, smoothed, output_times(input.track, rate_hz), overwrite);
  else if (overwrite)
    std::filesystem::remove(states);
  if (has_flights)
    write_flights(flights, input.track, smoothed, overwrite);
  else if (overwrite)
    std::filesystem::remove(flights);
}

Provenance provenance_of(const SmoothCommandOptions& o, const Invocation& invocation) {
  auto provenance = start_provenance("touchtrace/smooth/1", "smooth");
  provenance.options = invocation.options;
  for (const auto& path : o.tracks) provenance.add_input(path);
  if (o.has_flights() && o.flights != "find") provenance.add_input(o.flights);
  return provenance;
}

ExitCode run(const SmoothCommandOptions& options, const Invocation& invocation) {
  const Stopwatch stopwatch;
  require_valid(options);
  const auto files = smoothed_files(options.output, options.tracks);
  require_writable(options, files, invocation.overwrite);
  auto inputs = read_smooth_inputs(options.tracks, files, options.input, options.sigma_m);
  for (const auto& input : inputs) output_times(input.track, options.rate_hz);  // not too many
  for (const auto& input : inputs) warn_of_implausible(input);
  auto provenance = provenance_of(options, invocation);
  const auto flights = guess_flights(options, inputs);
  const auto smoothed = smooth_inputs(options, inputs, flights);
  if (options.has_flights()) warn_of_gravity(options.gravity(), inputs, smoothed);
  if (options.has_flights() && options.flights != "find")
    warn_of_moved_flights(inputs.at(0).track, flights.at(0), smoothed.tracks.at(0));
  for (std::size_t i = 0; i < inputs.size(); ++i)
    write_outputs(inputs[i], smoothed.tracks[i], options.rate_hz, invocation.overwrite);
  stopwatch.stop(provenance);
  const json summary = smooth_summary(inputs, smoothed, provenance);
  // Names of files need not be valid UTF-8.
  const auto document = summary.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
  write_file(options.summary_file(), document, invocation.overwrite);
  if (invocation.json)
    fmt::print("{}", document);
  else
    print_smooth_summary(summary);
  const bool is_complete = std::ranges::all_of(smoothed.tracks, [](const SmoothedTrack& track) {
    return track.status == SmoothStatus::converged;
  });
  return is_complete ? ExitCode::done : ExitCode::data;
}

}  // namespace

Command smooth_command() {
  return make_command<SmoothCommandOptions>(
      "smooth",
      "smooth measured positions into positions, velocities and accelerations, with covariance",
      {"touchtrace smooth hand.csv --sigma 0.002",
       "touchtrace smooth run1.txt run2.txt --rate 100 --output hand --json",
       "touchtrace smooth ball.csv --flights find --gravity 0 0 -9.81"},
      run, {.overwrite = true, .quiet = true});
}

}  // namespace touchtrace::cli
