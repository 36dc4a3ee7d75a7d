#pragma once

#include "engine/base/random.h"
#include "pipeline/scene/physics/hand.h"

namespace touchtrace::scene {

/// Properties that differ among instances of the glove; determined by the instance's number.
struct GloveTraits {
  std::vector<float> gain;                              ///< per taxel, lognormal; 0: dead
  std::vector<float> drift_rad_per_s, drift_phase_rad;  ///< of each gain's sinusoidal drift
  std::vector<float> baseline_counts;                   ///< [rows, cols]
};
const GloveTraits& glove_traits(int number, const GloveParameters& parameters = {});
GloveInfo glove_info(int number, const GloveParameters& parameters = {});

/// True clock of the glove. Frame n (its `sequence`) is scanned from first_frame_s + n / rate_hz on
/// the host clock, and arrives `latency_s` plus an exponential jitter after the end of its scan.
struct GloveClock {
  double first_frame_s = 0.0, rate_hz = 15.0;
  double latency_s = 0.0, jitter_s = 0.0;
  double lost_share = 0.0;  ///< probability that a frame is lost
};
GloveClock glove_clock(const SceneOptions& options);

/// Normal forces.
struct TaxelForces {
  std::span<const double> force_n;  ///< of every taxel
  std::span<const int> loaded;      ///< taxels whose force may be nonzero
};

/// Sensor model of the glove: from quasi-static taxel forces to frames of counts. In order: lag,
/// creep while loaded (it makes a release steeper than a press: hysteresis), gain with drift,
/// saturation f / (f + h), cross-talk of rows and columns, noise, 10-bit quantisation, row-by-row
/// scan, transport. Times are on the host clock.
class Glove {
 public:
  Glove(int number, const GloveParameters& parameters, const GloveClock& clock, std::uint64_t seed);

  /// Advances the sensor by `interval_s` (always the same) under these forces to `time_s`, and
  /// reads all rows that are due.
  void sense(const TaxelForces& forces, double time_s, double interval_s);
  /// Discards the recorded frames; continues with the first frame whose scan begins at `time_s` or
  /// later.
  void start(double time_s);
  /// Returns all complete frames that were not lost.
  GloveStream take();

 private:
  void update_sensor(const TaxelForces& forces, double interval_s);
  void deactivate(int taxel);
  double gain_at(int taxel, double time_s) const;
  void update_gains(double time_s);
  void compute_signals();
  void read_row(int row);
  void finish_frame();
  double row_time_s(std::uint64_t frame, int row) const;

  GloveParameters parameters_;
  const GloveTraits& traits_;
  GloveClock clock_;
  RandomStream noise_, transport_;
  GloveStream stream_;
  std::vector<double> lagged_n_;       ///< per taxel
  std::vector<Eigen::Array3d> crept_;  ///< per taxel and time constant: 0 at rest .. 1
  std::vector<double> gain_;           ///< of active taxels, in the present frame
  std::vector<int> active_;            ///< taxels with a force or a memory of one
  std::vector<std::uint8_t> is_active_;
  std::vector<double> signal_, row_sum_, col_sum_;
  std::vector<std::uint16_t> frame_;
  std::uint64_t number_ = 0;  ///< of the present frame
  int next_row_ = 0;
  double frame_time_s_ = 0.0;  ///< start of the present frame
};

}  // namespace touchtrace::scene
