#pragma once

#include "pipeline/scene/glove/glove.h"
#include "pipeline/scene/person/activity.h"
#include "pipeline/scene/physics/world.h"

namespace touchtrace::scene {

/// A person with a glove who takes an object and performs an activity with it, one control interval
/// after the other. Its time 0 is `start_s` of the host's clock; before it the object is taken into
/// the hand.
class Performance {
 public:
  /// `name` names the random streams; `step_s` is the physics' step, on which no random number
  /// depends.
  Performance(const SceneOptions& options, const std::string& name, double start_s,
              double step_s = 0.0);

  /// From putting the object on the palm to time 0; false if it fell.
  bool grasp();
  void advance();
  /// Whether the activity is over: what it is done with was dropped or missed.
  bool lost() const;
  SceneSample sample() const;

  Glove& glove() { return glove_; }
  const World& world() const { return world_; }

 private:
  Drive drive_to(const Command& command);
  FingerDrive finger_drive(const Command& command, int finger);
  Eigen::Quaterniond wanted_orientation(const Command& command) const;
  void vary_restitution();
  bool steadied() const;
  bool creeping() const;
  void place_object(const Command& command, RandomStream& random);

  GraspParameters grasp_;
  World world_;
  std::unique_ptr<Activity> activity_;
  RandomStream restitution_;
  double restitution_spread_;
  Glove glove_;
  double start_s_, step_s_;
  long tick_;            ///< control intervals since time 0
  double weight_error_;  ///< of the weight fed forward, at time 0
  double fed_forward_n_ = 0.0;
  std::array<double, finger_count> lever_m_, rest_rad_;
  /// Of the hand while it takes the object; of the object as it is put there.
  Eigen::Quaterniond taking_orientation_ = Eigen::Quaterniond::Identity(), put_orientation_;
  bool gripping_ = false;
};

}  // namespace touchtrace::scene
