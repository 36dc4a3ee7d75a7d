#pragma once

#include <optional>
#include <vector>

#include "calib/smooth/smooth.h"

namespace touchtrace {

/// Process model of a motion in contact.
enum class ContactModel { white_jerk, damped_oscillator };

/// Maximum-likelihood noise of all tracks (Ceres, BFGS), assuming white measurement errors and
/// ignoring WeightedTrack::jerk_covariance. Estimated: jerk density and measurement scale; for a
/// damped oscillator also frequency and damping; else, with flights, drag and, for a bouncing body,
/// the landing velocity's sigma, for others density and duration of throws.
/// Weak log-normal priors (standard deviation: a factor of 10) keep unobservable parameters near
/// their initial values: those of `options`; measurement scale 1; frequency half a radian per
/// frame, damping 0.5. The jerk density has none.
/// Returns nullopt for fewer than 6 points or if the search fails.
std::optional<MotionNoise<double>> maximum_likelihood_noise(
    const std::vector<WeightedTrack>& tracks, const SmoothOptions& options, ContactModel model);

/// Treatment of flights that explain the data worse than no flight does, by the Bayesian
/// information criterion.
enum class ImplausibleFlights { keep, drop };

/// Returns the track's flights with maximum-likelihood times: grid search over +-60 ms, then BFGS.
std::vector<Flight> estimate_flights(const WeightedTrack& track, const MotionNoise<double>& noise,
                                     const SmoothOptions& options, ImplausibleFlights implausible);

/// Sets the time distribution of each event of the track's flights, given all other events.
void estimate_event_distributions(WeightedTrack& track, const MotionNoise<double>& noise,
                                  const SmoothOptions& options);

}  // namespace touchtrace
