#pragma once

#include <optional>

#include "pipeline/label/observe/lift.h"
#include "pipeline/label/track/box_tracker.h"
#include "pipeline/label/track/target_filter.h"

namespace touchtrace::label {

/// Hand or object in one clip: motion filter, image tracker and search for the surface patch.
class Target {
 public:
  /// `disc_radius_m`: of a disc with the body's visible area. `patch_radius_m`: of a ball that
  /// contains its visible surface. `min_points`: smallest accepted patch.
  Target(Body body, double disc_radius_m, double patch_radius_m, std::size_t min_points,
         const TrackerKind& kind)
      : body_(body),
        disc_radius_m_(disc_radius_m),
        patch_radius_m_(patch_radius_m),
        min_points_(min_points),
        tracker_(kind) {}

  /// Finds the patch in a user's box.
  std::optional<Patch> find_in_box(const Surface& surface, const PixelBox& box) const;

  /// Runs the image tracker around the predicted position.
  std::optional<PixelBox> update_tracker(const MaskedImage& image, const Camera& camera);

  /// Returns the body's surface patch [m, colour camera's frame], or nullopt. Does not update the
  /// filter. Mean shift starts at the predicted position, at `hint_m`, and at the medians of the
  /// body's points in `tracked_box` and in the gate; if hidden or lost, also at up to 16 points
  /// spread over all of them.
  /// d: distance to the prediction (if lost, the last position) or the hint, the smaller. Rejects
  ///  - d > gate_m() + patch_radius_m (1.4 m if hidden or lost);
  ///  - d > patch_radius_m + 0.04 m (0.15 m if lost, with hint) and under half the disc visible;
  ///  - likeness below -2, if hidden or lost -0.7, or on average over half a second below -0.9:
  ///    colours that are rare in the class;
  ///  - over 80 % of a disc of patch_radius_m covered: part of a larger surface;
  ///  - under 7 % of a hand's disc visible.
  /// Maximises patch_score() at d over the gate, or over arm_reach_m if lost. Failure stops the
  /// image tracker; a patch that does not match `tracked_box` restarts it.
  std::optional<Patch> find(const Surface& surface, const MaskedImage& image,
                            const std::optional<PixelBox>& tracked_box, const Segmenter& segmenter,
                            const std::optional<Eigen::Vector3d>& hint_m);

  /// Starts the filter and, unless `box` is empty, the image tracker.
  void start(const Eigen::Vector3d& position_m, double sigma_m, const PixelBox& box,
             const MaskedImage& image);
  void predict(double seconds, bool falling, const Eigen::Vector3d& gravity_m_per_s2) {
    since_find_s_ += seconds;
    filter_.predict(seconds, falling, gravity_m_per_s2);
  }
  /// Updates the filter; restarts it if the position is outside the gate.
  void measure(const Eigen::Vector3d& position_m, double sigma_m);

  /// Updates the filter with the assumed position of a body that is not visible. Until the next
  /// measure(), find() searches the whole surface.
  void set_hidden(const Eigen::Vector3d& position_m, double sigma_m);

  /// The patch that find() returned is another body's.
  void lose();

  double gate_m() const;
  /// Not found in the last three frames.
  bool is_lost() const;
  Eigen::Vector3d predicted_m() const { return filter_.position_m(); }
  /// Number of starts of the image tracker.
  int tracker_starts() const { return tracker_.starts(); }

 private:
  /// Updates the mean likeness. If the patch's colours have been unusual for a while, the target
  /// has slipped to another body: it is lost.
  bool is_usual(const Patch& patch);
  // Search limits; see find().
  double any_part_distance_m(bool has_hint) const;
  double max_distance_m() const;
  Eigen::Vector3d search_centre_m() const;
  double distance_scale_m() const;
  std::vector<Eigen::Vector3d> starts(const Surface& own,
                                      const std::optional<PixelBox>& tracked_box,
                                      const std::optional<Eigen::Vector3d>& hint_m) const;
  /// `own`: points of the body's class.
  std::optional<Patch> best_patch(const Surface& own, const Segmenter& segmenter,
                                  const std::vector<Eigen::Vector3d>& starts,
                                  const std::optional<Eigen::Vector3d>& hint_m) const;
  void restart_tracker(const MaskedImage& image, const PixelBox& box);

  TargetFilter filter_;
  Eigen::Vector3d last_m_ = Eigen::Vector3d::Zero();
  Body body_;
  double disc_radius_m_, patch_radius_m_;
  std::size_t min_points_;
  BoxTracker tracker_;
  int missed_frames_ = 0;
  double mean_likeness_ = 0.0, since_find_s_ = 0.0;
  bool is_hidden_ = false;
};

}  // namespace touchtrace::label
