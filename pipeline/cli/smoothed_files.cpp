#include "pipeline/cli/smoothed_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/files.h"
#include "engine/base/progress.h"

namespace touchtrace::cli {
namespace {

namespace fs = std::filesystem;

constexpr double max_times = 1e7;
constexpr std::size_t flush_bytes = 1u << 20;
constexpr int digits = 12;  // micrometres at 1000 km

bool is_taken(const std::vector<SmoothedFiles>& all, const SmoothedFiles& files) {
  return std::ranges::any_of(all, [&](const SmoothedFiles& other) {
    return other.states == files.states || other.states == files.flights ||
           other.flights == files.states;
  });
}

SmoothedFiles files_of(const fs::path& folder, const std::string& name) {
  return {name, folder / (name + ".csv"), folder / (name + ".flights.csv")};
}

void require_not_an_input(const SmoothedFiles& files, const std::vector<std::string>& inputs) {
  std::error_code ignored;
  for (const auto& input : inputs)
    for (const auto& output : {files.states, files.flights})
      if (fs::equivalent(input, output, ignored))
        throw usage_error(fmt::format("{} is input and output", input),
                          "choose another folder with --output");
}

std::string header() {
  std::string text =
      "time_s,x_m,y_m,z_m,vx_m_per_s,vy_m_per_s,vz_m_per_s,ax_m_per_s2,ay_m_per_s2,az_m_per_s2";
  constexpr std::array names{"x", "y", "z", "vx", "vy", "vz"};
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = i; j < names.size(); ++j)
      text += fmt::format(",cov_{}_{}", names[i], names[j]);
  return text +
         ",causal_x_m,causal_y_m,causal_z_m,causal_vx_m_per_s,causal_vy_m_per_s,"
         "causal_vz_m_per_s\n";
}

void append_row(std::string& text, const std::string& time, const MotionState& state,
                const MotionState& causal) {
  text += time;
  const auto append = [&](double value) {
    fmt::format_to(std::back_inserter(text), ",{:.{}g}", value, digits);
  };
  for (const auto* vector :
       {&state.position_m, &state.velocity_m_per_s, &state.acceleration_m_per_s2})
    for (const double value : *vector) append(value);
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index j = i; j < 6; ++j) append(state.covariance(i, j));
  for (const auto* vector : {&causal.position_m, &causal.velocity_m_per_s})
    for (const double value : *vector) append(value);
  text += '\n';
}

}  // namespace

std::vector<SmoothedFiles> smoothed_files(const fs::path& folder,
                                          const std::vector<std::string>& inputs) {
  std::vector<SmoothedFiles> all;
  for (const auto& input : inputs) {
    const auto name = fs::path(input).stem().string();
    auto files = files_of(folder, name);
    for (int number = 2; is_taken(all, files); ++number)
      files = files_of(folder, fmt::format("{}-{}", name, number));
    require_not_an_input(files, inputs);
    all.push_back(std::move(files));
  }
  return all;
}

std::vector<double> output_times(const TrackFile& track, double rate_hz) {
  std::vector<double> times_s;
  if (rate_hz == 0.0) {
    for (const auto& point : track.track) times_s.push_back(point.time_s);
    return times_s;
  }
  const double first_s = track.track.front().time_s;
  const double steps = (track.track.back().time_s - first_s) * rate_hz;
  if (!(steps < max_times))
    throw usage_error(fmt::format("--rate {} gives {:.3g} rows for {}, more than the limit of {:g}",
                                  rate_hz, steps, track.file.string(), max_times),
                      "choose a lower rate, and check the file's time stamps");
  const auto last = static_cast<std::size_t>(steps + 1e-6);
  for (std::size_t i = 0; i <= last; ++i)
    times_s.push_back(first_s + static_cast<double>(i) / rate_hz);
  return times_s;
}

void write_states(const fs::path& file, const TrackFile& track, const SmoothedTrack& smoothed,
                  const std::vector<double>& times_s, bool overwrite) {
  OutputFile output(file, overwrite);
  std::ofstream stream(output.temporary(), std::ios::binary);
  Progress progress("writing " + file.string(), times_s.size());
  std::string text = header();
  for (const double time_s : times_s) {
    append_row(text, time_text(track.origin_s, time_s), smoothed.smoothed(time_s),
               smoothed.causal(time_s));
    if (text.size() > flush_bytes) stream << std::exchange(text, {});
    progress.advance();
  }
  stream << text;
  stream.close();
  if (!stream)
    throw failure(fmt::format("cannot write {}", output.temporary().string()),
                  "check that the disk is not full and the folder is writable");
  output.commit();
}

void write_flights(const fs::path& file, const TrackFile& track, const SmoothedTrack& smoothed,
                   bool overwrite) {
  std::string text = "release_s,landing_s,release_sigma_s,landing_sigma_s\n";
  for (const auto& flight : smoothed.flights)
    text +=
        fmt::format("{},{},{:.6g},{:.6g}\n", time_text(track.origin_s, flight.release_s),
                    time_text(track.origin_s, flight.landing_s),
                    flight.release_distribution.sigma_s(), flight.landing_distribution.sigma_s());
  write_file(file, text, overwrite);
}

}  // namespace touchtrace::cli
