#include "pipeline/scene/physics/hand.h"

#include <cmath>
#include <map>
#include <mutex>
#include <numbers>

#include "pipeline/scene/objects/sin_cos.h"

namespace touchtrace::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double palm_half_length_m = 0.045, palm_half_width_m = 0.042;
constexpr double heel_start_m = -0.010;
constexpr double taxel_fan_rad = std::numbers::pi / 3;  // on either side of a finger's palmar line

/// Base frame of the thumb: x along it, z out of its pad, so that flexion closes it over the palm.
Matrix3d thumb_base() {
  const Vector3d x = Vector3d(-0.25, 0.05, 0.95).normalized(), pad(0.92, 0.35, 0.0);
  const Vector3d z = (pad - x * x.dot(pad)).normalized();
  Matrix3d base;
  base << x, z.cross(x), z;
  return base;
}

/// The flexion planes lean towards the middle of the hand, because flexed fingers converge (on the
/// scaphoid).
Finger long_finger(double y, double length, const HandParameters& shape) {
  constexpr double lean_rad_per_m = 12.0;
  const Matrix3d lean = Eigen::AngleAxisd(lean_rad_per_m * y, Vector3d::UnitX()).toRotationMatrix();
  return {{palm_half_length_m, y, -0.003},
          lean,
          3,
          {0.45 * length, 0.30 * length, 0.25 * length},
          {1.0, shape.middle_joint_ratio, shape.last_joint_ratio},
          0.0085};
}

std::array<Finger, num_fingers> make_fingers(const HandParameters& shape) {
  const Finger thumb{{-0.036, -0.026, 0.006},
                     thumb_base(),
                     2,
                     {0.038, 0.032, 0.0},
                     {1.0, shape.thumb_joint_ratio, 0.0},
                     0.010};
  return {long_finger(-0.032, 0.075, shape), long_finger(-0.011, 0.083, shape),
          long_finger(0.011, 0.078, shape), long_finger(0.032, 0.062, shape), thumb};
}

void add_group(HandModel& model, int finger, int link, int first) {
  const int count = static_cast<int>(model.taxels.size()) - first;
  Vector3d centre = Vector3d::Zero();
  for (int i = first; i < first + count; ++i) centre += model.taxels[i].position_m / count;
  double radius = 0.0;
  for (int i = first; i < first + count; ++i)
    radius = std::max(radius, (model.taxels[i].position_m - centre).norm());
  model.groups.push_back({finger, link, first, count, centre, radius});
}

/// Height of the palm's surface: a shallow dish that rises to thenar and hypothenar at the heel.
double palm_height_m(double x, double y, const HandParameters& shape) {
  const double heel = std::max(0.0, heel_start_m - x);
  return (x * x + y * y) / (2 * shape.hollow_radius_m) + heel * heel / (2 * shape.heel_radius_m);
}

/// Adds an eighth of the palm: 7 x 4 of its 14 x 16 taxels.
void add_palm_group(HandModel& model, const HandParameters& shape, int first_row, int first_col) {
  constexpr int rows = 14, cols = 16, image_row = 18, image_col = 4;
  constexpr double row_pitch = 2 * palm_half_length_m / rows,
                   col_pitch = 2 * palm_half_width_m / cols;
  const int first = static_cast<int>(model.taxels.size());
  for (int row = first_row; row < first_row + rows / 2; ++row)
    for (int col = first_col; col < first_col + cols / 4; ++col) {
      const double x = palm_half_length_m - (row + 0.5) * row_pitch;
      const double y = (col + 0.5) * col_pitch - palm_half_width_m;
      model.taxels.push_back({-1,
                              0,
                              {x, y, palm_height_m(x, y, shape)},
                              row_pitch * col_pitch,
                              image_row + row,
                              image_col + col});
    }
  add_group(model, -1, 0, first);
}

/// Adds `rows` x 6 taxels on the palmar side of a link; image rows run from tip to base.
void add_link(HandModel& model, int finger, int link, int rows, int image_row, int image_col) {
  constexpr int around = 6;
  const Finger& f = model.fingers[finger];
  const double pitch = f.length_m[link] / rows, arc = 2 * taxel_fan_rad / around;
  const int first = static_cast<int>(model.taxels.size());
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < around; ++col) {
      const double angle = (col + 0.5) * arc - taxel_fan_rad;
      const Vector3d position(f.length_m[link] - (row + 0.5) * pitch, f.radius_m * std::sin(angle),
                              f.radius_m * std::cos(angle));
      model.taxels.push_back(
          {finger, link, position, pitch * arc * f.radius_m, image_row + row, image_col + col});
    }
  add_group(model, finger, link, first);
}

HandModel make_hand(const HandParameters& shape) {
  HandModel model{make_fingers(shape), {}, {}};
  for (int row : {0, 7})
    for (int col : {0, 4, 8, 12}) add_palm_group(model, shape, row, col);
  for (int finger = 0; finger < 4; ++finger)
    for (int link = 0; link < 3; ++link)
      add_link(model, finger, link, 5, 5 * (2 - link), 6 * finger);
  for (int link = 0; link < 2; ++link) add_link(model, 4, link, 8, 16 + 8 * (1 - link), 26);
  return model;
}

}  // namespace

const HandModel& hand_model(const HandParameters& shape) {
  static std::mutex mutex;
  static std::map<HandParameters, HandModel> models;
  const std::lock_guard lock(mutex);
  const auto known = models.find(shape);
  return known != models.end() ? known->second
                               : models.emplace(shape, make_hand(shape)).first->second;
}

FingerPose pose_finger(const Finger& finger, double flexion_rad) {
  FingerPose pose;
  pose.axis = -finger.hand_from_base.col(1);
  Vector3d joint = finger.base_m;
  const auto& coupling = finger.coupling;
  const double second = coupling[0] + coupling[1];
  const SinCos first = sin_cos(flexion_rad * Lanes{coupling[0], second}),
               last = sin_cos(broadcast(flexion_rad * (second + coupling[2])));
  const double sines[]{first.sine[0], first.sine[1], last.sine[0]},
      cosines[]{first.cosine[0], first.cosine[1], last.cosine[0]};
  for (int link = 0; link < finger.links; ++link) {
    const double c = cosines[link], s = sines[link];
    const auto x = finger.hand_from_base.col(0), z = finger.hand_from_base.col(2);
    pose.hand_from_link[link] << c * x + s * z, finger.hand_from_base.col(1), c * z - s * x;
    pose.joint_m[link] = joint;
    joint += finger.length_m[link] * pose.hand_from_link[link].col(0);
  }
  return pose;
}

}  // namespace touchtrace::scene
