#pragma once

#include <array>
#include <cmath>
#include <compare>

namespace touchtrace::scene {

// Every number that the scene assumes, by the part that uses it. Each has a row in
// an assumptions_of_*.cpp that says where it comes from; a test counts them, so all are doubles.

using Interval = std::array<double, 2>;  ///< from, to
using Box = std::array<double, 6>;       ///< from, to along the world's x, y and z

/// Winkler foundation under every taxel, as soft tissue and glove, which stiffens exponentially
/// (Pawluk and Howe 1999): f = k l (exp(d / l) - 1) (1 + c d'); friction a bristle of 0.7 k with
/// the same relative damping, clipped at the Coulomb limit.
struct ContactParameters {
  double stiffness_n_per_m3 = 1e7, hardening_m = 0.0015, dissipation_s_per_m = 3.0;
  double bristle_ratio = 0.7;
  double clamp_m = 0.008;  ///< deeper than this the law is not meant; counted
};

/// The hand as a mass on a spring to where it is wanted. Published fits: 0.9-3.0 kg, 135-500 N/m.
struct ArmParameters {
  double mass_kg = 2.0, stiffness_n_per_m = 300.0, damping_ratio = 0.5, force_bound_n = 60.0;

  double damping_n_s_per_m() const {
    return 2 * damping_ratio * std::sqrt(stiffness_n_per_m * mass_kg);
  }
};

/// The shape of the hand, and how its joints go together.
struct HandParameters {
  double hollow_m = 0.13, heel_m = 0.055;  ///< radii of the palm's dish and of its rise
  double middle_joint = 1.15, last_joint = 0.75, thumb_joint = 0.8;  ///< a turn of the first
  auto operator<=>(const HandParameters&) const = default;
};

/// Of the first joint of each finger.
struct FingerParameters {
  double inertia_kg_m2 = 5e-5, damping_nm_s_per_rad = 0.02;
};

/// How the person holds what is in the hand, whatever is done with it.
struct GraspParameters {
  double weight_error = 0.25;  ///< deviation of the weight fed forward, of the weight
  double adaptation_s = 1.5;   ///< in which that error decays
  double grip_stiffness_nm_per_rad = 1.0, grip_relaxation_s = 0.3;
  double posture_stiffness_nm_per_rad = 3.0;
  double thumb_share = 0.8;                ///< of the four fingers' force
  double place_m = 0.005, yaw_rad = 0.12;  ///< deviations of the object's pose in the hand
  double attempts = 5.0;                   ///< to take the object before a clip begins
};

struct ObjectParameters {
  double friction = 1.0;  ///< times that of the object's file
};

/// Of what lies on the palm, taken otherwise.
struct RegraspParameters {
  double share = 0.5;  ///< of the bouts of waving that begin with it
  Interval movement_s{0.20, 0.35}, wait_s{0.3, 0.6}, opening_rad{0.02, 0.12};
  double place_m = 0.008, farthest_m = 0.018, tilt_rad = 0.03, reaction_s = 0.08;
  double tilt_rad_per_m = 3.0, tilt_rad_s_per_m = 1.0, most_tilt_rad = 0.3;
};

struct WaveParameters {
  Interval replanned{0.80, 0.97};  ///< share of a sub-movement after which the next one begins
  Interval repeats{2.0, 8.0}, amplitude_m{0.04, 0.16}, period_s{0.22, 0.90};
  double acceleration_m_per_s2 = 18.0, strength_used = 0.9;  ///< the most; of what the arm can do
  Interval tilt_rad_per_m{1.5, 1.8};
  double wrist_noise_rad = 0.04, wrist_noise_hz = 2.0;
  Interval base_grip_n{4.0, 8.0};
  double grip_over_slip = 1.26;  ///< what is gripped with, over what would just slip
  double anticipation_s = 0.06, grip_noise = 0.1, turning_lever_m = 0.04;
  Box place_m{-0.30, 0.02, -0.55, -0.42, 1.08, 1.30};
};

struct ThrowParameters {
  double apex = 1.0;  ///< times that of the object's file
  double dip_m = 0.04, dip_of_apex = 0.30, dip_m_per_s2 = 6.0, opening_s = 0.40;
  double follow_through = 0.4, reaction_s = 0.09;  ///< of the flight's time; at least
  double catch_error_m = 0.006, turn_rad = 0.6;
  Interval catching_speed{0.35, 0.60};  ///< of the object's
  Interval base_grip_n{2.0, 4.0};
  double catching_m_per_s2 = 30.0;
  Box place_m{-0.30, -0.04, -0.46, -0.36, 1.02, 1.12};
};

/// Of a ball on an object.
struct BallParameters {
  double drag = 1.0, restitution = 1.0, friction = 1.0;  ///< times those of the object's file
  double restitution_spread = 0.02;                      ///< deviation among impacts
};

struct PingpongParameters {
  double delay_s = 0.100, replan_s = 0.080, last_change_s = 0.040;
  double place_error_m = 0.004, speed_error = 0.05, sight_noise_hz = 5.0;
  double tilt_error_rad = 0.015, tilt_noise_hz = 2.0, swing_error = 0.04;
  Interval usual_apex_m{0.16, 0.36}, apex_m{0.12, 0.42};  ///< of a clip; of any hit
  double apex_spread_m = 0.04;
  Interval braking_m_per_s2{2.0, 8.0};
  double return_s = 0.25, return_m = 0.02, feeling_s = 0.3;
  double tilt_rad = 0.35, aside_m_per_s = 0.35;  ///< the most
  Interval base_grip_n{3.0, 6.0};
  Box place_m{-0.20, 0.05, -0.55, -0.45, 1.02, 1.12};  ///< of the blade
};

/// Noises are deviations, in each direction of the plane, with frequencies up to their band.
struct BalanceParameters {
  double delay_s = 0.100, prediction_s = 0.100;  ///< of what is seen; what is made up for
  double seen_m = 0.004, seen_m_per_s = 0.03, seen_hz = 3.0;     ///< noise of the tip, as seen
  double tremor = 0.1, tremor_m_per_s2 = 0.15, tremor_hz = 8.0;  ///< of what is wanted; at rest
  double acceleration_m_per_s2 = 8.0;                            ///< the most
  double homing_per_s = 2.5;                 ///< rate at which the hand comes home
  double upright_lag_s = 1.5;                ///< in which what holds on the whole becomes upright
  double tilt_rad = 0.01, tilt_hz = 1.5;     ///< of the hand: of a clip, and noise
  double height_m = 0.004, height_hz = 1.0;  ///< of the hand, noise
  Box place_m{-0.28, -0.16, -0.42, -0.36, 0.86, 0.92};
};

struct GloveParameters {
  double loading_lag_s = 0.008, unloading_lag_s = 0.030;
  double creep = 0.12, creep_s = 2.0;
  double gain_deviation = 0.25, dead = 0.02;
  double drift = 0.03;
  Interval drift_period_s{200.0, 600.0};
  double half_saturation_n = 1.2, cross_talk = 0.012;
  double full_scale_counts = 960.0, noise_counts = 1.5;
  double baseline_counts = 40.0, baseline_deviation_counts = 6.0;
  double scan_s = 0.030;
  double clock_ppm = 40.0;
  double latency_s = 0.004, jitter_s = 0.003, lost = 0.02;

  auto operator<=>(const GloveParameters&) const = default;
};

/// The inertial unit on the back of the hand; densities a root of hertz.
struct InertialParameters {
  double rate_hz = 100.0;
  double place_x_m = -0.02, place_z_m = -0.03;  ///< hand's frame
  double force_noise_g = 160e-6, force_offset_g = 0.020, force_range_g = 8.0;
  double rate_noise_deg_per_s = 0.007, rate_offset_deg_per_s = 0.5, rate_range_deg_per_s = 2000.0;
  double levelling_s = 5.0;  ///< in which its vertical follows the specific force
};

/// A stereo depth sensor beside a colour camera, before the person. Lengths in pixels are those of
/// an image 640 pixels wide; deviations are those among specimens.
struct CameraParameters {
  double focal_px = 608.0, focal_deviation_px = 3.0, centre_deviation_px = 5.0;
  double k1 = -0.055, k2 = 0.045, radial_deviation = 0.01, tangential_deviation = 5e-4;
  double exposure_s = 0.008, noise_counts = 1.2;  ///< of colour
  double apart_m = 0.025;                         ///< depth's eye from the colour's
  double baseline_m = 0.05, disparity_sigma_px = 0.055, disparity_step_px = 0.125;
  double shift_sigma_px = 0.5;  ///< of where a pixel of depth really looks
  double nearest_m = 0.3, farthest_m = 4.0;
  double scale_deviation = 0.004, offset_deviation_m = 0.005;  ///< of depth
  double height_m = 1.35, place_deviation_m = 0.02, pitch_deviation_deg = 1.0;
  double gravity_deviation_deg = 0.3;  ///< of its accelerometer's vertical
  double clock_ppm = 30.0, latency_s = 0.018, jitter_s = 0.003, dropped = 0.005;
};

struct SceneParameters {
  ContactParameters contact;
  ArmParameters arm;
  HandParameters hand;
  FingerParameters fingers;
  GraspParameters grasp;
  ObjectParameters objects;
  RegraspParameters regrasp;
  WaveParameters wave;
  ThrowParameters toss;
  BallParameters ball;
  PingpongParameters pingpong;
  BalanceParameters balance;
  GloveParameters glove;
  InertialParameters inertial;
  CameraParameters camera;
};

}  // namespace touchtrace::scene
