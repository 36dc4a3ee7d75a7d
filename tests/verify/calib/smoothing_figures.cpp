#include "tests/verify/calib/smoothing_figures.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calib/smooth/clock.h"
#include "engine/base/provenance.h"
#include "engine/base/random.h"
#include "tests/verify/calib/event_bound.h"
#include "tests/verify/calib/smoothing_sample.h"

namespace touchtrace {
namespace {

using Emit = std::function<void(Figure)>;

constexpr double edge_s = 0.5, impact_s = 0.005;

/// Velocity jumps at an impact: near it an error of a millisecond in time is an error of the jump.
bool is_next_to_impact(const SyntheticMotion& motion, double time_s) {
  return std::ranges::any_of(motion.flights, [&](const Flight& flight) {
    return std::abs(flight.landing_s - time_s) < impact_s;
  });
}

bool counts(const SyntheticMotion& motion, double time_s, bool with_impacts) {
  return time_s >= edge_s && time_s <= SmoothingSample::clip_s - edge_s &&
         (with_impacts || !is_next_to_impact(motion, time_s));
}

/// [3, clips] Squared errors of estimated velocities at camera frames, except a track's ends, over
/// the number of frames of all clips.
template <class Velocity>
Eigen::Array3Xd velocity_squares(const SmoothingSample& data, bool with_impacts,
                                 Velocity&& velocity) {
  Eigen::Array3Xd squares = Eigen::Array3Xd::Zero(3, SmoothingSample::clips);
  double count = 0.0;
  for (std::size_t clip = 0; clip < data.tracks.size(); ++clip)
    for (std::size_t i = 0; i < data.tracks[clip].size(); ++i) {
      const double t = data.tracks[clip][i].time_s;
      if (!counts(data.motions[clip], t, with_impacts)) continue;
      squares.col(static_cast<Eigen::Index>(clip)) +=
          (velocity(clip, i) - data.motions[clip].velocity_at(t)).array().square();
      ++count;
    }
  return squares / count;
}

double rms_of(const Eigen::Array3Xd& squares) { return std::sqrt(squares.sum() / 3.0); }

template <class Velocity>
double velocity_rms(const SmoothingSample& data, bool with_impacts, Velocity&& velocity) {
  return rms_of(velocity_squares(data, with_impacts, velocity));
}

/// Derivative at the centre of a least-squares polynomial over 2 `half` + 1 frames.
double savitzky_golay_rms(const SmoothingSample& data, bool with_impacts, int half, int degree) {
  Eigen::MatrixXd powers(2 * half + 1, degree + 1);
  for (int i = -half; i <= half; ++i)
    for (int j = 0; j <= degree; ++j)
      powers(i + half, j) = std::pow(i / SmoothingSample::rate_hz, j);
  const Eigen::VectorXd taps =
      powers.completeOrthogonalDecomposition().pseudoInverse().row(1).transpose();
  return velocity_rms(data, with_impacts, [&](std::size_t clip, std::size_t at) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = -half; i <= half; ++i)
      sum += taps[i + half] * data.tracks[clip][at + static_cast<std::size_t>(i)].position_m;
    return sum;
  });
}

/// With the best window and degree given the truth.
double best_savitzky_golay_rms(const SmoothingSample& data, bool with_impacts) {
  double best = savitzky_golay_rms(data, with_impacts, 1, 2);  // the central difference
  for (int half = 2; half <= 6; ++half)
    for (int degree = 2; degree <= 4; ++degree)
      best = std::min(best, savitzky_golay_rms(data, with_impacts, half, degree));
  return best;
}

/// Rauch-Tung-Striebel smoother with constant jerk density, the best for each clip and axis given
/// the truth: no worse than a quintic spline with cross-validation, which has the same prior.
double best_constant_rms(const SmoothingSample& data, bool with_impacts) {
  Eigen::Array3Xd best =
      Eigen::Array3Xd::Constant(3, SmoothingSample::clips, std::numeric_limits<double>::infinity());
  for (double decade = -1.0; decade <= 5.0; decade += 0.25) {
    SmoothOptions options;
    options.estimate_noise = options.robust = false;
    options.noise.jerk_density = std::pow(10.0, decade), options.noise.bandwidth_rad_per_s = 0.0;
    std::vector<SmoothedTrack> smoothed;
    for (const auto& track : data.tracks) smoothed.push_back(smooth(track, options));
    best = best.min(velocity_squares(data, with_impacts, [&](std::size_t clip, std::size_t i) {
      return smoothed[clip].smoothed(data.tracks[clip][i].time_s).velocity_m_per_s;
    }));
  }
  return rms_of(best);
}

/// Emits velocity errors and their ratio to the best peer's, which is returned.
double emit_errors(const std::string& name, const SmoothingSample& data,
                   const SmoothedTracks& smoothed, bool with_impacts, std::optional<double> goal,
                   const Emit& emit) {
  const double ours = velocity_rms(data, with_impacts, [&](std::size_t clip, std::size_t i) {
    return smoothed.tracks[clip].smoothed(data.tracks[clip][i].time_s).velocity_m_per_s;
  });
  const double golay = best_savitzky_golay_rms(data, with_impacts),
               constant = best_constant_rms(data, with_impacts);
  emit(reported(name + ": velocity RMS, best Savitzky-Golay", golay, "m/s"));
  emit(reported(name + ": velocity RMS, best constant-noise RTS per axis", constant, "m/s"));
  emit(reported(name + ": velocity RMS, smoothed", ours, "m/s"));
  const double ratio = ours / std::min(golay, constant);
  const std::string title = name + ": smoothed over best peer";
  emit(goal ? at_most(title, ratio, "", *goal) : reported(title, ratio, ""));
  return std::min(golay, constant);
}

/// Emits the Cramer-Rao bounds of impact times and of the velocity error that they imply.
void emit_bound(const std::string& name, const SmoothingSample& data, const MotionNoise& noise,
                double peer, const Emit& emit) {
  SmoothOptions options;
  std::vector<Trajectory> known;
  for (std::size_t clip = 0; clip < data.tracks.size(); ++clip)
    known.emplace_back(
        WeightedTrack{data.tracks[clip], std::vector<double>(data.tracks[clip].size(), 1.0),
                      data.motions[clip].flights},
        noise, options.gravity_m_per_s2);
  const double known_rms = velocity_rms(data, false, [&](std::size_t clip, std::size_t i) {
    return known[clip].smoothed(data.tracks[clip][i].time_s).velocity_m_per_s;
  });
  double squares = 0.0, sum_s = 0.0, count = 0.0;
  for (std::size_t clip = 0; clip < data.tracks.size(); ++clip) {
    const auto bounds_s =
        landing_sigma_bounds_s(data.motions[clip], data.tracks[clip], noise, options);
    squares += std::pow(velocity_rms_bound(known_rms, data.motions[clip], bounds_s), 2);
    for (double bound_s : bounds_s)
      if (std::isfinite(bound_s)) sum_s += bound_s, ++count;
  }
  emit(reported(name + ": impact times, mean Cramer-Rao bound", 1e3 * sum_s / count, "ms"));
  emit(reported(name + ": bound of the ratio to the best peer",
                std::sqrt(squares / SmoothingSample::clips) / peer, ""));
}

/// Emits the coverage of 80 % intervals of positions and velocities, and their NEES over its six
/// degrees of freedom.
void emit_intervals(const std::string& name, const SmoothingSample& data,
                    const SmoothedTracks& smoothed, const Emit& emit) {
  constexpr double sigmas_of_80_percent = 1.28155;
  double position = 0.0, velocity = 0.0, nees = 0.0, count = 0.0;
  for (std::size_t clip = 0; clip < data.tracks.size(); ++clip)
    for (double t = edge_s; t < SmoothingSample::clip_s - edge_s; t += 0.0671, count += 1.0) {
      const auto state = smoothed.tracks[clip].smoothed(t);
      Eigen::Matrix<double, 6, 1> error;
      error << state.position_m - data.motions[clip].position_at(t),
          state.velocity_m_per_s - data.motions[clip].velocity_at(t);
      const Eigen::Matrix<double, 6, 6> covariance = state.covariance.topLeftCorner<6, 6>();
      for (int i = 0; i < 6; ++i)
        (i < 3 ? position : velocity) +=
            (std::abs(error[i]) < sigmas_of_80_percent * std::sqrt(covariance(i, i))) / 3.0;
      nees += error.dot(covariance.ldlt().solve(error)) / 6.0;
    }
  emit(within(name + ": positions in their 80 % interval", position / count, "", 0.78, 0.82));
  emit(within(name + ": velocities in their 80 % interval", velocity / count, "", 0.78, 0.82));
  emit(within(name + ": NEES", nees / count, "", 0.8, 1.2));
}

void measure_wave(const Emit& emit) {
  const auto data = smoothing_sample(synthetic_wave);
  const auto smoothed = smooth(data.tracks, data.flights, {});
  emit_errors("wave, 2 mm", data, smoothed, true, 0.8, emit);
  emit_intervals("wave, 2 mm", data, smoothed, emit);
}

void measure_flights(const std::string& name, SyntheticMotion (*make)(double, std::uint64_t),
                     double goal, const Emit& emit) {
  const auto data = smoothing_sample(make);
  const auto smoothed = smooth(data.tracks, data.flights, {});
  const double peer = emit_errors(name + ", 2 mm, all frames", data, smoothed, true, goal, emit);
  emit_bound(name + ", 2 mm", data, smoothed.noise, peer, emit);
  emit_errors(name + ", 2 mm, 5 ms from impacts", data, smoothed, false, {}, emit);
  emit_intervals(name + ", 2 mm", data, smoothed, emit);
}

enum class ErrorKind { heavy_tails, correlated, gaps };

/// Replaces the errors by ones that labelling has: Student's t with four degrees of freedom; half
/// of the variance correlated over 0.2 s; white, with one second in five missing.
SmoothingSample with_errors(SmoothingSample data, ErrorKind kind) {
  for (std::size_t clip = 0; clip < data.tracks.size(); ++clip) {
    RandomStream random(clip, "spoilt track");
    const auto normal = [&] {
      return Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    };
    Track track;
    Eigen::Vector3d common = normal();
    const double decay = std::exp(-1.0 / (SmoothingSample::rate_hz * 0.2));
    for (auto point : data.tracks[clip]) {
      const Eigen::Vector3d white = normal();
      common = decay * common + std::sqrt(1.0 - decay * decay) * normal();
      const double chi2 = normal().squaredNorm() + std::pow(random.normal(), 2);
      Eigen::Vector3d error = SmoothingSample::noise_m * white;
      if (kind == ErrorKind::heavy_tails) error *= std::sqrt(2.0 / chi2);  // unit variance
      if (kind == ErrorKind::correlated)
        error = SmoothingSample::noise_m * std::sqrt(0.5) * (white + common);
      point.position_m = data.motions[clip].position_at(point.time_s) + error;
      if (kind != ErrorKind::gaps || std::fmod(point.time_s, 5.0) > 1.0) track.push_back(point);
    }
    data.tracks[clip] = track;
  }
  return data;
}

void measure_with_errors(const std::string& name, const SmoothingSample& sample, ErrorKind kind,
                         const Emit& emit) {
  const auto data = with_errors(sample, kind);
  emit_intervals(name, data, smooth(data.tracks, data.flights, {}), emit);
}

void measure_clock(const Emit& emit) {
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

void measure_speed(const std::string& name, double knots, double max_s, const Emit& emit) {
  const auto track = measure(synthetic_wave(knots / SmoothingSample::rate_hz, 1),
                             SmoothingSample::rate_hz, SmoothingSample::noise_m, 1);
  const Stopwatch stopwatch;
  const Trajectory trajectory({track, std::vector<double>(track.size(), 1.0), {}}, {},
                              {0.0, 9.81, 0.0});
  const double seconds = stopwatch.cpu_seconds();
  emit(at_most(name + " knots with covariance, CPU time", trajectory.is_finite() ? seconds : NAN,
               "s", max_s));
}

}  // namespace

void measure_smoothing(const Emit& emit) {
  measure_wave(emit);
  measure_flights("throw", synthetic_throw, 0.5, emit);
  measure_flights("pingpong", synthetic_pingpong, 0.05, emit);
  const auto wave = smoothing_sample(synthetic_wave);
  measure_with_errors("wave, heavy tails", wave, ErrorKind::heavy_tails, emit);
  measure_with_errors("wave, correlated errors", wave, ErrorKind::correlated, emit);
  measure_with_errors("throw, correlated errors", smoothing_sample(synthetic_throw),
                      ErrorKind::correlated, emit);
  measure_with_errors("pingpong, correlated errors", smoothing_sample(synthetic_pingpong),
                      ErrorKind::correlated, emit);
  measure_with_errors("wave, gaps", wave, ErrorKind::gaps, emit);
  measure_clock(emit);
  measure_speed("100k", 1e5, 0.2, emit);
  measure_speed("1M", 1e6, 2.0, emit);
}

}  // namespace touchtrace
