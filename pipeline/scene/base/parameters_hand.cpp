#include "pipeline/scene/base/parameter_rows.h"

namespace touchtrace::scene {
namespace {

void add_contact(ParameterTable& table) {
  using P = ContactParameters;
  ParameterRows<P> row(table, "contact", &SceneParameters::contact);
  row("stiffness", &P::stiffness_n_per_m3, "N/m^3", 1e5, 1e9,
      "stiffness k of the Winkler foundation", "Johnson 1985 (form only)",
      "a 170 g ball sinks 1-2 mm into palm and glove");
  row("hardening", &P::hardening_m, "m", 5e-4, 1.0, "hardening length l of the foundation",
      "Pawluk and Howe 1999 (form only)", "a 170 g ball sinks 1-2 mm into palm and glove");
  row("dissipation", &P::dissipation_s_per_m, "s/m", 0.0, 100.0,
      "damping factor c of the foundation", "Hunt and Crossley 1975 (form only)",
      "a ball dropped from 5 cm rebounds to about 7 % of its height");
  row("bristle", &P::bristle_ratio, "", 0.01, 10.0,
      "tangential over normal stiffness, with the same relative damping",
      "near Mindlin's 2 (1 - nu) / (2 - nu)", "soft tissue, nu about 0.5");
  row("max-depth", &P::max_depth_m, "m", 1e-3, 0.1,
      "largest valid indentation; deeper contacts are counted and clamped", "",
      "thickness of the tissue over the bones");
}

void add_arm(ParameterTable& table) {
  using P = ArmParameters;
  ParameterRows<P> row(table, "arm", &SceneParameters::arm);
  row("mass", &P::mass_kg, "kg", 0.1, 20.0, "effective mass of the hand", "fits: 0.9-3 kg",
      "middle of the fits");
  row("stiffness", &P::stiffness_n_per_m, "N/m", 10.0, 1e5,
      "stiffness of the spring to the commanded hand position", "fits: 135-500 N/m",
      "middle of the fits");
  row("damping", &P::damping_ratio, "", 0.01, 10.0, "damping ratio of mass and spring", "",
      "an arm guided to a position hardly oscillates");
  row("max-force", &P::max_force_n, "N", 10.0, 1e4, "largest force of the arm", "",
      "a guess; the fits have no bound");
}

void add_hand(ParameterTable& table) {
  using P = HandParameters;
  ParameterRows<P> row(table, "hand", &SceneParameters::hand);
  row("hollow", &P::hollow_radius_m, "m", 0.05, 10.0, "radius of curvature of the palm's hollow",
      "", "a cupped hand, a guess");
  row("heel", &P::heel_radius_m, "m", 0.02, 10.0,
      "radius of curvature of the palm's heel, which rises by 11 mm at its end", "",
      "thenar and hypothenar");
  row("middle-joint", &P::middle_joint_ratio, "", 0.1, 2.0,
      "angle of a finger's second joint over that of its first",
      "near-linear synergies (form only)", "a fist closes evenly");
  row("last-joint", &P::last_joint_ratio, "", 0.1, 2.0,
      "angle of a finger's third joint over that of its first", "near-linear synergies (form only)",
      "two thirds of the second");
  row("thumb-joint", &P::thumb_joint_ratio, "", 0.1, 2.0,
      "angle of the thumb's second joint over that of its first",
      "near-linear synergies (form only)", "a guess");
}

void add_fingers(ParameterTable& table) {
  using P = FingerParameters;
  ParameterRows<P> row(table, "finger", &SceneParameters::fingers);
  row("inertia", &P::inertia_kg_m2, "kg m^2", 1e-6, 1e-2,
      "moment of inertia of a finger about its first joint", "order of magnitude",
      "quasi-static fingers");
  row("damping", &P::damping_nm_s_per_rad, "N m s/rad", 0.0, 1.0, "damping of the first joint",
      "order of magnitude", "quasi-static fingers");
}

void add_grasp(ParameterTable& table) {
  using P = GraspParameters;
  constexpr const char* johansson = "Johansson and Westling 1988 (form only)";
  ParameterRows<P> row(table, "grasp", &SceneParameters::grasp);
  row("weight-error", &P::weight_error, "", 0.0, 1.0,
      "standard deviation of the relative error of the weight that is fed forward", johansson,
      "first lifts are wrong");
  row("adaptation", &P::adaptation_s, "s", 0.01, 100.0, "time constant in which that error decays",
      johansson, "later lifts are not wrong");
  row("stiffness", &P::grip_stiffness_nm_per_rad, "N m/rad", 0.0, 100.0,
      "stiffness of the first joint of a gripping finger", "0.5-3 N m/rad",
      "short-range stiffness of muscle");
  row("relaxation", &P::grip_relaxation_s, "s", 0.01, 100.0,
      "time constant in which that stiffness relaxes", "", "short-range stiffness does not last");
  row("posture-stiffness", &P::posture_stiffness_nm_per_rad, "N m/rad", 0.01, 100.0,
      "stiffness of the first joint of a finger that is held open", "0.5-3 N m/rad",
      "upper end of the range");
  row("thumb-share", &P::thumb_share, "", 0.0, 10.0,
      "force of the thumb over that of the four fingers together", "near published shares",
      "the thumb opposes the fingers");
  row("place", &P::place_m, "m", 0.0, 0.03,
      "standard deviation of the object's position in the hand", "", "every clip is a new grasp");
  row("yaw", &P::yaw_rad, "rad", 0.0, 1.5,
      "standard deviation of the object's direction in the hand", "", "every clip is a new grasp");
  row("attempts", &P::attempts, "", 1.0, 100.0,
      "largest number of attempts to grasp the object before a clip begins", "",
      "a person tries again; drops within the clip are marked");
}

void add_objects(ParameterTable& table) {
  using P = ObjectParameters;
  ParameterRows<P> row(table, "object", &SceneParameters::objects);
  row("friction", &P::friction, "", 0.0, 10.0,
      "factor of the objects' friction coefficients (0.6-0.8 in their files)", "",
      "coated textile against plastics, wood, rubber");
}

}  // namespace

void add_hand_parameters(ParameterTable& table) {
  add_contact(table);
  add_arm(table);
  add_hand(table);
  add_fingers(table);
  add_grasp(table);
  add_objects(table);
}

}  // namespace touchtrace::scene
