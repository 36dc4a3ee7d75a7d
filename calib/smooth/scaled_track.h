#pragma once

#include <utility>
#include <vector>

#include "calib/smooth/motion_noise.h"
#include "calib/smooth/motion_prior.h"
#include "calib/smooth/track.h"

namespace touchtrace {

/// Logarithm of a track's process noise over its constant value, linear between knots. Without
/// knots: zero. Long pauses between measurements have no knots.
struct ProcessNoiseCurve {
  struct Pause {
    double start_s, length_s;
    double before_s;  ///< sum of the pauses before it
  };

  double start_s = 0.0, knot_spacing_s = 1.0;
  std::vector<double> log_variance;  ///< [knots]
  std::vector<Pause> pauses = {};    ///< in the order of time

  double at(double time_s) const;
  /// Index of the knot before a time (at most the last but one), and the fraction of the interval
  /// to the next knot.
  std::pair<std::size_t, double> position(double time_s) const;
  /// Time since the start, without pauses.
  double elapsed_s(double time_s) const;
};

/// Decision of judge_points() that replaces the weight computed from a measurement's residual.
enum class Judgement : char { none, right, wrong };

/// Track with its current estimates of weights, flights and process noise.
struct WeightedTrack {
  Track points;
  std::vector<double> weights;  ///< [points] in (0, 1]; variances are divided by them
  std::vector<Flight> flights;
  ProcessNoiseCurve curve = {};
  std::vector<Judgement> judgements = {};  ///< [points] or empty
};

/// Units in which a track's numbers are of order one.
struct MotionUnits {
  double time_s = 1.0, length_m = 1.0;

  /// Time: median spacing of `tracks`. Length: median of the axes' median sigmas.
  static MotionUnits of(const std::vector<Track>& tracks);
  MotionNoise scaled(const MotionNoise& noise) const;
  MotionNoise unscaled(const MotionNoise& noise) const;
  double acceleration() const { return length_m / (time_s * time_s); }
};

/// Measurement in MotionUnits.
struct ScaledPoint {
  double time;
  Eigen::Vector3d position;
  Eigen::Vector3d variance;  ///< of its white error at a measurement scale of 1, over its weight
  double log_noise;          ///< process noise curve in the step before it
};

/// Track in MotionUnits relative to its first time and position: the filters' input.
struct ScaledTrack {
  MotionUnits units;
  double origin_s;
  Eigen::Vector3d origin_m;
  std::vector<ScaledPoint> points;
  std::vector<ContactEvent> events;
  double position_sigma;  ///< of an uninformative prior at the first point

  ScaledTrack(const WeightedTrack& track, const MotionUnits& units);

  double to_scaled_time(double time_s) const { return (time_s - origin_s) / units.time_s; }
  /// Prior of the track's motion with `noise` in MotionUnits.
  template <StateModel model>
  MotionPrior<model> prior(const MotionNoise& noise) const;
};

/// Alternating releases and landings in units of `unit_s` from `origin_s`. Times are made
/// non-decreasing: drawing them from their distributions may swap neighbours.
std::vector<ContactEvent> contact_events(const std::vector<Flight>& flights, double origin_s,
                                         double unit_s);

}  // namespace touchtrace
