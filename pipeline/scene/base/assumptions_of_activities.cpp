#include "pipeline/scene/base/assumption_rows.h"
#include "pipeline/scene/base/scene.h"

namespace touchtrace::scene {
namespace {

void add_wave(AssumptionTable& table) {
  using P = WaveParameters;
  AssumptionRows<P> row(table, "wave", &SceneParameters::wave);
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

void add_regrasp(AssumptionTable& table) {
  using P = RegraspParameters;
  AssumptionRows<P> row(table, "regrasp", &SceneParameters::regrasp);
  row("share", &P::share, "", 0.0, 1.0,
      "of the bouts before which the hand lets what lies on it come to lie otherwise", "no",
      "a guess");
  row("movement", &P::movement_s, "s", 0.1, 5.0,
      "of levelling the palm, letting go, gripping, tilting: each", "no", "a movement of a wrist");
  row("wait", &P::wait_s, "s", 0.0, 5.0, "between letting go and gripping", "no",
      "what rolls needs that long");
  row("opening", &P::opening_rad, "rad", 0.0, 0.5, "of the fingers' first joints", "no",
      "it stays within the fingers");
  row("place", &P::place_m, "m", 0.0, 0.05, "deviation of the place that is wanted", "no",
      "half a finger's width");
  row("farthest", &P::farthest_m, "m", 0.005, 0.1,
      "from the middle; what lies further is let go once more", "no", "a finger's width");
  row("tilt", &P::tilt_rad, "rad", 0.0, 0.3, "deviation of what is felt as level", "no", "a guess");
  row("reaction", &P::reaction_s, "s", 0.01, 0.3, "lag of what is felt of the place",
      "70-80 ms to a slip: Johansson and Westling 1984", "");
  row("gain", &P::tilt_rad_per_m, "rad/m", 0.0, 10.0, "of the palm's tilt, of the place", "no",
      "brings a ball there in half a second");
  row("braking", &P::tilt_rad_s_per_m, "rad s/m", 0.0, 5.0, "of the same, of its speed", "no",
      "it hardly swings");
  row("most-tilt", &P::most_tilt_rad, "rad", 0.0, 0.6, "of that", "no", "it is not tipped out");
}

void add_throw(AssumptionTable& table) {
  using P = ThrowParameters;
  AssumptionRows<P> row(table, "throw", &SceneParameters::toss);
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

void add_ball(AssumptionTable& table) {
  using P = BallParameters;
  AssumptionRows<P> row(table, "ball", &SceneParameters::ball);
  row("drag", &P::drag, "", 0.0, 4.0, "times the coefficient of the racket's file, 0.45",
      "0.4-0.5: Cross 2023; a sphere at Reynolds number 7000: Schlichting", "");
  row("restitution", &P::restitution, "", 0.1, 1.2, "times that of the racket's file, 0.80",
      "0.81 on rubber: Nakashima et al. 2010", "");
  row("restitution-spread", &P::restitution_spread, "", 0.0, 0.2, "its deviation among impacts",
      "no", "rubbers are not the same everywhere");
  row("friction", &P::friction, "", 0.0, 10.0, "times that of the racket's file, 0.6", "no",
      "most hits end rolling, whatever it is");
}

void add_sight(AssumptionRows<PingpongParameters>& row) {
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

void add_pingpong(AssumptionTable& table) {
  using P = PingpongParameters;
  AssumptionRows<P> row(table, "pingpong", &SceneParameters::pingpong);
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

void add_balance(AssumptionTable& table) {
  using P = BalanceParameters;
  AssumptionRows<P> row(table, "balance", &SceneParameters::balance);
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

}  // namespace

void add_activities_assumptions(AssumptionTable& table) {
  add_regrasp(table);
  add_wave(table);
  add_throw(table);
  add_ball(table);
  add_pingpong(table);
  add_balance(table);
}

}  // namespace touchtrace::scene
