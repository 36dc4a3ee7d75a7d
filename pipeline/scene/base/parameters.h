#pragma once

#include <array>
#include <cmath>
#include <compare>

namespace touchtrace::scene {

// Parameters of the simulated scene with their defaults. Every member has a row in parameters_*.cpp
// with description, unit, range, source and reason. A test counts the rows, so all members are
// doubles or arrays of them.

using Interval = std::array<double, 2>;  ///< from, to
using Box = std::array<double, 6>;       ///< from, to along the world's x, y and z

/// Winkler foundation under every taxel, as soft tissue and glove, which stiffens exponentially
/// (Pawluk and Howe 1999): f = k l (exp(d / l) - 1) (1 + c d') per taxel area, with d the
/// indentation. Friction is a bristle spring of `bristle_ratio` k with the same relative damping,
/// clipped at the Coulomb limit.
struct ContactParameters {
  double stiffness_n_per_m3 = 1e7, hardening_m = 0.0015, dissipation_s_per_m = 3.0;
  double bristle_ratio = 0.7;
  double max_depth_m = 0.008;
};

/// The hand as a mass on a spring and damper to its commanded position.
struct ArmParameters {
  double mass_kg = 2.0, stiffness_n_per_m = 300.0, damping_ratio = 0.5, max_force_n = 60.0;

  double damping_n_s_per_m() const {
    return 2 * damping_ratio * std::sqrt(stiffness_n_per_m * mass_kg);
  }
};

/// Shape of the hand and coupling of its joints.
struct HandParameters {
  double hollow_radius_m = 0.13, heel_radius_m = 0.055;
  double middle_joint_ratio = 1.15, last_joint_ratio = 0.75, thumb_joint_ratio = 0.8;
  auto operator<=>(const HandParameters&) const = default;
};

struct FingerParameters {
  double inertia_kg_m2 = 5e-5, damping_nm_s_per_rad = 0.02;
};

/// How the person holds an object, whatever the activity.
struct GraspParameters {
  double weight_error = 0.25, adaptation_s = 1.5;
  double grip_stiffness_nm_per_rad = 1.0, grip_relaxation_s = 0.3;
  double posture_stiffness_nm_per_rad = 3.0;
  double thumb_share = 0.8;
  double place_m = 0.005, yaw_rad = 0.12;
  double attempts = 5.0;
};

struct ObjectParameters {
  double friction = 1.0;
};

/// Moving an object to another place on the palm between bouts of waving.
struct RegraspParameters {
  double share = 0.5;
  Interval movement_s{0.20, 0.35}, wait_s{0.3, 0.6}, opening_rad{0.02, 0.12};
  double place_m = 0.008, max_offset_m = 0.018, tilt_rad = 0.03, reaction_s = 0.08;
  double tilt_rad_per_m = 3.0, tilt_rad_s_per_m = 1.0, max_tilt_rad = 0.3;
};

struct WaveParameters {
  Interval replan_fraction{0.80, 0.97};
  Interval repeats{2.0, 8.0}, amplitude_m{0.04, 0.16}, period_s{0.22, 0.90};
  double acceleration_m_per_s2 = 18.0, force_fraction = 0.9;
  Interval tilt_rad_per_m{1.5, 1.8};
  double wrist_noise_rad = 0.04, wrist_noise_hz = 2.0;
  Interval base_grip_n{4.0, 8.0};
  double grip_over_slip = 1.26;
  double anticipation_s = 0.06, grip_noise = 0.1, turning_lever_m = 0.04;
  Box place_m{-0.30, 0.02, -0.55, -0.42, 1.08, 1.30};
};

struct ThrowParameters {
  double apex = 1.0;
  double dip_m = 0.04, dip_per_apex = 0.30, dip_m_per_s2 = 6.0, opening_s = 0.40;
  double follow_through = 0.4, reaction_s = 0.09;
  double catch_error_m = 0.006, max_rotation_rad = 0.6;
  Interval catching_speed{0.35, 0.60};
  Interval base_grip_n{2.0, 4.0};
  double catching_m_per_s2 = 30.0;
  Box place_m{-0.30, -0.04, -0.46, -0.36, 1.02, 1.12};
};

/// Factors of the ball's properties in the racket's file.
struct BallParameters {
  double drag = 1.0, restitution = 1.0, friction = 1.0;
  double restitution_std = 0.02;
};

struct PingpongParameters {
  double delay_s = 0.100, replan_s = 0.080, replan_deadline_s = 0.040;
  double place_error_m = 0.004, speed_error = 0.05, vision_hz = 5.0;
  double tilt_error_rad = 0.015, tilt_noise_hz = 2.0, swing_error = 0.04;
  Interval usual_apex_m{0.16, 0.36}, apex_m{0.12, 0.42};
  double apex_std_m = 0.04;
  Interval racket_deceleration_m_per_s2{2.0, 8.0};
  double return_s = 0.25, return_m = 0.02, racket_lag_s = 0.3;
  double max_tilt_rad = 0.35, max_lateral_speed_m_per_s = 0.35;
  Interval base_grip_n{3.0, 6.0};
  Box place_m{-0.20, 0.05, -0.55, -0.45, 1.02, 1.12};
};

/// Noises are per axis of the horizontal plane.
struct BalanceParameters {
  double delay_s = 0.100, prediction_s = 0.100;
  double position_noise_m = 0.004, velocity_noise_m_per_s = 0.03, vision_hz = 3.0;
  double tremor = 0.1, tremor_m_per_s2 = 0.15, tremor_hz = 8.0;
  double max_acceleration_m_per_s2 = 8.0;
  double homing_per_s = 2.5;
  double upright_lag_s = 1.5;
  double tilt_rad = 0.01, tilt_hz = 1.5;
  double height_m = 0.004, height_hz = 1.0;
  Box place_m{-0.28, -0.16, -0.42, -0.36, 0.86, 0.92};
};

struct GloveParameters {
  double lag_s = 0.005;
  double creep = 0.4;
  double log_gain_std = 0.25, dead_fraction = 0.02;
  double drift = 0.03;
  Interval drift_period_s{200.0, 600.0};
  double half_saturation_n = 1.7, cross_talk = 0.012;
  double full_scale_counts = 960.0, noise_counts = 1.5;
  double baseline_counts = 40.0, baseline_std_counts = 6.0;
  double scan_s = 0.030;
  double clock_ppm = 40.0;
  double latency_s = 0.004, jitter_s = 0.003, lost_fraction = 0.02;

  auto operator<=>(const GloveParameters&) const = default;
};

/// Inertial unit on the back of the hand. Noises are densities per square root of hertz.
struct InertialParameters {
  double rate_hz = 100.0;
  double place_x_m = -0.02, place_z_m = -0.03;
  double force_noise_g = 160e-6, force_offset_g = 0.020, force_range_g = 8.0;
  double rate_noise_deg_per_s = 0.007, rate_offset_deg_per_s = 0.5, rate_range_deg_per_s = 2000.0;
  double levelling_s = 5.0;
};

/// Stereo depth sensor and colour camera before the person. Lengths in pixels are those of an image
/// 640 pixels wide. *_std are standard deviations among instances of the camera.
struct CameraParameters {
  double focal_px = 608.0, focal_std_px = 3.0, centre_std_px = 5.0;
  double k1 = -0.055, k2 = 0.045, radial_std = 0.01, tangential_std = 5e-4;
  double exposure_s = 0.008, noise_counts = 1.2;
  double color_depth_distance_m = 0.025;
  double baseline_m = 0.05, disparity_sigma_px = 0.055, disparity_step_px = 0.125;
  double shift_sigma_px = 0.5;
  double min_depth_m = 0.3, max_depth_m = 4.0;
  double scale_std = 0.004, offset_std_m = 0.005;
  double height_m = 1.35, place_std_m = 0.02, pitch_std_deg = 1.0;
  double gravity_std_deg = 0.3;
  double clock_ppm = 30.0, jitter_s = 0.003, dropped_fraction = 0.005;
  Interval latency_periods{1.0, 3.0};
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
