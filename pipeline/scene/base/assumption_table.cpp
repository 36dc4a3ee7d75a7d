#include "pipeline/scene/base/assumptions.h"
#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {
namespace {

std::span<double> numbers_in(double& value) { return {&value, 1}; }
template <std::size_t Size>
std::span<double> numbers_in(std::array<double, Size>& values) {
  return values;
}

using Table = std::vector<Assumption>;

/// Adds rows of one part.
template <class Part>
class Rows {
 public:
  Rows(Table& table, std::string part, Part SceneParameters::*member)
      : table_(table), part_(std::move(part)), member_(member) {}

  template <class Value>
  void operator()(const char* name, Value Part::*value, const char* unit, double least, double most,
                  const char* meaning, const char* published, const char* reason) {
    table_.push_back({part_, part_ + "-" + name, unit, least, most, meaning, published, reason,
                      [member = member_, value](SceneParameters& parameters) {
                        return numbers_in(parameters.*member.*value);
                      }});
  }

 private:
  Table& table_;
  std::string part_;
  Part SceneParameters::*member_;
};

void add_contact(Table& table) {
  using P = ContactParameters;
  Rows<P> row(table, "contact", &SceneParameters::contact);
  row("stiffness", &P::stiffness_n_per_m3, "N/m^3", 1e5, 1e9, "k of the foundation",
      "form: Johnson 1985, value: no", "a 170 g ball sinks 1-2 mm into palm and glove");
  row("hardening", &P::hardening_m, "m", 1e-4, 1.0, "d0 of the foundation", "no",
      "a 170 g ball sinks 1-2 mm into palm and glove");
  row("dissipation", &P::dissipation_s_per_m, "s/m", 0.0, 100.0, "c of the foundation",
      "form: Hunt and Crossley 1975, value: no",
      "a ball dropped from 5 cm rebounds to about 7 % of its height");
  row("bristle", &P::bristle_ratio, "", 0.01, 10.0,
      "tangential over normal stiffness, with the same relative damping",
      "near Mindlin's 2 (1 - nu) / (2 - nu)", "soft tissue, nu about 0.5");
  row("clamp", &P::clamp_m, "m", 1e-3, 0.1, "deepest indentation; deeper is counted and clamped",
      "no", "thickness of the tissue over the bones");
}

void add_arm(Table& table) {
  using P = ArmParameters;
  Rows<P> row(table, "arm", &SceneParameters::arm);
  row("mass", &P::mass_kg, "kg", 0.1, 20.0, "effective, of the hand", "fits 0.9-3 kg",
      "the middle of the fits");
  row("stiffness", &P::stiffness_n_per_m, "N/m", 10.0, 1e5, "to where the hand is wanted",
      "fits 135-500 N/m", "the middle of the fits");
  row("damping", &P::damping_ratio, "", 0.01, 10.0, "damping ratio of the two", "no",
      "an arm that is led to a place hardly swings");
  row("bound", &P::force_bound_n, "N", 10.0, 1e4, "greatest force", "no",
      "a guess; the fits have no bound");
}

void add_hand(Table& table) {
  using P = HandParameters;
  Rows<P> row(table, "hand", &SceneParameters::hand);
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

void add_fingers(Table& table) {
  using P = FingerParameters;
  Rows<P> row(table, "finger", &SceneParameters::fingers);
  row("inertia", &P::inertia_kg_m2, "kg m^2", 1e-6, 1e-2, "about the first joint",
      "order of magnitude", "quasi-static fingers");
  row("damping", &P::damping_nm_s_per_rad, "N m s/rad", 0.0, 1.0, "of the first joint",
      "order of magnitude", "quasi-static fingers");
}

void add_grasp(Table& table) {
  using P = GraspParameters;
  Rows<P> row(table, "grasp", &SceneParameters::grasp);
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

void add_objects(Table& table) {
  using P = ObjectParameters;
  Rows<P> row(table, "object", &SceneParameters::objects);
  row("friction", &P::friction, "", 0.0, 10.0, "times the 0.6-0.8 of the objects' files", "no",
      "coated textile against plastics, wood, rubber");
}

void add_wave(Table& table) {
  using P = WaveParameters;
  Rows<P> row(table, "wave", &SceneParameters::wave);
  row("replanned", &P::replanned, "", 0.5, 1.0,
      "share of a sub-movement after which the next one begins",
      "minimum jerk: Flash and Hogan 1985, share: no", "fluent movement");
  row("repeats", &P::repeats, "", 1.0, 100.0, "of to and fro in a bout, whole numbers", "no",
      "a guess");
  row("amplitude", &P::amplitude_m, "m", 0.001, 1.0, "of a bout, from side to side", "no",
      "in front of the camera");
  row("period", &P::period_s, "s", 0.1, 10.0, "of to and fro", "no", "a guess");
  row("acceleration", &P::acceleration_m_per_s2, "m/s^2", 0.1, 200.0,
      "the most of a sub-movement as planned", "no", "what one does with something light");
  row("strength", &P::strength_used, "", 0.3, 1.0,
      "of the arm's greatest force that is planned with", "no", "a person knows what he can swing");
  row("tilt", &P::tilt_rad_per_m, "rad/m", 0.0, 10.0, "of the hand with its place", "no",
      "the forearm turns about the elbow");
  row("wrist-noise", &P::wrist_noise_rad, "rad", 0.0, 1.0, "deviation of the hand's tilt", "no",
      "a guess");
  row("wrist-noise-band", &P::wrist_noise_hz, "Hz", 0.01, 20.0, "highest frequency of that", "no",
      "a guess");
  row("base-grip", &P::base_grip_n, "N", 0.0, 60.0, "of the four fingers, drawn for a clip", "no",
      "a power grip at rest");
  row("grip-over-slip", &P::grip_over_slip, "", 0.0, 10.0,
      "grip that the load adds, over what would just slip between palm and fingers",
      "0.9 N a newton at friction 0.7: Flanagan and Wing 1995; less friction, more grip: "
      "Johansson and Westling 1984",
      "0.9 = 1.26 / (2 x 0.7)");
  row("anticipation", &P::anticipation_s, "s", 0.0, 1.0, "by which the grip is ahead of the load",
      "lead: Flanagan and Wing 1995, Slota 2011", "predicted, not felt");
  row("grip-noise", &P::grip_noise, "", 0.0, 0.3, "deviation of the grip, of itself; below 1 Hz",
      "no", "a guess");
  row("turning-lever", &P::turning_lever_m, "m", 0.001, 10.0,
      "grip grows by distance of grip and centre of mass over it",
      "grows with the torque: Kinoshita 1997, value: no", "half the palm's width is the lever");
  row("place", &P::place_m, "m", -5.0, 5.0, "of the hand's rest, drawn for a clip", "no",
      "before the person, in front of the camera");
}

void add_throw(Table& table) {
  using P = ThrowParameters;
  Rows<P> row(table, "throw", &SceneParameters::toss);
  row("apex", &P::apex, "", 0.1, 10.0, "times the 5-42 cm of the objects' files", "no",
      "one-handed juggling height");
  row("dip", &P::dip_m, "m", 0.0, 0.3, "of the hand before a toss", "no", "a guess");
  row("dip-of-apex", &P::dip_of_apex, "", 0.0, 2.0, "that, with the toss's height", "no",
      "a guess");
  row("dip-acceleration", &P::dip_m_per_s2, "m/s^2", 0.5, 9.5, "the most downwards", "no",
      "the object stays on the palm");
  row("opening", &P::opening_s, "s", 0.05, 5.0, "in which the hand opens", "no",
      "closed before the toss, open when it lets go");
  row("follow-through", &P::follow_through, "", 0.01, 1.0,
      "share of the flight in which the hand stops", "no",
      "stopped sooner, the palm's rebound spins what it lets go");
  row("reaction", &P::reaction_s, "s", 0.01, 0.5, "in which the hand stops at least", "no",
      "a guess");
  row("catch-error", &P::catch_error_m, "m", 0.0, 0.1, "of the palm's place under the object",
      "Fligge 2012", "");
  row("turn", &P::turn_rad, "rad", 0.0, 1.5, "of the hand to suit what comes down, at most", "no",
      "as far as the wrist does");
  row("catching-speed", &P::catching_speed, "", 0.0, 1.0, "of the hand, of the object's", "no",
      "giving way softens the catch");
  row("base-grip", &P::base_grip_n, "N", 0.0, 60.0, "of the four fingers, drawn for a clip", "no",
      "an open palm carries");
  row("catching-grip", &P::catching_m_per_s2, "m/s^2", 0.0, 300.0,
      "grip that a catch adds, over the mass", "no", "a catch is gripped harder");
  row("place", &P::place_m, "m", -5.0, 5.0, "of the hand's rest, drawn for a clip", "no",
      "before the person, in front of the camera");
}

void add_ball(Table& table) {
  using P = BallParameters;
  Rows<P> row(table, "ball", &SceneParameters::ball);
  row("drag", &P::drag, "", 0.0, 4.0, "times the coefficient of the racket's file, 0.45",
      "0.4-0.5: Cross 2023; a sphere at Reynolds number 7000: Schlichting", "");
  row("restitution", &P::restitution, "", 0.1, 1.2, "times that of the racket's file, 0.80",
      "0.81 on rubber: Nakashima et al. 2010", "");
  row("restitution-spread", &P::restitution_spread, "", 0.0, 0.2, "its deviation among impacts",
      "no", "rubbers are not the same everywhere");
  row("friction", &P::friction, "", 0.0, 10.0, "times that of the racket's file, 0.6", "no",
      "most hits end rolling, whatever it is");
}

void add_sight(Rows<PingpongParameters>& row) {
  using P = PingpongParameters;
  row("delay", &P::delay_s, "s", 0.0, 0.3, "after which the ball is seen where it was",
      "100-150 ms for moving targets", "the lower end: a ball that is watched");
  row("replanning", &P::replan_s, "s", 0.01, 1.0, "from one plan to the next, at least", "no",
      "a guess");
  row("last-change", &P::last_change_s, "s", 0.002, 0.3, "before a hit, nothing is planned anew",
      "no", "an arm takes its time");
  row("place-error", &P::place_error_m, "m", 0.0, 0.05, "deviation of where the ball is seen",
      "catches miss by 6 mm: Fligge 2012", "part of that");
  row("speed-error", &P::speed_error, "", 0.0, 0.5, "deviation of a speed that is seen, of it",
      "5 % are just told apart: McKee 1981", "");
  row("sight-noise-band", &P::sight_noise_hz, "Hz", 0.01, 20.0, "highest frequency of those two",
      "no", "a guess");
  row("feeling", &P::feeling_s, "s", 0.01, 10.0, "in which the racket is felt to have turned", "no",
      "slow enough that hits do not count");
}

void add_pingpong(Table& table) {
  using P = PingpongParameters;
  Rows<P> row(table, "pingpong", &SceneParameters::pingpong);
  add_sight(row);
  row("usual-apex", &P::usual_apex_m, "m", 0.05, 1.0, "of the ball over the racket, for a clip",
      "no", "a ball bounced at will");
  row("apex-spread", &P::apex_spread_m, "m", 0.0, 0.3, "deviation from that, for a hit", "no",
      "a guess");
  row("apex", &P::apex_m, "m", 0.03, 1.5, "of any hit as it is meant", "no", "before the camera");
  row("swing-error", &P::swing_error, "", 0.0, 0.5, "deviation of the racket's speed, of it", "no",
      "a guess");
  row("tilt-error", &P::tilt_error_rad, "rad", 0.0, 0.3, "deviation of the blade's tilt", "no",
      "a guess");
  row("tilt-noise-band", &P::tilt_noise_hz, "Hz", 0.01, 20.0, "highest frequency of that", "no",
      "a guess");
  row("braking", &P::braking_m_per_s2, "m/s^2", -20.0, 50.0, "of the racket at the hit",
      "the skilled do: Dijkstra et al. 2004, value: no", "a few m/s^2");
  row("return", &P::return_s, "s", 0.05, 2.0, "after a hit, to below the next", "no", "a guess");
  row("return-depth", &P::return_m, "m", 0.0, 0.3, "how far below", "no", "a guess");
  row("tilt", &P::tilt_rad, "rad", 0.0, 1.0, "of the blade, the most", "no", "of a wrist");
  row("aside", &P::aside_m_per_s, "m/s", 0.0, 2.0, "at which a ball is sent back, the most", "no",
      "gently");
  row("base-grip", &P::base_grip_n, "N", 0.0, 60.0, "of the four fingers, drawn for a clip", "no",
      "firm, not tense");
  row("place", &P::place_m, "m", -5.0, 5.0, "of the blade, drawn for a clip", "no",
      "before the person, in front of the camera");
}

void add_balance(Table& table) {
  using P = BalanceParameters;
  Rows<P> row(table, "balance", &SceneParameters::balance);
  row("delay", &P::delay_s, "s", 0.0, 1.0, "from the tip's motion to the hand's", "Milton 2009",
      "");
  row("prediction", &P::prediction_s, "s", control_interval_s, 1.0,
      "over which the person predicts from what his hand did",
      "forward models: Mehta and Schaal 2002, value: no", "he knows his delay");
  row("seen", &P::seen_m, "m", 0.0, 0.1, "noise of the tip's place, as it is seen", "no",
      "a guess");
  row("seen-speed", &P::seen_m_per_s, "m/s", 0.0, 1.0, "noise of its velocity", "no", "a guess");
  row("seen-band", &P::seen_hz, "Hz", 0.01, 20.0, "highest frequency of both", "no",
      "slower than the eye");
  row("tremor", &P::tremor, "", 0.0, 1.0, "noise of the hand's acceleration, of what is wanted",
      "grows with the command: Harris and Wolpert 1998, value: no", "a guess");
  row("tremor-at-rest", &P::tremor_m_per_s2, "m/s^2", 0.0, 10.0, "what is left without a command",
      "no", "a guess");
  row("tremor-band", &P::tremor_hz, "Hz", 0.01, 20.0, "highest frequency of both",
      "physiological tremor: 8-12 Hz", "the lower end");
  row("acceleration", &P::acceleration_m_per_s2, "m/s^2", 0.1, 200.0, "the most of the hand", "no",
      "the foot does not slip");
  row("homing", &P::homing_per_s, "1/s", 0.01, 20.0, "rate at which the hand comes home", "no",
      "the hand stays before the person");
  row("upright", &P::upright_lag_s, "s", 0.01, 1e3,
      "in which the lean that holds on the whole becomes upright", "no",
      "nobody knows how the foot stands on his palm");
  row("tilt", &P::tilt_rad, "rad", 0.0, 1.0, "deviation of the hand's tilt: of a clip's, and noise",
      "no", "an open palm is held level");
  row("tilt-band", &P::tilt_hz, "Hz", 0.01, 20.0, "highest frequency of that noise", "no",
      "a guess");
  row("height", &P::height_m, "m", 0.0, 0.1, "noise of the hand's height", "no", "a guess");
  row("height-band", &P::height_hz, "Hz", 0.01, 20.0, "highest frequency of that", "no", "a guess");
  row("place", &P::place_m, "m", -5.0, 5.0, "of the hand's home, drawn for a clip", "no",
      "before the person, as low as the tip in the image needs");
}

void add_glove(Table& table) {
  using P = GloveParameters;
  Rows<P> row(table, "glove", &SceneParameters::glove);
  row("loading-lag", &P::loading_lag_s, "s", 1e-4, 10.0, "of a reading as the force grows",
      "hysteresis of piezoresistive film: yes, value: no", "faster than unloading");
  row("unloading-lag", &P::unloading_lag_s, "s", 1e-4, 10.0, "of a reading as the force falls",
      "hysteresis of piezoresistive film: yes, value: no", "unloading is slower");
  row("creep", &P::creep, "", 0.0, 1.0, "that a lasting force adds to its reading",
      "range published for FSR", "");
  row("creep-time", &P::creep_s, "s", 0.01, 1000.0, "of that", "range published for FSR", "");
  row("gain", &P::gain_deviation, "", 0.0, 2.0, "deviation of the logarithm of a taxel's gain",
      "no", "hand-made arrays");
  row("dead", &P::dead, "", 0.0, 0.9, "share of the taxels", "no", "hand-made arrays");
  row("drift", &P::drift, "", 0.0, 0.9, "amplitude of a gain's slow change", "no",
      "temperature and humidity");
  row("drift-period", &P::drift_period_s, "s", 1.0, 1e5, "of that, drawn for each taxel", "no",
      "temperature and humidity");
  row("saturation", &P::half_saturation_n, "N", 0.01, 1e4,
      "force at half of the full scale: f / (f + it)",
      "form for piezoresistive film: yes, value: no", "a guess");
  row("cross-talk", &P::cross_talk, "", 0.0, 0.2,
      "share of row and column sums, and loading of the row", "arrays < 3.3-3.6 %",
      "read-out without zero potential is worse");
  row("full-scale", &P::full_scale_counts, "counts", 10.0, 5000.0, "of the 10 bit converter", "no",
      "a guess");
  row("noise", &P::noise_counts, "counts", 0.0, 200.0, "deviation", "no", "a guess");
  row("baseline", &P::baseline_counts, "counts", 0.0, 900.0, "mean reading of an untouched taxel",
      "no", "a guess");
  row("baseline-spread", &P::baseline_deviation_counts, "counts", 0.0, 200.0,
      "deviation of that among taxels", "no", "a guess");
  row("scan", &P::scan_s, "s", 0.0, 0.066, "in which the 32 rows of a frame are read",
      "rate of 15 Hz: yes, scan: no", "a guess");
  row("clock", &P::clock_ppm, "ppm", 0.0, 1e4, "deviation of its rate, fixed for a session",
      "data sheets of quartz: 20-100 ppm", "");
  row("latency", &P::latency_s, "s", 0.0, 1.0, "of transport, the least", "no", "USB full speed");
  row("jitter", &P::jitter_s, "s", 0.0, 1.0, "mean of its exponential part", "no", "a busy host");
  row("lost", &P::lost, "", 0.0, 0.9, "share of the frames", "no", "a busy host");
}

void add_inertial(Table& table) {
  using P = InertialParameters;
  constexpr const char* sheet = "BMI270's data sheet";
  Rows<P> row(table, "inertial", &SceneParameters::inertial);
  row("rate", &P::rate_hz, "Hz", 1.0, 1000.0, "of the unit's samples", sheet, "one of its rates");
  row("place-x", &P::place_x_m, "m", -0.3, 0.3,
      "of the unit, from the palm's middle to the fingers", "no", "near the wrist");
  row("place-z", &P::place_z_m, "m", -0.3, 0.3, "of the unit, out of the palm", "no",
      "on the back of the hand");
  row("force-noise", &P::force_noise_g, "g/sqrt(Hz)", 0.0, 0.1, "density", sheet, "");
  row("force-offset", &P::force_offset_g, "g", 0.0, 1.0, "deviation of each axis", sheet, "");
  row("force-range", &P::force_range_g, "g", 1.0, 100.0, "to either side, in 16 bits", sheet, "");
  row("rate-noise", &P::rate_noise_deg_per_s, "deg/s/sqrt(Hz)", 0.0, 10.0, "density", sheet, "");
  row("rate-offset", &P::rate_offset_deg_per_s, "deg/s", 0.0, 100.0, "deviation of each axis",
      sheet, "");
  row("rate-range", &P::rate_range_deg_per_s, "deg/s", 10.0, 1e4, "to either side, in 16 bits",
      sheet, "");
  row("levelling", &P::levelling_s, "s", 0.01, 1e4,
      "in which its vertical follows the specific force", "form: Mahony 2008, value: no",
      "longer than a movement");
}

void add_camera(Table& table) {
  using P = CameraParameters;
  constexpr const char* small_stereo = "as of small stereo cameras";
  Rows<P> row(table, "camera", &SceneParameters::camera);
  row("focal", &P::focal_px, "px", 200.0, 2000.0, "focal length in an image 640 pixels wide", "no",
      small_stereo);
  row("focal-spread", &P::focal_deviation_px, "px", 0.0, 50.0, "its deviation among specimens",
      "no", "factory calibrations differ by as much");
  row("centre-spread", &P::centre_deviation_px, "px", 0.0, 50.0,
      "the same of the principal point, from the middle", "no", small_stereo);
  row("k1", &P::k1, "", -0.4, 0.4, "mean radial distortion of the colour lens", "no",
      "a lens of 55 degrees");
  row("k2", &P::k2, "", -0.4, 0.4, "the next term of that", "no", "a lens of 55 degrees");
  row("radial-spread", &P::radial_deviation, "", 0.0, 0.1, "deviation of both among specimens",
      "no", "a guess");
  row("tangential", &P::tangential_deviation, "", 0.0, 0.01,
      "deviation of the tangential distortion", "no", "a guess");
  row("exposure", &P::exposure_s, "s", 1e-5, 0.05, "of a colour frame", "no", "a lit room");
  row("noise", &P::noise_counts, "counts", 0.0, 50.0, "of a colour pixel, of 255", "no",
      "a lit room");
  row("apart", &P::apart_m, "m", 0.0, 0.2, "depth's eye from the colour's", "no", small_stereo);
  row("baseline", &P::baseline_m, "m", 0.005, 0.5, "of the stereo pair", "no", small_stereo);
  row("disparity-noise", &P::disparity_sigma_px, "px", 0.0, 2.0, "deviation",
      "axial noise of 2.1 mm at 1.1 m: Nguyen et al. 2012", "");
  row("disparity-step", &P::disparity_step_px, "px", 0.0, 2.0, "of its quantisation",
      "eighths of a pixel are usual", "");
  row("shift", &P::shift_sigma_px, "px", 0.0, 5.0, "deviation of where a pixel of depth looks",
      "Handa et al. 2014", "");
  row("nearest", &P::nearest_m, "m", 0.01, 0.8, "depth that is measured", "data sheets: 0.2-0.3 m",
      "");
  row("farthest", &P::farthest_m, "m", 2.5, 100.0, "the same", "data sheets: 3-10 m", "");
  row("scale", &P::scale_deviation, "", 0.0, 0.02, "deviation of depth's scale from 1",
      "data sheets: < 2 %", "what calibration has to find");
  row("offset", &P::offset_deviation_m, "m", 0.0, 0.05, "deviation of depth's offset", "no",
      "what calibration has to find");
  row("height", &P::height_m, "m", 0.7, 2.0, "of the camera above the floor", "no",
      "it sees all of each activity");
  row("place", &P::place_deviation_m, "m", 0.0, 0.1, "deviation of that, and sideways", "no",
      "it is put up anew for each session");
  row("pitch", &P::pitch_deviation_deg, "deg", 0.0, 5.0, "deviation of how far it looks down", "no",
      "it is put up anew for each session");
  row("gravity", &P::gravity_deviation_deg, "deg", 0.0, 10.0,
      "deviation of the vertical of its accelerometer", "no", "an offset of 5 mg an axis");
  row("clock", &P::clock_ppm, "ppm", 0.0, 1e4, "deviation of its rate",
      "data sheets of quartz: 20-100 ppm", "");
  row("latency", &P::latency_s, "s", 0.0, 0.5,
      "from the middle of the exposure to the arrival, the least", "no",
      "half a frame to read out");
  row("jitter", &P::jitter_s, "s", 0.0, 0.5, "mean of its exponential part", "no", "a busy host");
  row("dropped", &P::dropped, "", 0.0, 0.9, "share of the frames", "no", "a busy host");
}

Table all_rows() {
  Table table;
  for (const auto add :
       {add_contact, add_arm, add_hand, add_fingers, add_grasp, add_objects, add_wave, add_throw,
        add_ball, add_pingpong, add_balance, add_glove, add_inertial, add_camera})
    add(table);
  return table;
}

}  // namespace

const std::vector<Assumption>& assumptions() {
  static const Table table = all_rows();
  return table;
}

}  // namespace touchtrace::scene
