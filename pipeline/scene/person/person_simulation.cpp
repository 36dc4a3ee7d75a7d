#include "pipeline/scene/person/person_simulation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double sliding_m_per_s = 0.002;
constexpr double grasp_s = 1.4, rotation_start_s = -0.7, rotation_end_s = -0.1;  // activity time
constexpr double weight_lag_s = 0.05;
constexpr double lever_lag_s = 0.02, min_lever_m = 0.01, max_lever_m = 0.08;
constexpr double max_height_m = 1.0;  // of the centre of mass over the palm
constexpr int thumb = num_fingers - 1;
constexpr std::array<double, thumb> finger_share{0.30, 0.30, 0.25, 0.15};

long ticks(double time_s) { return std::lround(time_s / control_interval_s); }

Eigen::Quaterniond random_turn(Hold::Turns turns, RandomStream& random) {
  constexpr double pi = std::numbers::pi;
  const auto right_angles = [&](const Vector3d& axis) {
    return Eigen::AngleAxisd(pi / 2 * static_cast<double>(random.below(4)), axis);
  };
  switch (turns) {
    case Hold::Turns::axis:
      return Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(-pi, pi), Vector3d::UnitY()));
    case Hold::Turns::faces: {
      const Eigen::Quaterniond face(right_angles(Vector3d::UnitX()));
      return face * right_angles(Vector3d::UnitY()) * right_angles(Vector3d::UnitZ());
    }
    case Hold::Turns::any:
      return Eigen::Quaterniond{random.normal(), random.normal(), random.normal(), random.normal()}
          .normalized();
    case Hold::Turns::none:
      break;
  }
  return Eigen::Quaterniond::Identity();
}

/// Random orientation of the grasped object, hand from object.
Eigen::Quaterniond draw_orientation(const Hold& hold, double yaw_rad, RandomStream& random) {
  Eigen::Matrix3d object_from_held;
  object_from_held << hold.across.cross(hold.from_palm), hold.across, hold.from_palm;
  const Eigen::Quaterniond turn = random_turn(hold.turns, random);
  const Eigen::AngleAxisd yaw(random.normal(0.0, yaw_rad), Vector3d::UnitZ());
  return yaw * turn * Eigen::Quaterniond(object_from_held).conjugate();
}

/// Applies the friction, drag and restitution factors of the parameters.
ObjectSpec apply_factors(ObjectSpec object, const SceneParameters& parameters) {
  object.friction *= parameters.objects.friction;
  if (!object.ball) return object;
  object.ball->drag_coefficient *= parameters.ball.drag;
  object.ball->restitution *= parameters.ball.restitution;
  object.ball->friction *= parameters.ball.friction;
  return object;
}

/// Smallest height of the object's origin above the palm without contact.
double clear_height_m(const HandModel& hand, const ObjectSpec& object,
                      const Eigen::Quaterniond& hand_from_object, const Vector3d& place) {
  double height = std::max(0.0, -(hand_from_object * object.hold.center_m).z());
  for (double step = 0.0005; height < max_height_m; height += step) {
    bool is_clear = true;
    for (const Taxel& taxel : hand.taxels)
      if (taxel.finger < 0)
        is_clear &= distance(object, hand_from_object.conjugate() *
                                         (taxel.position_m - place - height * Vector3d::UnitZ()))
                        .value_m > 0.0;
    if (is_clear) return height;
  }
  return height;
}

std::unique_ptr<Activity> make_activity(const SceneOptions& options, ActivityStart start) {
  const ActivityRow& row = find_activity(options.activity);
  require_compatible(row, start.object);
  return row.make(std::move(start));
}

}  // namespace

PersonSimulation::PersonSimulation(const SceneOptions& options, const std::string& name,
                                   double start_s, double step_s)
    : grasp_(options.parameters.grasp),
      world_(apply_factors(options.object, options.parameters), options.parameters.arm,
             options.parameters.contact, {}, options.parameters.fingers,
             hand_model(options.parameters.hand)),
      activity_(make_activity(options, {world_.spec(), RandomStream(options.seed, name + " motion"),
                                        options.parameters})),
      restitution_(options.seed, name + " restitution"),
      restitution_std_(options.parameters.ball.restitution_std),
      glove_(options.glove, options.parameters.glove, glove_clock(options), options.seed),
      start_s_(start_s),
      step_s_(step_s > 0.0 ? step_s : find_activity(options.activity).step_s),
      tick_(-ticks(grasp_s)) {
  RandomStream random(options.seed, name + " grasp");
  weight_error_ = grasp_.weight_error * random.normal();
  lever_m_.fill(0.04);
  rest_rad_.fill(0.3);
  world_.flexion_rad.fill(0.3);
  const Command first = activity_->command(-grasp_s, sample());
  const Vector3d fingers = first.orientation * Vector3d::UnitX();
  grasp_orientation_ = palm_up(0.0, 0.0, std::atan2(fingers.x(), -fingers.y()));
  place_object(first, random);
}

void PersonSimulation::place_object(const Command& command, RandomStream& random) {
  const Hold& hold = world_.spec().hold;
  const Vector3d over(grasp_center_m + grasp_.place_m * random.normal(),
                      grasp_.place_m * random.normal(), 0.0);
  const Eigen::Quaterniond hand_from_object = draw_orientation(hold, grasp_.yaw_rad, random);
  Vector3d place = over - hand_from_object * hold.center_m;
  place.z() = 0.0;
  const double height = clear_height_m(world_.model(), world_.spec(), hand_from_object, place);
  world_.hand.position_m = command.hand.position_m;
  world_.hand.orientation = wanted_orientation(command);
  world_.object.position_m =
      world_.hand.position_m + world_.hand.orientation * (place + height * Vector3d::UnitZ());
  world_.object.orientation = world_.hand.orientation * hand_from_object;
  placed_orientation_ = world_.object.orientation;
}

/// Whether the other hand still keeps a tool from tipping over while the fingers close around it.
bool PersonSimulation::is_steadied() const {
  return world_.spec().role == ObjectRole::tool && tick_ * control_interval_s < steadied_until_s;
}

void PersonSimulation::draw_restitution() {
  const double usual = world_.spec().ball->restitution;
  world_.restitution = std::clamp(restitution_.normal(usual, restitution_std_), 0.0, 1.0);
}

Eigen::Quaterniond PersonSimulation::wanted_orientation(const Command& command) const {
  const double progress = minimum_jerk_progress(tick_ * control_interval_s, rotation_start_s,
                                                rotation_end_s - rotation_start_s);
  return progress < 1.0 ? grasp_orientation_.slerp(progress, command.orientation)
                        : command.orientation;
}

FingerDrive PersonSimulation::finger_drive(const Command& command, int finger) {
  if (!command.closed_grip)
    return {0.0, grasp_.posture_stiffness_nm_per_rad, command.posture_rad[finger]};
  const double measured = world_.contact().lever_m(finger);
  if (measured <= 0.0)  // not in contact yet
    rest_rad_[finger] = world_.flexion_rad[finger];
  else
    lever_m_[finger] += (std::clamp(measured, min_lever_m, max_lever_m) - lever_m_[finger]) *
                        control_interval_s / lever_lag_s;
  rest_rad_[finger] += (world_.flexion_rad[finger] - rest_rad_[finger]) * control_interval_s /
                       grasp_.grip_relaxation_s;
  const double share = finger == thumb ? grasp_.thumb_share : finger_share[finger];
  return {share * command.grip_force_n * lever_m_[finger], grasp_.grip_stiffness_nm_per_rad,
          rest_rad_[finger]};
}

Drive PersonSimulation::drive_to(const Command& command) {
  Drive drive;
  drive.position_m = command.hand.position_m;
  drive.velocity_m_per_s = command.hand.velocity_m_per_s;
  drive.acceleration_m_per_s2 = command.hand.acceleration_m_per_s2;
  const Eigen::AngleAxisd turn(wanted_orientation(command) * world_.hand.orientation.conjugate());
  drive.angular_velocity_rad_per_s = turn.angle() / control_interval_s * turn.axis();
  const double time_s = std::max(0.0, tick_ * control_interval_s);
  const double believed_weight = 1 + weight_error_ * std::exp(-time_s / grasp_.adaptation_s);
  const double weight =
      command.carrying ? believed_weight * world_.spec().mass_kg * gravity_m_per_s2 : 0.0;
  fed_forward_n_ += (weight - fed_forward_n_) * control_interval_s / weight_lag_s;
  drive.carried_weight_n = fed_forward_n_;
  for (int i = 0; i < num_fingers; ++i) drive.fingers[i] = finger_drive(command, i);
  return drive;
}

void PersonSimulation::advance() {
  const Command command = activity_->command(tick_ * control_interval_s, sample());
  gripping_ = command.closed_grip;
  world_.advance(drive_to(command), control_interval_s, step_s_);
  if (is_steadied()) {
    world_.object.orientation = placed_orientation_;
    world_.object.angular_velocity_rad_per_s.setZero();
  }
  if (!world_.impacts().empty()) draw_restitution();
  ++tick_;
  const ContactPatch& contact = world_.contact();
  glove_.sense({contact.force_n(), contact.loaded()}, start_s_ + tick_ * control_interval_s,
               control_interval_s);
}

/// Whether the object slides in a closed hand, so that the grasp failed. False once a ball is in
/// play: the racket swings already.
bool PersonSimulation::is_sliding() const {
  const RigidState &held = world_.object, &hand = world_.hand;
  const Vector3d carried = hand.velocity_m_per_s +
                           hand.angular_velocity_rad_per_s.cross(held.position_m - hand.position_m);
  return gripping_ && !world_.ball && (held.velocity_m_per_s - carried).norm() > sliding_m_per_s;
}

bool PersonSimulation::grasp() {
  glove_.start(start_s_);
  while (tick_ < 0) advance();
  world_.ball = activity_->serve(sample());
  if (world_.ball) draw_restitution();
  return is_in_hand(world_.spec(), sample()) && !is_sliding() && !is_lost();
}

bool PersonSimulation::is_lost() const { return activity_->is_lost(sample()); }

SceneSample PersonSimulation::sample() const {
  SceneSample sample;
  sample.time_s = start_s_ + tick_ * control_interval_s;
  sample.hand = world_.hand;
  sample.object = world_.object;
  sample.ball = world_.ball;
  sample.flexion_rad = world_.flexion_rad;
  for (int i = -1; i < num_fingers; ++i) sample.grip_force_n += world_.contact().normal_force_n(i);
  sample.contact_force_n = world_.mean_force_n();
  return sample;
}

}  // namespace touchtrace::scene
