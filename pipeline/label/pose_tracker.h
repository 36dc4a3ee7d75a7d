#pragma once

#include <vector>

#include "pipeline/label/body_fit.h"

namespace touchtrace::label {

/// The pose of one rigid body from view to view. What a hand leaves to be seen of a body often fits
/// several poses about as well, so each is followed, from the last rotation and from where it
/// turned on to; where they fit worse than usual, every few views, and after a while unseen,
/// rotations all around are tried as well. What fits best through all views is right.
class PoseTracker {
 public:
  explicit PoseTracker(const RoundedBody& body) : body_(body) {}

  /// What is likeliest up to this view; `seconds` since the last one that was given.
  const BodyFit& see(const BodyView& view, double seconds);

  /// Of every view that was given, what is likeliest given all of them (Viterbi 1967); one that
  /// fits worse than most counts less.
  std::vector<BodyFit> likeliest() const;

 private:
  /// A pose in one view, and how it came there.
  struct Hypothesis {
    BodyFit fit;
    double misfit_m2 = 0.0;                              ///< a point's part of the cost
    Eigen::Vector3d likely_m = Eigen::Vector3d::Zero();  ///< likely_center of the view
    Eigen::Vector3d turn_rad_per_s = Eigen::Vector3d::Zero();
    double surprise = 0.0;   ///< minus the log likelihood of all views up to this one
    std::size_t parent = 0;  ///< in the last view
  };
  using Hypotheses = std::vector<Hypothesis>;

  Hypotheses followed(const BodyView& view, double seconds) const;
  Hypothesis follow(const BodyView& view, std::size_t parent, bool turning, double seconds) const;
  Hypotheses found(const BodyView& view, double seconds) const;
  void come_from_likeliest(Hypothesis& now, double seconds) const;
  static void keep_likeliest(Hypotheses& all);
  bool fits_as_usual(const Hypotheses& followed) const;

  RoundedBody body_;
  std::vector<Hypotheses> views_;  ///< the likeliest first
  double usual_misfit_m2_ = 0.0;
  int followed_ = 0;  ///< views since all rotations were tried
};

}  // namespace touchtrace::label
