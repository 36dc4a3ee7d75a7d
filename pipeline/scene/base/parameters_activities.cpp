#include "pipeline/scene/base/parameter_rows.h"
#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {
namespace {

constexpr const char* four_finger_grip = "force of the four fingers without load, drawn per clip";
constexpr const char* hand_rest = "rest position of the hand, drawn per clip";
constexpr const char* before_person = "before the person, in the camera's view";

void add_regrasp(ParameterTable& table) {
  using P = RegraspParameters;
  ParameterRows<P> row(table, "regrasp", &SceneParameters::regrasp);
  row("share", &P::share, "", 0.0, 1.0,
      "fraction of the bouts that begin with a regrasp of what lies on the palm", "", "a guess");
  row("movement", &P::movement_s, "s", 0.1, 5.0,
      "duration of each of levelling the palm, opening, gripping and tilting back", "",
      "a movement of a wrist");
  row("wait", &P::wait_s, "s", 0.0, 5.0, "time between opening and gripping", "",
      "a rolling object needs that long");
  row("opening", &P::opening_rad, "rad", 0.0, 0.5, "opening angle of the fingers' first joints", "",
      "the object stays within the fingers");
  row("place", &P::place_m, "m", 0.0, 0.05, "standard deviation of the target position on the palm",
      "", "half a finger's width");
  row("max-offset", &P::max_offset_m, "m", 0.005, 0.1,
      "distance from the centre beyond which the object is regrasped again", "",
      "a finger's width");
  row("tilt", &P::tilt_rad, "rad", 0.0, 0.3, "standard deviation of the perceived level", "",
      "a guess");
  row("reaction", &P::reaction_s, "s", 0.01, 0.3,
      "time constant of the perceived position of the object",
      "70-80 ms to a slip: Johansson and Westling 1984", "");
  row("gain", &P::tilt_rad_per_m, "rad/m", 0.0, 10.0, "tilt of the palm per position error", "",
      "brings a ball to the target in half a second");
  row("damping", &P::tilt_rad_s_per_m, "rad s/m", 0.0, 5.0,
      "tilt of the palm per velocity of the object", "", "the object hardly oscillates");
  row("max-tilt", &P::max_tilt_rad, "rad", 0.0, 0.6, "largest tilt of the palm", "",
      "the object is not tipped out");
}

void add_wave(ParameterTable& table) {
  using P = WaveParameters;
  ParameterRows<P> row(table, "wave", &SceneParameters::wave);
  row("replan-fraction", &P::replan_fraction, "", 0.5, 1.0,
      "fraction of a stroke after which the next one begins",
      "minimum jerk: Flash and Hogan 1985 (form only)", "fluent movement");
  row("repeats", &P::repeats, "", 1.0, 100.0, "periods in a bout, an integer", "", "a guess");
  row("amplitude", &P::amplitude_m, "m", 0.001, 1.0, "peak-to-peak amplitude of a bout", "",
      "in front of the camera");
  row("period", &P::period_s, "s", 0.1, 10.0, "period of a bout", "", "a guess");
  row("acceleration", &P::acceleration_m_per_s2, "m/s^2", 0.1, 200.0,
      "largest planned acceleration of a stroke", "", "usual with a light object");
  row("force-fraction", &P::force_fraction, "", 0.3, 1.0,
      "fraction of the arm's largest force that plans may use", "",
      "people know what they can swing");
  row("tilt", &P::tilt_rad_per_m, "rad/m", 0.0, 10.0, "tilt of the hand per displacement", "",
      "the forearm turns about the elbow");
  row("wrist-noise", &P::wrist_noise_rad, "rad", 0.0, 1.0,
      "standard deviation of the noise of the hand's tilt", "", "a guess");
  row("wrist-noise-bandwidth", &P::wrist_noise_hz, "Hz", 0.01, 20.0,
      "highest frequency of the wrist noise", "", "a guess");
  row("base-grip", &P::base_grip_n, "N", 0.0, 60.0, four_finger_grip, "", "a power grip at rest");
  row("grip-over-slip", &P::grip_over_slip, "", 0.0, 10.0,
      "grip force added for the load, over the force at which the object would just slip between "
      "palm and fingers",
      "0.9 N a newton at friction 0.7: Flanagan and Wing 1995; less friction, more grip: "
      "Johansson and Westling 1984",
      "0.9 = 1.26 / (2 x 0.7)");
  row("anticipation", &P::anticipation_s, "s", 0.0, 1.0, "lead of the grip force over the load",
      "Flanagan and Wing 1995, Slota 2011 (form only)", "predicted, not felt");
  row("grip-noise", &P::grip_noise, "", 0.0, 0.3,
      "standard deviation of the relative noise of the grip force, below 1 Hz", "", "a guess");
  row("turning-lever", &P::turning_lever_m, "m", 0.001, 10.0,
      "lever b: grip force grows by 1 + a / b with the distance a of grip and centre of mass",
      "grows with the torque: Kinoshita 1997 (form only)", "half the palm's width is the lever");
  row("place", &P::place_m, "m", -5.0, 5.0, hand_rest, "", before_person);
}

void add_throw(ParameterTable& table) {
  using P = ThrowParameters;
  ParameterRows<P> row(table, "throw", &SceneParameters::toss);
  row("apex", &P::apex, "", 0.1, 10.0, "factor of the toss heights in the objects' files, 5-42 cm",
      "", "one-handed juggling height");
  row("dip", &P::dip_m, "m", 0.0, 0.3, "depth by which the hand dips before a toss", "", "a guess");
  row("dip-per-apex", &P::dip_per_apex, "", 0.0, 2.0, "additional dip over the toss height", "",
      "a guess");
  row("dip-acceleration", &P::dip_m_per_s2, "m/s^2", 0.5, 9.5,
      "largest downward acceleration of the dip", "", "the object stays on the palm");
  row("opening", &P::opening_s, "s", 0.05, 5.0, "time in which the hand opens", "",
      "closed before the toss, open when it releases");
  row("follow-through", &P::follow_through, "", 0.01, 1.0,
      "fraction of the flight in which the hand stops", "",
      "stopped sooner, the palm's rebound spins the released object");
  row("reaction", &P::reaction_s, "s", 0.01, 0.5, "shortest time in which the hand stops", "",
      "a guess");
  row("catch-error", &P::catch_error_m, "m", 0.0, 0.1,
      "standard deviation of the palm's position under the object", "Fligge 2012", "");
  row("max-rotation", &P::max_rotation_rad, "rad", 0.0, 1.5,
      "largest rotation of the hand to fit the falling object", "", "range of the wrist");
  row("catching-speed", &P::catching_speed, "", 0.0, 1.0,
      "velocity of the hand over that of the object at the catch", "",
      "giving way softens the catch");
  row("base-grip", &P::base_grip_n, "N", 0.0, 60.0, four_finger_grip, "", "an open palm carries");
  row("catching-grip", &P::catching_m_per_s2, "m/s^2", 0.0, 300.0,
      "grip force added by a catch, over the mass", "", "a catch is gripped harder");
  row("place", &P::place_m, "m", -5.0, 5.0, hand_rest, "", before_person);
}

void add_ball(ParameterTable& table) {
  using P = BallParameters;
  ParameterRows<P> row(table, "ball", &SceneParameters::ball);
  row("drag", &P::drag, "", 0.0, 4.0, "factor of the drag coefficient in the racket's file, 0.45",
      "0.4-0.5: Cross 2023; a sphere at Reynolds number 7000: Schlichting", "");
  row("restitution", &P::restitution, "", 0.1, 1.2,
      "factor of the coefficient of restitution in the racket's file, 0.80",
      "0.81 on rubber: Nakashima et al. 2010", "");
  row("restitution-std", &P::restitution_std, "", 0.0, 0.2,
      "standard deviation of the restitution among impacts", "", "rubbers are not uniform");
  row("friction", &P::friction, "", 0.0, 10.0,
      "factor of the friction coefficient in the racket's file, 0.6", "",
      "most hits end rolling, whatever it is");
}

void add_vision(ParameterRows<PingpongParameters>& row) {
  using P = PingpongParameters;
  row("delay", &P::delay_s, "s", 0.0, 0.3, "delay of the perceived ball state",
      "100-150 ms for moving targets", "lower end: a ball that is watched");
  row("replanning", &P::replan_s, "s", 0.01, 1.0, "shortest time between two plans", "", "a guess");
  row("replan-deadline", &P::replan_deadline_s, "s", 0.002, 0.3,
      "time before a hit from which plans do not change", "", "an arm takes its time");
  row("place-error", &P::place_error_m, "m", 0.0, 0.05,
      "standard deviation of the perceived ball position", "catches miss by 6 mm: Fligge 2012",
      "part of that");
  row("speed-error", &P::speed_error, "", 0.0, 0.5,
      "standard deviation of the relative error of perceived speed",
      "5 % are just distinguished: McKee 1981", "");
  row("vision-bandwidth", &P::vision_hz, "Hz", 0.01, 20.0, "highest frequency of those two errors",
      "", "a guess");
  row("racket-lag", &P::racket_lag_s, "s", 0.01, 10.0,
      "time constant of the perceived racket pose in the hand", "",
      "slow enough that hits do not count");
}

void add_pingpong(ParameterTable& table) {
  using P = PingpongParameters;
  ParameterRows<P> row(table, "pingpong", &SceneParameters::pingpong);
  add_vision(row);
  row("usual-apex", &P::usual_apex_m, "m", 0.05, 1.0,
      "mean height of the ball over the racket, drawn per clip", "", "a ball bounced at will");
  row("apex-std", &P::apex_std_m, "m", 0.0, 0.3, "standard deviation of that height among hits", "",
      "a guess");
  row("apex", &P::apex_m, "m", 0.03, 1.5, "range of the intended height of any hit", "",
      "before the camera");
  row("swing-error", &P::swing_error, "", 0.0, 0.5,
      "standard deviation of the relative error of the racket's speed", "", "a guess");
  row("tilt-error", &P::tilt_error_rad, "rad", 0.0, 0.3,
      "standard deviation of the blade's tilt error", "", "a guess");
  row("tilt-bandwidth", &P::tilt_noise_hz, "Hz", 0.01, 20.0, "highest frequency of the tilt error",
      "", "a guess");
  row("racket-deceleration", &P::racket_deceleration_m_per_s2, "m/s^2", -20.0, 50.0,
      "deceleration of the racket at the hit",
      "skilled players brake: Dijkstra et al. 2004 (form only)", "a few m/s^2");
  row("return", &P::return_s, "s", 0.05, 2.0,
      "duration of the movement after a hit to below the next", "", "a guess");
  row("return-depth", &P::return_m, "m", 0.0, 0.3, "depth below the next hit", "", "a guess");
  row("max-tilt", &P::max_tilt_rad, "rad", 0.0, 1.0, "largest tilt of the blade", "",
      "range of a wrist");
  row("max-lateral-speed", &P::max_lateral_speed_m_per_s, "m/s", 0.0, 2.0,
      "largest horizontal speed of a returned ball", "", "gently");
  row("base-grip", &P::base_grip_n, "N", 0.0, 60.0, four_finger_grip, "", "firm, not tense");
  row("place", &P::place_m, "m", -5.0, 5.0, "rest position of the blade, drawn per clip", "",
      before_person);
}

void add_balance(ParameterTable& table) {
  using P = BalanceParameters;
  ParameterRows<P> row(table, "balance", &SceneParameters::balance);
  row("delay", &P::delay_s, "s", 0.0, 1.0, "delay from the tip's motion to the hand's",
      "Milton 2009", "");
  row("prediction", &P::prediction_s, "s", control_interval_s, 1.0,
      "time over which the person predicts from the hand's own motion",
      "forward models: Mehta and Schaal 2002 (form only)", "people know their delay");
  row("position-noise", &P::position_noise_m, "m", 0.0, 0.1,
      "standard deviation of the perceived tip position", "", "a guess");
  row("velocity-noise", &P::velocity_noise_m_per_s, "m/s", 0.0, 1.0,
      "standard deviation of the perceived tip velocity", "", "a guess");
  row("vision-bandwidth", &P::vision_hz, "Hz", 0.01, 20.0, "highest frequency of both noises", "",
      "slower than the eye");
  row("tremor", &P::tremor, "", 0.0, 1.0,
      "standard deviation of the relative noise of the hand's acceleration",
      "grows with the command: Harris and Wolpert 1998 (form only)", "a guess");
  row("tremor-at-rest", &P::tremor_m_per_s2, "m/s^2", 0.0, 10.0,
      "standard deviation of the hand's acceleration without a command", "", "a guess");
  row("tremor-bandwidth", &P::tremor_hz, "Hz", 0.01, 20.0, "highest frequency of both tremors",
      "physiological tremor: 8-12 Hz", "lower end");
  row("max-acceleration", &P::max_acceleration_m_per_s2, "m/s^2", 0.1, 200.0,
      "largest commanded acceleration of the hand", "", "the foot does not slip");
  row("homing", &P::homing_per_s, "1/s", 0.01, 20.0,
      "rate at which the hand returns to its rest position", "",
      "the hand stays before the person");
  row("upright-lag", &P::upright_lag_s, "s", 0.01, 1e3,
      "time constant in which the mean lean becomes the perceived upright", "",
      "how the foot stands on the palm is unknown");
  row("tilt", &P::tilt_rad, "rad", 0.0, 1.0,
      "standard deviation of the hand's tilt: constant per clip, and of its noise", "",
      "an open palm is held level");
  row("tilt-bandwidth", &P::tilt_hz, "Hz", 0.01, 20.0, "highest frequency of the tilt noise", "",
      "a guess");
  row("height", &P::height_m, "m", 0.0, 0.1, "standard deviation of the hand's height", "",
      "a guess");
  row("height-bandwidth", &P::height_hz, "Hz", 0.01, 20.0, "highest frequency of the height noise",
      "", "a guess");
  row("place", &P::place_m, "m", -5.0, 5.0, hand_rest, "",
      "before the person, as low as the tip in the image needs");
}

}  // namespace

void add_activity_parameters(ParameterTable& table) {
  add_regrasp(table);
  add_wave(table);
  add_throw(table);
  add_ball(table);
  add_pingpong(table);
  add_balance(table);
}

}  // namespace touchtrace::scene
