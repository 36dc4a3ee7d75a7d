#include "pipeline/scene/person/performance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/scene/objects/solids.h"

namespace touchtrace::scene {
namespace {

using Eigen::Vector3d;

constexpr double creeping_m_per_s = 0.002;
constexpr double grasp_s = 1.4, turn_start_s = -0.7, turn_end_s = -0.1;  // activity's time
constexpr double weight_lag_s = 0.05;
constexpr double lever_lag_s = 0.02, shortest_lever_m = 0.01, longest_lever_m = 0.08;
constexpr double tallest_m = 1.0;  // of what is put on the palm, from there to its centre of mass
constexpr int thumb = finger_count - 1;
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

/// As the object is held, turned at random in the ways that its shape allows.
Eigen::Quaterniond as_held(const Hold& hold, double yaw_rad, RandomStream& random) {
  Eigen::Matrix3d object_from_held;
  object_from_held << hold.across.cross(hold.from_palm), hold.across, hold.from_palm;
  const Eigen::Quaterniond turn = random_turn(hold.turns, random);
  const Eigen::AngleAxisd yaw(random.normal(0.0, yaw_rad), Vector3d::UnitZ());
  return yaw * turn * Eigen::Quaterniond(object_from_held).conjugate();
}

ObjectSpec as_assumed(ObjectSpec object, const SceneParameters& parameters) {
  object.friction *= parameters.objects.friction;
  if (!object.ball) return object;
  object.ball->drag_coefficient *= parameters.ball.drag;
  object.ball->restitution *= parameters.ball.restitution;
  object.ball->friction *= parameters.ball.friction;
  return object;
}

/// How far the origin of the object has to be above the palm so that nothing touches.
double height_over_palm_m(const HandModel& hand, const ObjectSpec& object,
                          const Eigen::Quaterniond& hand_from_object, const Vector3d& place) {
  double height = std::max(0.0, -(hand_from_object * object.hold.center_m).z());
  for (double step = 0.0005; height < tallest_m; height += step) {
    bool free = true;
    for (const Taxel& taxel : hand.taxels)
      if (taxel.finger < 0)
        free &= distance(object, hand_from_object.conjugate() *
                                     (taxel.position_m - place - height * Vector3d::UnitZ()))
                    .value_m > 0.0;
    if (free) return height;
  }
  return height;
}

std::unique_ptr<Activity> activity_of(const SceneOptions& options, ActivityStart start) {
  const ActivityRow& row = find_activity(options.activity);
  require_fit(row, start.object);
  return row.make(std::move(start));
}

}  // namespace

Performance::Performance(const SceneOptions& options, const std::string& name, double start_s,
                         double step_s)
    : grasp_(options.parameters.grasp),
      world_(as_assumed(options.object, options.parameters), options.parameters.arm,
             options.parameters.contact, {}, options.parameters.fingers,
             hand_model(options.parameters.hand)),
      activity_(activity_of(options, {world_.spec(), RandomStream(options.seed, name + " motion"),
                                      options.parameters})),
      restitution_(options.seed, name + " restitution"),
      restitution_spread_(options.parameters.ball.restitution_spread),
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
  taking_orientation_ = palm_up(0.0, 0.0, std::atan2(fingers.x(), -fingers.y()));
  place_object(first, random);
}

void Performance::place_object(const Command& command, RandomStream& random) {
  const Hold& hold = world_.spec().hold;
  const Vector3d over(grasp_middle_m + grasp_.place_m * random.normal(),
                      grasp_.place_m * random.normal(), 0.0);
  const Eigen::Quaterniond hand_from_object = as_held(hold, grasp_.yaw_rad, random);
  Vector3d place = over - hand_from_object * hold.center_m;
  place.z() = 0.0;
  const double height = height_over_palm_m(world_.model(), world_.spec(), hand_from_object, place);
  world_.hand.position_m = command.hand.position_m;
  world_.hand.orientation = wanted_orientation(command);
  world_.object.position_m =
      world_.hand.position_m + world_.hand.orientation * (place + height * Vector3d::UnitZ());
  world_.object.orientation = world_.hand.orientation * hand_from_object;
  put_orientation_ = world_.object.orientation;
}

/// The other hand keeps a tool from tipping over while the fingers close around it.
bool Performance::steadied() const {
  return world_.spec().role == ObjectRole::tool && tick_ * control_interval_s < steadied_until_s;
}

/// Rubbers are not the same everywhere.
void Performance::vary_restitution() {
  const double usual = world_.spec().ball->restitution;
  world_.restitution = std::clamp(restitution_.normal(usual, restitution_spread_), 0.0, 1.0);
}

Eigen::Quaterniond Performance::wanted_orientation(const Command& command) const {
  const double turned =
      passage(tick_ * control_interval_s, turn_start_s, turn_end_s - turn_start_s);
  return turned < 1.0 ? taking_orientation_.slerp(turned, command.orientation)
                      : command.orientation;
}

FingerDrive Performance::finger_drive(const Command& command, int finger) {
  if (!command.closed_grip)
    return {0.0, grasp_.posture_stiffness_nm_per_rad, command.posture_rad[finger]};
  const double measured = world_.contact().lever_m(finger);
  if (measured <= 0.0)  // still closing
    rest_rad_[finger] = world_.flexion_rad[finger];
  else
    lever_m_[finger] +=
        (std::clamp(measured, shortest_lever_m, longest_lever_m) - lever_m_[finger]) *
        control_interval_s / lever_lag_s;
  rest_rad_[finger] += (world_.flexion_rad[finger] - rest_rad_[finger]) * control_interval_s /
                       grasp_.grip_relaxation_s;
  const double share = finger == thumb ? grasp_.thumb_share : finger_share[finger];
  return {share * command.grip_force_n * lever_m_[finger], grasp_.grip_stiffness_nm_per_rad,
          rest_rad_[finger]};
}

Drive Performance::drive_to(const Command& command) {
  Drive drive;
  drive.position_m = command.hand.position_m;
  drive.velocity_m_per_s = command.hand.velocity_m_per_s;
  drive.acceleration_m_per_s2 = command.hand.acceleration_m_per_s2;
  const Eigen::AngleAxisd turn(wanted_orientation(command) * world_.hand.orientation.conjugate());
  drive.angular_velocity_rad_per_s = turn.angle() / control_interval_s * turn.axis();
  const double time_s = std::max(0.0, tick_ * control_interval_s);
  const double believed = 1 + weight_error_ * std::exp(-time_s / grasp_.adaptation_s);
  const double weight =
      command.carrying ? believed * world_.spec().mass_kg * gravity_m_per_s2 : 0.0;
  fed_forward_n_ += (weight - fed_forward_n_) * control_interval_s / weight_lag_s;
  drive.carried_weight_n = fed_forward_n_;
  for (int i = 0; i < finger_count; ++i) drive.fingers[i] = finger_drive(command, i);
  return drive;
}

void Performance::advance() {
  const Command command = activity_->command(tick_ * control_interval_s, sample());
  gripping_ = command.closed_grip;
  world_.advance(drive_to(command), control_interval_s, step_s_);
  if (steadied()) {
    world_.object.orientation = put_orientation_;
    world_.object.angular_velocity_rad_per_s.setZero();
  }
  if (!world_.impacts().empty()) vary_restitution();
  ++tick_;
  const ContactPatch& contact = world_.contact();
  glove_.sense({contact.force_n(), contact.loaded()}, start_s_ + tick_ * control_interval_s,
               control_interval_s);
}

/// What creeps out of a closed hand has not been got hold of. A racket swings already.
bool Performance::creeping() const {
  const RigidState &held = world_.object, &hand = world_.hand;
  const Vector3d carried = hand.velocity_m_per_s +
                           hand.angular_velocity_rad_per_s.cross(held.position_m - hand.position_m);
  return gripping_ && !world_.ball && (held.velocity_m_per_s - carried).norm() > creeping_m_per_s;
}

bool Performance::grasp() {
  glove_.start(start_s_);
  while (tick_ < 0) advance();
  world_.ball = activity_->serve(sample());
  if (world_.ball) vary_restitution();
  return in_hand(world_.spec(), sample()) && !creeping() && !lost();
}

bool Performance::lost() const { return activity_->lost(sample()); }

SceneSample Performance::sample() const {
  SceneSample sample;
  sample.time_s = start_s_ + tick_ * control_interval_s;
  sample.hand = world_.hand;
  sample.object = world_.object;
  sample.ball = world_.ball;
  sample.flexion_rad = world_.flexion_rad;
  for (double flexion : world_.flexion_rad)
    sample.finger_closure += flexion / (max_flexion_rad * finger_count);
  for (int i = -1; i < finger_count; ++i) sample.grip_force_n += world_.contact().normal_force_n(i);
  sample.contact_force_n = world_.mean_force_n();
  return sample;
}

}  // namespace touchtrace::scene
