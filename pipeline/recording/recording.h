#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calib/camera/camera.h"
#include "engine/base/provenance.h"

namespace touchtrace {

/// Geometry and readout of a tactile glove. Taxel arrays are row-major.
struct GloveInfo {
  std::string name = "glove";
  int rows = 32, cols = 32;
  double rate_hz = 15.0;                ///< nominal
  double scan_s = 0.0;                  ///< time to read the rows of one frame, one after the other
  int bits = 10;                        ///< resolution of the analog-to-digital converter
  int polarity = 1;                     ///< +1: counts increase with pressure; -1: they decrease
  std::vector<float> baseline_counts;   ///< [rows, cols], without contact
  std::vector<std::uint8_t> mask;       ///< [rows, cols], 1: taxel exists
  std::vector<float> taxel_position_m;  ///< [rows, cols, 3], hand's frame; NaN: unknown

  int taxels() const { return rows * cols; }
};

/// Samples of a glove's inertial measurement unit, whose axes are those of the hand's frame. Each
/// sample is the mean over the period before it.
struct InertialStream {
  double rate_hz = 100.0;                         ///< nominal
  std::array<double, 3> position_m{};             ///< of the unit, hand's frame
  std::vector<std::uint64_t> sequence;            ///< [samples], counted by the glove's clock
  std::vector<double> host_time_s;                ///< [samples], arrival
  std::vector<float> specific_force_m_per_s2;     ///< [samples, 3], acceleration minus gravity
  std::vector<float> angular_velocity_rad_per_s;  ///< [samples, 3]
  /// [samples, 4], the unit's own estimate: rotation from the hand's frame to a frame whose z axis
  /// points up and whose heading is arbitrary and drifts.
  std::vector<float> orientation_wxyz;
};

/// Frames of one glove.
struct GloveStream {
  GloveInfo info;
  /// [frames], the device's frame counter. It also counts frames that were lost or not recorded, so
  /// it is the glove's clock.
  std::vector<std::uint64_t> sequence;
  std::vector<double> host_time_s;    ///< [frames], arrival, with transport latency and jitter
  std::vector<std::uint16_t> counts;  ///< [frames, rows, cols]
  std::optional<InertialStream> inertial = std::nullopt;

  std::size_t frames() const { return sequence.size(); }
};

/// RGB-D camera as its driver describes it.
struct CameraInfo {
  int width = 0, height = 0;              ///< of colour images
  double rate_hz = 20.0;                  ///< nominal
  double depth_unit_m = 0.001;            ///< depth = count * depth_unit_m; count 0: no measurement
  int depth_width = 0, depth_height = 0;  ///< of depth images; 0: as colour images
  bool is_registered = false;             ///< depth images lie on the colour camera's pixels
  /// Intrinsics and lens of each camera; nullopt: unknown. A registered depth image has the colour
  /// camera's.
  std::optional<Camera> color_camera = std::nullopt, depth_camera = std::nullopt;
  std::optional<Eigen::Isometry3d> depth_from_color = std::nullopt;  ///< [m]; nullopt: unknown
  /// Gravity [m/s^2] in the colour camera's frame, from the camera's accelerometer; nullopt:
  /// unknown.
  std::optional<Eigen::Vector3d> gravity_m_per_s2 = std::nullopt;

  int depth_image_width() const { return depth_width > 0 ? depth_width : width; }
  int depth_image_height() const { return depth_height > 0 ? depth_height : height; }
};

/// Values of RgbdFrame::mask.
enum MaskValue : std::uint8_t { mask_other = 0, mask_hand = 1, mask_object = 2 };

/// Colour image and depth image. Unless CameraInfo::is_registered, each is as its own camera sees
/// it.
struct RgbdFrame {
  std::vector<std::uint8_t> color;   ///< [height, width, 3], RGB
  std::vector<std::uint16_t> depth;  ///< [depth_height, depth_width], in CameraInfo::depth_unit_m
  /// [height, width] MaskValue of each colour pixel; empty: the frame has no mask.
  std::vector<std::uint8_t> mask = {};
};

/// Time stamps of the camera's frames: pairs of a depth image and the colour image nearest in time.
/// Stamps are the depth image's.
struct CameraTimes {
  std::vector<std::uint64_t> sequence;  ///< the camera's frame counter
  std::vector<double> device_time_s;    ///< the camera's clock, which drifts
  std::vector<double> host_time_s;      ///< arrival, with jitter

  std::size_t frames() const { return sequence.size(); }
};

/// Box in the colour image [px].
struct PixelBox {
  int x = 0, y = 0, width = 0, height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
  bool operator==(const PixelBox&) const = default;
};

/// Stretch of a recording with one grasp; host clock.
struct Clip {
  double start_s = 0.0, end_s = 0.0;
  std::string object;
  bool object_fell = false;       ///< the clip is excluded from training and evaluation
  PixelBox hand_box, object_box;  ///< drawn by a user in camera frame `box_frame`, or empty
  /// Index of a camera frame (for RecordingWriter: of a colour image); nullopt: the clip's first.
  std::optional<std::size_t> box_frame = std::nullopt;

  bool operator==(const Clip&) const = default;
};

/// Chessboard, described by its inner corners.
struct BoardInfo {
  int columns = 9, rows = 6;
  double square_m = 0.025;
};

/// Contents of a recording except for its images and truth. Times are in seconds of the host's
/// clock since `epoch_unix_s`.
struct Recording {
  std::string activity;  ///< "wave", "throw", ...
  double epoch_unix_s = 0.0;
  std::vector<Clip> clips;
  std::vector<GloveStream> gloves;  ///< at most 2; empty if only the camera was recorded
  CameraInfo camera;
  CameraTimes camera_times;
  BoardInfo board;
  Provenance provenance;
  /// Stamps of colour images for RecordingWriter; empty: as camera_times. RecordingReader, which
  /// pairs the images, leaves it empty.
  CameraTimes color_times = {};
};

/// Ground truth of a simulated recording, for evaluation only. Arrays are row-major; positions and
/// velocities in the colour camera's frame.
struct Truth {
  struct Body {
    std::vector<double> position_m;        ///< [samples, 3], palm centre or object's centre of mass
    std::vector<double> velocity_m_per_s;  ///< [samples, 3]
    std::vector<double> orientation_wxyz;  ///< [samples, 4], unit quaternions
  };
  struct Event {
    double time_s;
    std::string kind;  ///< "release", "catch", "impact", "drop"
  };

  std::vector<double> time_s;      ///< [samples], host clock, uniform within a clip
  std::vector<std::int32_t> clip;  ///< [samples], index of the clip
  Body hand, object;
  std::vector<double> contact_force_n;  ///< [samples, 3], of the hand on the object
  std::vector<Event> events;
  nlohmann::json calibration;  ///< intrinsics, extrinsics and depth error of the cameras
  nlohmann::json clocks;       ///< offset, drift and latency of each stream
};

}  // namespace touchtrace
