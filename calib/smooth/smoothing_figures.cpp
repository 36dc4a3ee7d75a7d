#include "calib/smooth/smoothing_figures.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/smooth/clock.h"
#include "calib/smooth/smooth.h"
#include "calib/smooth/synthetic_track.h"
#include "engine/base/provenance.h"
#include "engine/base/random.h"

namespace touchtrace {
namespace {

constexpr double rate_hz = 20.0, noise_m = 0.002, clip_s = 40.0, edge_s = 0.5;
constexpr int clips = 6;

struct Sample {
  std::vector<SyntheticMotion> motions;
  std::vector<Track> tracks;
  std::vector<std::vector<Flight>> flights;  ///< as labelling guesses them: 30 ms off
};

Sample sample(SyntheticMotion (*make)(double, std::uint64_t)) {
  Sample result;
  for (std::uint64_t seed = 0; seed < clips; ++seed) {
    result.motions.push_back(make(clip_s, seed));
    result.tracks.push_back(measure(result.motions.back(), rate_hz, noise_m, seed));
    result.flights.push_back(result.motions.back().flights);
    for (auto& flight : result.flights.back()) flight.release_s += 0.03, flight.landing_s -= 0.03;
  }
  return result;
}

/// RMS of an estimate of velocity at the camera's frames, a track's ends left out.
template <class Velocity>
double velocity_rms(const Sample& data, Velocity&& velocity) {
  double squares = 0.0, count = 0.0;
  for (std::size_t clip = 0; clip < data.tracks.size(); ++clip)
    for (std::size_t i = 0; i < data.tracks[clip].size(); ++i) {
      const double t = data.tracks[clip][i].time_s;
      if (t < edge_s || t > clip_s - edge_s) continue;
      squares += (velocity(clip, i) - data.motions[clip].velocity_at(t)).squaredNorm();
      count += 3.0;
    }
  return std::sqrt(squares / count);
}

/// Derivative at the middle of a least-squares polynomial over 2 `half` + 1 frames.
double savitzky_golay_rms(const Sample& data, int half, int degree) {
  Eigen::MatrixXd powers(2 * half + 1, degree + 1);
  for (int i = -half; i <= half; ++i)
    for (int j = 0; j <= degree; ++j) powers(i + half, j) = std::pow(i / rate_hz, j);
  const Eigen::VectorXd taps =
      powers.completeOrthogonalDecomposition().pseudoInverse().row(1).transpose();
  return velocity_rms(data, [&](std::size_t clip, std::size_t at) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = -half; i <= half; ++i)
      sum += taps[i + half] * data.tracks[clip][at + static_cast<std::size_t>(i)].position_m;
    return sum;
  });
}

/// The best window and degree, as only an oracle knows them.
double best_savitzky_golay_rms(const Sample& data) {
  double best = std::numeric_limits<double>::infinity();
  for (int half = 2; half <= 6; ++half)
    for (int degree = 2; degree <= 4; ++degree)
      best = std::min(best, savitzky_golay_rms(data, half, degree));
  return best;
}

/// Share of velocities within their 80 % intervals.
double velocity_coverage(const Sample& data, const SmoothedTracks& smoothed) {
  double covered = 0.0, count = 0.0;
  for (std::size_t clip = 0; clip < data.tracks.size(); ++clip)
    for (double t = edge_s; t < clip_s - edge_s; t += 0.0671) {
      const auto state = smoothed.tracks[clip].smoothed(t);
      const Eigen::Vector3d error = state.velocity_m_per_s - data.motions[clip].velocity_at(t);
      for (int axis = 0; axis < 3; ++axis, count += 1.0)
        covered += std::abs(error[axis]) <
                   1.28155 * std::sqrt(state.covariance[static_cast<std::size_t>(axis)](1, 1));
    }
  return covered / count;
}

void measure_activity(const std::string& name, SyntheticMotion (*make)(double, std::uint64_t),
                      double goal, const std::function<void(Figure)>& emit) {
  const auto data = sample(make);
  const auto smoothed = smooth(data.tracks, data.flights, {});
  const double ours = velocity_rms(data, [&](std::size_t clip, std::size_t i) {
    return smoothed.tracks[clip].smoothed(data.tracks[clip][i].time_s).velocity_m_per_s;
  });
  const double central = savitzky_golay_rms(data, 1, 2),
               peer = std::min(central, best_savitzky_golay_rms(data));
  emit(reported(name + ", 2 mm: velocity RMS, central difference", central, "m/s"));
  emit(reported(name + ", 2 mm: velocity RMS, Savitzky-Golay by oracle", peer, "m/s"));
  emit(reported(name + ", 2 mm: velocity RMS, smoothed", ours, "m/s"));
  emit(at_most(name + ", 2 mm: smoothed over best peer", ours / peer, "", goal));
  emit(within(name + ", 2 mm: velocities in their 80 % interval", velocity_coverage(data, smoothed),
              "", 0.78, 0.82));
}

void measure_units(const std::function<void(Figure)>& emit) {
  const auto track = measure(synthetic_wave(10.0, 1), rate_hz, noise_m, 1);
  Track scaled;
  for (const auto& p : track)
    scaled.push_back({1e3 * p.time_s, 1e3 * p.position_m, 1e3 * p.sigma_m});
  SmoothOptions options;
  options.fit_noise = options.robust = false;
  options.noise.jerk_density = 300.0;
  const auto reference = smooth(track, options);
  options.noise.jerk_density *= 1e6 / 1e15;
  const auto other = smooth(scaled, options);
  double worst = 0.0;
  for (double t = 0.0; t < 9.0; t += 0.0731)
    worst = std::max(
        worst,
        (1e-3 * other.smoothed(1e3 * t).position_m - reference.smoothed(t).position_m).norm());
  emit(at_most("millimetres and milliseconds against metres and seconds", worst, "m", 1e-9));
}

void measure_clock(const std::function<void(Figure)>& emit) {
  double offset = 0.0, drift = 0.0;
  constexpr int runs = 200;
  for (std::uint64_t run = 0; run < runs; ++run) {
    RandomStream random(run, "clock figure");
    std::vector<double> device_s, host_s;
    for (int i = 0; i < 1800; ++i) {
      const double delay_s = -0.003 * std::log1p(-random.uniform());
      if (random.uniform() < 0.03) continue;
      device_s.push_back(i / 15.0);
      host_s.push_back(7.0 + (1.0 + 40e-6) * i / 15.0 + delay_s);
    }
    const auto fit = fit_clock(device_s, host_s);
    offset += std::pow(fit.host_time_s(60.0) - 67.0 - 60.0 * 40e-6, 2) / runs;
    drift += std::pow(fit.drift_ppm() - 40.0, 2) / runs;
  }
  emit(at_most("clock offset over 120 s, 3 ms jitter, 3 % lost", 1e3 * std::sqrt(offset), "ms",
               0.5));
  emit(at_most("clock drift over 120 s", std::sqrt(drift), "ppm", 20.0));
}

void measure_speed(const std::function<void(Figure)>& emit) {
  const auto track = measure(synthetic_wave(1e5 / rate_hz, 1), rate_hz, noise_m, 1);
  const double unknown = std::numeric_limits<double>::infinity();
  const Stopwatch stopwatch;
  const Trajectory trajectory(track, std::vector<double>(track.size(), 1.0), {}, {},
                              {0.0, 9.81, 0.0}, {unknown, unknown});
  const double seconds = stopwatch.cpu_seconds();
  emit(at_most("100k knots with covariance, processor time", trajectory.finite() ? seconds : NAN,
               "s", 0.2));
}

}  // namespace

void measure_smoothing(const std::function<void(Figure)>& emit) {
  measure_activity("wave", synthetic_wave, 0.8, emit);
  measure_activity("throw", synthetic_throw, 0.5, emit);
  measure_units(emit);
  measure_clock(emit);
  measure_speed(emit);
}

}  // namespace touchtrace
