#pragma once

#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// Part of a track around a flight, without its process noise curve, which was estimated with the
/// current event times and would confirm them.
WeightedTrack window_around(const WeightedTrack& track, const Flight& flight);

/// Negative log-likelihood of a window as a function of one flight's release and landing, in time
/// units from the window's first point. The other flights are fixed; one that begins
/// at this landing moves with it. If this flight itself begins with a hit, its release is
/// fixed to the landing before.
class FlightCost {
 public:
  FlightCost(const WeightedTrack& window, const MotionUnits& units, const Flight& flight,
             const std::vector<Flight>& before, const std::vector<Flight>& after,
             const MotionNoise& noise, const SmoothOptions& options);

  bool is_release_free() const { return !begins_with_hit_; }
  bool is_last() const { return after_.empty(); }

  /// `times`: release, landing. Infinite if the times are out of order.
  double operator()(const double* times) const;
  double without_flight() const;
  /// Penalty of an event's time in the Bayesian information criterion.
  double penalty() const;

  double scaled_time(double time_s) const { return track_.to_scaled_time(time_s); }
  double time_s(double scaled) const { return track_.origin_s + scaled * track_.units.time_s; }

 private:
  double with_events(const std::vector<ContactEvent>& own, double next_hit) const;

  ScaledTrack track_;
  MotionNoise noise_;
  Eigen::Vector3d gravity_;
  std::vector<ContactEvent> before_, after_;
  bool begins_with_hit_, ends_with_hit_;
};

}  // namespace touchtrace
