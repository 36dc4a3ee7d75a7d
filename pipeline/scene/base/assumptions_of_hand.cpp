#include "pipeline/scene/base/assumption_rows.h"

namespace touchtrace::scene {
namespace {

void add_contact(AssumptionTable& table) {
  using P = ContactParameters;
  AssumptionRows<P> row(table, "contact", &SceneParameters::contact);
  row("stiffness", &P::stiffness_n_per_m3, "N/m^3", 1e5, 1e9, "k of the foundation",
      "form: Johnson 1985, value: no", "a 170 g ball sinks 1-2 mm into palm and glove");
  row("hardening", &P::hardening_m, "m", 5e-4, 1.0, "l of the foundation",
      "form: Pawluk and Howe 1999, value: no", "a 170 g ball sinks 1-2 mm into palm and glove");
  row("dissipation", &P::dissipation_s_per_m, "s/m", 0.0, 100.0, "c of the foundation",
      "form: Hunt and Crossley 1975, value: no",
      "a ball dropped from 5 cm rebounds to about 7 % of its height");
  row("bristle", &P::bristle_ratio, "", 0.01, 10.0,
      "tangential over normal stiffness, with the same relative damping",
      "near Mindlin's 2 (1 - nu) / (2 - nu)", "soft tissue, nu about 0.5");
  row("clamp", &P::clamp_m, "m", 1e-3, 0.1, "deepest indentation; deeper is counted and clamped",
      "no", "thickness of the tissue over the bones");
}

void add_arm(AssumptionTable& table) {
  using P = ArmParameters;
  AssumptionRows<P> row(table, "arm", &SceneParameters::arm);
  row("mass", &P::mass_kg, "kg", 0.1, 20.0, "effective, of the hand", "fits 0.9-3 kg",
      "the middle of the fits");
  row("stiffness", &P::stiffness_n_per_m, "N/m", 10.0, 1e5, "to where the hand is wanted",
      "fits 135-500 N/m", "the middle of the fits");
  row("damping", &P::damping_ratio, "", 0.01, 10.0, "damping ratio of the two", "no",
      "an arm that is led to a place hardly swings");
  row("bound", &P::force_bound_n, "N", 10.0, 1e4, "greatest force", "no",
      "a guess; the fits have no bound");
}

void add_hand(AssumptionTable& table) {
  using P = HandParameters;
  AssumptionRows<P> row(table, "hand", &SceneParameters::hand);
  row("hollow", &P::hollow_m, "m", 0.05, 10.0, "radius of the palm's hollow", "no",
      "a cupped hand, a guess");
  row("heel", &P::heel_m, "m", 0.02, 10.0,
      "radius in which the palm's heel rises, by 11 mm at its end", "no", "thenar and hypothenar");
  row("middle-joint", &P::middle_joint, "", 0.1, 2.0,
      "turn of a finger's second joint, of its first", "near-linear synergies: yes, value: no",
      "a fist closes evenly");
  row("last-joint", &P::last_joint, "", 0.1, 2.0, "the same of its third",
      "near-linear synergies: yes, value: no", "two thirds of the second");
  row("thumb-joint", &P::thumb_joint, "", 0.1, 2.0, "the same of the thumb's second",
      "near-linear synergies: yes, value: no", "a guess");
}

void add_fingers(AssumptionTable& table) {
  using P = FingerParameters;
  AssumptionRows<P> row(table, "finger", &SceneParameters::fingers);
  row("inertia", &P::inertia_kg_m2, "kg m^2", 1e-6, 1e-2, "about the first joint",
      "order of magnitude", "quasi-static fingers");
  row("damping", &P::damping_nm_s_per_rad, "N m s/rad", 0.0, 1.0, "of the first joint",
      "order of magnitude", "quasi-static fingers");
}

void add_grasp(AssumptionTable& table) {
  using P = GraspParameters;
  AssumptionRows<P> row(table, "grasp", &SceneParameters::grasp);
  row("weight-error", &P::weight_error, "", 0.0, 1.0,
      "deviation of the weight fed forward, of the weight",
      "adaptation: Johansson and Westling 1988, value: no", "first lifts are wrong");
  row("adaptation", &P::adaptation_s, "s", 0.01, 100.0, "in which that error decays",
      "adaptation: Johansson and Westling 1988, value: no", "later lifts are not wrong");
  row("stiffness", &P::grip_stiffness_nm_per_rad, "N m/rad", 0.0, 100.0,
      "of a gripping finger's first joint", "0.5-3 N m/rad", "short-range stiffness of muscle");
  row("relaxation", &P::grip_relaxation_s, "s", 0.01, 100.0, "in which that stiffness gives way",
      "no", "short-range stiffness does not last");
  row("posture", &P::posture_stiffness_nm_per_rad, "N m/rad", 0.01, 100.0,
      "of the first joint of a finger that is held open", "0.5-3 N m/rad", "the upper end");
  row("thumb", &P::thumb_share, "", 0.0, 10.0, "its force, of the four fingers' together",
      "shares near published ones", "the thumb opposes the fingers");
  row("place", &P::place_m, "m", 0.0, 0.03, "deviation of the object's place in the hand", "no",
      "every clip is a new grasp");
  row("yaw", &P::yaw_rad, "rad", 0.0, 1.5, "deviation of the object's direction in the hand", "no",
      "every clip is a new grasp");
  row("attempts", &P::attempts, "", 1.0, 100.0, "to take the object before a clip begins", "no",
      "a person who has not got hold of it tries again; drops within the clip are marked");
}

void add_objects(AssumptionTable& table) {
  using P = ObjectParameters;
  AssumptionRows<P> row(table, "object", &SceneParameters::objects);
  row("friction", &P::friction, "", 0.0, 10.0, "times the 0.6-0.8 of the objects' files", "no",
      "coated textile against plastics, wood, rubber");
}

}  // namespace

void add_hand_assumptions(AssumptionTable& table) {
  add_contact(table);
  add_arm(table);
  add_hand(table);
  add_fingers(table);
  add_grasp(table);
  add_objects(table);
}

}  // namespace touchtrace::scene
