#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "pipeline/label/estimate/pose_tracker.h"
#include "pipeline/label/learn/scene_model.h"
#include "pipeline/label/track/observation.h"

namespace touchtrace::label {

/// Estimates the positions of an object in one pass through a clip: the centre of a sphere that is
/// fitted in each frame, or that of the learnt body, whose poses all frames choose together.
class ObjectEstimator {
 public:
  /// `scene` and `clip` must outlive this.
  ObjectEstimator(const SceneModel& scene, const ClipFrames& clip);

  /// Observes the object whose surface patch is visible in `frame`, number `index` of the pass,
  /// `seconds` after the last frame in which it was visible. Frame 0 is that of the boxes.
  Observation observe(const RgbdFrame& frame, std::size_t index, const Patch& patch,
                      double seconds);

  /// Replaces a body's poses by the most likely ones given all frames. Where the points contradict
  /// them, the object is lost. `observations`: of all frames of the pass.
  void smooth_poses(std::vector<Observation>& observations);

  /// Median distance [m] of points in frame `index` from the object's surface, after
  /// smooth_poses(); nullopt where the object is not found.
  std::optional<double> median_distance_m(std::size_t index,
                                          const std::vector<Eigen::Vector3f>& points_m) const;

 private:
  /// Frame with a pose, its number of surface points, and some of these.
  struct PosedFrame {
    std::size_t index, num_points;
    std::vector<Eigen::Vector3f> surface_points;
  };

  void set_position(Observation& object, const Eigen::Vector3d& centre_m,
                    const Eigen::Matrix3d& information, std::size_t num_points) const;
  void set_position(Observation& object, const BodyFit& fit, std::size_t num_points) const;
  bool contradict(const std::vector<Eigen::Vector3f>& points, const BodyFit& fit) const;

  const SceneModel& scene_;
  const ClipFrames& clip_;
  const ObjectShape& shape_;
  std::optional<PoseTracker> pose_;  ///< of a body; nullopt: the object is a sphere
  std::vector<PosedFrame> posed_frames_;
  std::map<std::size_t, Eigen::Isometry3d> camera_from_object_;  ///< by frame
};

}  // namespace touchtrace::label
