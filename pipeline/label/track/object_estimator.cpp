#include "pipeline/label/track/object_estimator.h"

#include "pipeline/label/estimate/box_planes.h"
#include "pipeline/label/estimate/sphere_fit.h"

namespace touchtrace::label {
namespace {

constexpr double view_reach_factor = 2.0;  // from a visible end of an object to its other end
constexpr double max_misfit_m = 0.01;      // median distance of an object's points from its body
constexpr std::size_t max_misfit_points = 200;

}  // namespace

ObjectEstimator::ObjectEstimator(const SceneModel& scene, const ClipFrames& clip)
    : scene_(scene), clip_(clip), shape_(scene.object_shape.at(clip.object)) {
  if (shape_.body) pose_.emplace(*shape_.body);
}

Observation ObjectEstimator::observe(const RgbdFrame& frame, std::size_t index, const Patch& patch,
                                     double seconds) {
  auto view = scene_.view_object(frame, clip_.object, patch, view_reach_factor * shape_.reach_m(),
                                 pose_.has_value());
  if (index == 0 && !clip_.has_mask_boxes)
    view.box = box_planes(scene_.segmenter->color_camera(), clip_.object_box, patch.centroid_m);
  Observation object{true, false, {}, {}, patch.box};
  const std::size_t points = view.surface_points.size();
  if (pose_) {
    posed_frames_.push_back({index, points, every_nth(view.surface_points, max_misfit_points)});
    set_position(object, pose_->update(view, seconds), points);
  } else {
    const auto fit = fit_sphere(view, shape_.radius_m);
    set_position(object, fit.centre_m, fit.information, points);
    camera_from_object_[index] = Eigen::Isometry3d(Eigen::Translation3d(fit.centre_m));
  }
  return object;
}

void ObjectEstimator::smooth_poses(std::vector<Observation>& observations) {
  if (!pose_) return;
  const auto fits = pose_->viterbi_path();
  const auto ambiguity_m2 = pose_->ambiguity_m2(fits);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    Observation& object = observations[posed_frames_[i].index];
    if (contradict(posed_frames_[i].surface_points, fits[i])) {
      object = {};
      continue;
    }
    set_position(object, fits[i], posed_frames_[i].num_points);
    object.sigma_m = (object.sigma_m.cwiseAbs2() + ambiguity_m2[i]).cwiseSqrt();
    camera_from_object_[posed_frames_[i].index] = fits[i].camera_from_body;
  }
}

std::optional<double> ObjectEstimator::median_distance_m(
    std::size_t index, const std::vector<Eigen::Vector3f>& points_m) const {
  const auto pose = camera_from_object_.find(index);
  if (pose == camera_from_object_.end()) return std::nullopt;
  const RoundedBody body = shape_.body.value_or(RoundedBody{{0.0, 0.0, 0.0}, shape_.radius_m});
  return label::median_distance_m(points_m, body, pose->second);
}

void ObjectEstimator::set_position(Observation& object, const BodyFit& fit,
                                   std::size_t num_points) const {
  set_position(object, fit.centre_m(), fit.centre_information(), num_points);
}

/// Sets position and standard deviation from a fit to so many points.
void ObjectEstimator::set_position(Observation& object, const Eigen::Vector3d& centre_m,
                                   const Eigen::Matrix3d& information,
                                   std::size_t num_points) const {
  const double visible = static_cast<double>(num_points) /
                         scene_.segmenter->disc_pixels(shape_.radius_m, centre_m.z());
  object.position_m = centre_m;
  object.sigma_m =
      position_sigma(information, visible, pose_ ? point_sigma_m : sphere_point_sigma_m);
}

/// Whether most points are far from the body: a wrong pose, or another body of its colour.
bool ObjectEstimator::contradict(const std::vector<Eigen::Vector3f>& points,
                                 const BodyFit& fit) const {
  return label::median_distance_m(points, *shape_.body, fit.camera_from_body) > max_misfit_m;
}

}  // namespace touchtrace::label
