#pragma once

#include <optional>

#include "pipeline/label/box_tracker.h"
#include "pipeline/label/lift.h"
#include "pipeline/label/target_filter.h"

namespace touchtrace::label {

/// One body that is followed: where it is expected, its tracker, and how it is told from the rest.
class Target {
 public:
  /// A body of `disc_m` as it is seen from afar. Its points lie within `radius_m` of their middle
  /// and are `fewest` at least.
  Target(Body body, double disc_m, double radius_m, std::size_t fewest, const TrackerKind& kind)
      : body_(body), disc_m_(disc_m), radius_m_(radius_m), fewest_(fewest), tracker_(kind) {}

  /// Where a user's box says it is.
  std::optional<Patch> begin(const Surface& surface, const PixelBox& box) const;

  /// Its tracker's box around where it is expected.
  std::optional<PixelBox> track(const MaskedImage& image, const Camera& camera);

  /// The patch that its place and its size speak for, of those where it is expected, where it is
  /// `tracked` and, if given, at `hint_m`; all must lie within the gate. One that is hidden or
  /// was lost for some frames is looked for around the hint, and everywhere; but far from where it
  /// may be only a patch counts that shows half of it. A patch that fills all of the circle around
  /// it is a piece of something larger that covers the picture, and is never taken.
  std::optional<Patch> find(const Surface& surface, const MaskedImage& image,
                            const std::optional<PixelBox>& tracked, const Segmenter& segmenter,
                            const std::optional<Eigen::Vector3d>& hint_m);

  /// With an empty `box` its tracker waits until the target is seen.
  void start(const Eigen::Vector3d& position_m, double sigma_m, const PixelBox& box,
             const MaskedImage& image);
  void predict(double seconds, bool falling, const Eigen::Vector3d& gravity_m_per_s2) {
    filter_.predict(seconds, falling, gravity_m_per_s2);
  }
  /// Takes a place in; far from where it was expected the filter starts anew.
  void measure(const Eigen::Vector3d& position_m, double sigma_m);

  /// Nothing shows it, but it is known to be near a place: until it is seen, only there.
  void hide(const Eigen::Vector3d& position_m, double sigma_m);

  double gate_m() const;
  /// Not found for some frames.
  bool is_lost() const;
  Eigen::Vector3d expected_m() const { return filter_.position_m(); }
  /// Times the tracker was set on its target anew.
  int restarts() const { return tracker_.starts(); }

 private:
  /// So near to where it may be, any part of it is taken for it; up to the farthest, what shows.
  double near_m(bool hinted) const;
  double farthest_m() const;
  /// Where it may be: as its motion goes on or, once that tells nothing any more, where it was.
  Eigen::Vector3d around_m() const;
  /// How far from there it may be found; the farther, the more of it has to show.
  double usual_off_m() const;
  /// Of a surface; all below are given those alone.
  Surface own_points(const Surface& surface) const;
  std::vector<Eigen::Vector3d> starts(const Surface& own, const std::optional<PixelBox>& tracked,
                                      const std::optional<Eigen::Vector3d>& hint_m) const;
  std::optional<Patch> best_patch(const Surface& own, const Segmenter& segmenter,
                                  const std::vector<Eigen::Vector3d>& starts,
                                  const std::optional<Eigen::Vector3d>& hint_m) const;
  std::optional<Eigen::Vector3d> median_in_box(const Surface& own, const PixelBox& box) const;
  void restart(const MaskedImage& image, const PixelBox& box);

  TargetFilter filter_;
  Eigen::Vector3d last_m_ = Eigen::Vector3d::Zero();
  Body body_;
  double disc_m_, radius_m_;
  std::size_t fewest_;
  BoxTracker tracker_;
  int missed_ = 0;
  bool hidden_ = false;
};

}  // namespace touchtrace::label
