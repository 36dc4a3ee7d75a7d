#pragma once

#include "engine/base/random.h"
#include "pipeline/scene/physics/hand.h"

namespace touchtrace::scene {

/// What makes one glove different from the next; fixed by its number, whatever is done with it.
struct GloveTraits {
  std::vector<float> gain;                              ///< per taxel, lognormal; 0 where dead
  std::vector<float> drift_rad_per_s, drift_phase_rad;  ///< of each gain's slow change
  std::vector<float> baseline_counts;                   ///< [rows x cols]
};
const GloveTraits& glove_traits(int number, const GloveParameters& parameters = {});
GloveInfo glove_info(int number, const GloveParameters& parameters = {});

/// The glove's true clock: frame n (its `sequence`) is scanned from first_frame_s + n / rate_hz,
/// host's clock, on, and arrives `latency_s` plus an exponential jitter after its scan ended.
struct GloveClock {
  double first_frame_s = 0.0, rate_hz = 15.0;
  double latency_s = 0.0, jitter_s = 0.0;
  double lost_share = 0.0;  ///< of the frames
};
GloveClock glove_clock(const SceneOptions& options);

/// Normal forces.
struct TaxelForces {
  std::span<const double> force_n;  ///< of every taxel
  std::span<const int> loaded;      ///< taxels where it may be other than 0
};

/// Quasi-static taxel forces in, frames out. Times are the host's clock.
class Glove {
 public:
  Glove(int number, const GloveParameters& parameters, const GloveClock& clock, std::uint64_t seed);

  /// Moves the sensing material on by `interval_s` (always the same) under these normal forces,
  /// then reads every row that is due up to `time_s`.
  void sense(const TaxelForces& forces, double time_s, double interval_s);
  /// Starts with the first frame whose scan begins at `time_s` or later; what was recorded is
  /// forgotten.
  void start(double time_s);
  /// Every whole frame that was read and not lost.
  GloveStream take();

 private:
  void relax(const TaxelForces& forces, double interval_s);
  void forget(int taxel);
  double gain_at(int taxel, double time_s) const;
  void drift(double time_s);
  void measure();
  void read_row(int row);
  void finish_frame();
  double row_time_s(std::uint64_t frame, int row) const;

  GloveParameters parameters_;
  const GloveTraits& traits_;
  GloveClock clock_;
  RandomStream noise_, transport_;
  GloveStream stream_;
  std::vector<double> pressed_n_, crept_n_;  ///< per taxel, after lag; and its slow part
  std::vector<double> gain_;                 ///< of active taxels, in the frame being read
  std::vector<int> active_;                  ///< taxels that carry or remember a force
  std::vector<std::uint8_t> is_active_;
  std::vector<double> signal_, row_sum_, col_sum_;
  std::vector<std::uint16_t> frame_;
  std::uint64_t number_ = 0;  ///< of the frame being read
  int next_row_ = 0;
  double frame_time_s_ = 0.0;  ///< at which the frame being read began
};

}  // namespace touchtrace::scene
