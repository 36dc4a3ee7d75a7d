#include "tests/verify/calib/event_bound.h"

#include <cmath>

#include "calib/smooth/likelihood.h"

namespace touchtrace {
namespace {

constexpr double difference_s = 5e-4;

Track without_errors(const SyntheticMotion& motion, Track track) {
  for (auto& point : track) point.position_m = motion.position_at(point.time_s);
  return track;
}

/// Negative log-likelihood of error-free measurements. With errors its mean differs by a constant,
/// so its curvature is the Fisher information.
class ExpectedCost {
 public:
  ExpectedCost(const Track& track, const MotionNoise& noise, const SmoothOptions& options)
      : track_{track, std::vector<double>(track.size(), 1.0), {}},
        units_(MotionUnits::of({track})),
        noise_(units_.scaled(noise)),
        gravity_(options.gravity_m_per_s2 / units_.acceleration()) {}

  double operator()(const std::vector<Flight>& flights) {
    track_.flights = flights;
    return negative_log_likelihood(ScaledTrack(track_, units_), noise_, gravity_);
  }

 private:
  WeightedTrack track_;
  MotionUnits units_;
  MotionNoise noise_;
  Eigen::Vector3d gravity_;
};

/// A hit is the end of one flight and the beginning of the next: both move.
std::vector<Flight> with_landing_moved(std::vector<Flight> flights, std::size_t which,
                                       double by_s) {
  const bool hit =
      which + 1 < flights.size() && flights[which + 1].release_s <= flights[which].landing_s;
  flights[which].landing_s += by_s;
  if (hit) flights[which + 1].release_s += by_s;
  return flights;
}

}  // namespace

std::vector<double> landing_sigma_bounds_s(const SyntheticMotion& motion, const Track& track,
                                           const MotionNoise& noise, const SmoothOptions& options) {
  ExpectedCost cost(without_errors(motion, track), noise, options);
  const double center = cost(motion.flights);
  std::vector<double> result;
  for (std::size_t i = 0; i < motion.flights.size(); ++i) {
    const double information =
        (cost(with_landing_moved(motion.flights, i, difference_s)) +
         cost(with_landing_moved(motion.flights, i, -difference_s)) - 2.0 * center) /
        (difference_s * difference_s);
    result.push_back(1.0 / std::sqrt(information));
  }
  return result;
}

double velocity_rms_bound(double known_rms, const SyntheticMotion& motion,
                          const std::vector<double>& sigmas_s) {
  double squares = 0.0;
  for (std::size_t i = 0; i < sigmas_s.size(); ++i) {
    const double landing_s = motion.flights[i].landing_s;
    if (!std::isfinite(sigmas_s[i])) continue;  // after the last frame
    const Eigen::Vector3d jump =
        motion.velocity_at(landing_s) - motion.velocity_at(landing_s - 2.0 * motion.step_s);
    squares += jump.squaredNorm() * sigmas_s[i] / std::sqrt(M_PI);
  }
  return std::sqrt(known_rms * known_rms + squares / (3.0 * motion.seconds()));
}

}  // namespace touchtrace
