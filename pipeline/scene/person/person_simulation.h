#pragma once

#include "pipeline/scene/glove/glove.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/physics/world.h"

namespace touchtrace::scene {

/// Simulation of a person with a glove who grasps an object and performs an activity: in every
/// control interval a command, physics, glove. The activity's time 0 is `start_s` on the host
/// clock; the object is grasped before it.
class PersonSimulation {
 public:
  /// `name` names the random streams. `step_s` overrides the activity's physics step if positive;
  /// no random number depends on it.
  PersonSimulation(const SceneOptions& options, const std::string& name, double start_s,
                   double step_s = 0.0);

  /// Simulates from putting the object on the palm to time 0. Returns whether the object is held.
  bool grasp();
  /// Simulates one control interval.
  void advance();
  /// Whether the object was dropped or the ball missed.
  bool is_lost() const;
  SceneSample sample() const;

  Glove& glove() { return glove_; }
  const World& world() const { return world_; }

 private:
  Drive drive_to(const Command& command);
  FingerDrive finger_drive(const Command& command, int finger);
  Eigen::Quaterniond wanted_orientation(const Command& command) const;
  void draw_restitution();
  bool is_steadied() const;
  bool is_sliding() const;
  void place_object(const Command& command, RandomStream& random);

  GraspParameters grasp_;
  World world_;
  std::unique_ptr<Activity> activity_;
  RandomStream restitution_;
  double restitution_std_;
  Glove glove_;
  double start_s_, step_s_;
  long tick_;            ///< control intervals since time 0
  double weight_error_;  ///< relative, of the fed-forward weight at time 0
  double fed_forward_n_ = 0.0;
  std::array<double, num_fingers> lever_m_, rest_rad_;
  Eigen::Quaterniond grasp_orientation_ = Eigen::Quaterniond::Identity();  ///< of the hand
  Eigen::Quaterniond placed_orientation_;                                  ///< of the object
  bool gripping_ = false;
};

}  // namespace touchtrace::scene
