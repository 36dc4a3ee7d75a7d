#pragma once

#include <vector>

#include "pipeline/label/estimate/body_fit.h"

namespace touchtrace::label {

/// Tracks the pose of a rigid body of known shape with multiple hypotheses. A body that a hand
/// partly hides often fits several poses about equally well. Each hypothesis is continued from its
/// last rotation, once as it was and once with its angular velocity. Global candidates are added
/// where all hypotheses fit worse than usual, at least every fifth view, and after a longer gap.
class PoseTracker {
 public:
  explicit PoseTracker(const RoundedBody& body) : body_(body) {}

  /// Adds a view, `seconds` after the last one. Returns the most likely pose given the views so
  /// far.
  const BodyFit& update(const BodyView& view, double seconds);

  /// Most likely pose in every view given all views (Viterbi 1967). The information of poses that
  /// fit worse than the median is scaled down.
  std::vector<BodyFit> viterbi_path() const;

  /// Mean squared offsets [m^2] along the axes from the poses of viterbi_path() to those of all
  /// hypotheses of a view, weighted by the likelihood of the best path through each. Large where
  /// several poses fit about equally well.
  std::vector<Eigen::Vector3d> ambiguity_m2(const std::vector<BodyFit>& path) const;

 private:
  /// A pose in one view and its predecessor.
  struct Hypothesis {
    BodyFit fit;
    double misfit_m2 = 0.0;                                      ///< cost per surface point
    Eigen::Vector3d initial_centre_m = Eigen::Vector3d::Zero();  ///< initial_centre of the view
    Eigen::Vector3d angular_velocity_rad_per_s = Eigen::Vector3d::Zero();
    double view_nll = 0.0;   ///< negative log-likelihood of the view
    double nll = 0.0;        ///< of the best path up to this view
    std::size_t parent = 0;  ///< index in the previous view
  };
  using Hypotheses = std::vector<Hypothesis>;

  Hypotheses continuations(const BodyView& view, double seconds) const;
  Hypothesis continuation(const BodyView& view, std::size_t parent, bool rotating,
                          double seconds) const;
  Hypotheses global_candidates(const BodyView& view, double seconds) const;
  /// Negative log-likelihood of the rotation between two hypotheses of successive views.
  double step_nll(const Hypothesis& from, const Hypothesis& to, double seconds) const;
  /// Negative log-likelihood of the step into view `to` and of that view, from hypothesis `from` of
  /// the view before.
  double transition_nll(std::size_t to, std::size_t from, const Hypothesis& hypothesis) const;
  /// Per hypothesis of every view, the least negative log-likelihood of all later views.
  std::vector<std::vector<double>> later_nlls() const;
  void link_to_best_parent(Hypothesis& hypothesis, double seconds) const;
  /// Sorts by likelihood; drops duplicates and unlikely hypotheses.
  static void prune(Hypotheses& all);
  bool fits_as_usual(const Hypotheses& hypotheses) const;

  RoundedBody body_;
  std::vector<Hypotheses> views_;  ///< by decreasing likelihood
  std::vector<double> steps_s_;    ///< before each view
  double usual_misfit_m2_ = 0.0;
  int views_since_global_ = 0;
};

}  // namespace touchtrace::label
