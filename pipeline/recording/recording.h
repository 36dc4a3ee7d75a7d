#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/provenance.h"

namespace touchtrace {

/// How one tactile glove is built and read. Taxels are stored in row-major order.
struct GloveInfo {
  std::string name = "glove";
  int rows = 32, cols = 32;
  double rate_hz = 15.0;  ///< nominal
  double scan_s = 0.0;    ///< one frame's rows are read one after the other within this time
  int bits = 10;          ///< of the converter
  int polarity = 1;       ///< +1: more counts are more pressure; -1: fewer counts are
  std::vector<float> baseline_counts;   ///< [rows, cols], untouched
  std::vector<std::uint8_t> mask;       ///< [rows, cols], 1 where there is a taxel
  std::vector<float> taxel_position_m;  ///< [rows, cols, 3], frame of the hand; NaN where unknown

  int taxels() const { return rows * cols; }
};

/// The inertial unit of a glove, with its axes along those of the hand's frame. `sequence` counts
/// the samples by the glove's clock. Each is the mean over the period before it.
struct InertialStream {
  double rate_hz = 100.0;                         ///< nominal
  std::array<double, 3> place_m{};                ///< of the unit, in the hand's frame
  std::vector<std::uint64_t> sequence;            ///< [samples]
  std::vector<double> host_time_s;                ///< [samples], arrival
  std::vector<float> specific_force_m_per_s2;     ///< [samples, 3]: acceleration less gravity's
  std::vector<float> angular_velocity_rad_per_s;  ///< [samples, 3]
  /// [samples, 4], the unit's own estimate: of the hand in a frame whose z axis points upwards, and
  /// whose heading starts anywhere and drifts.
  std::vector<float> orientation_wxyz;
};

/// The frames of one glove. `sequence` is the device's own frame counter: it goes on through frames
/// that were lost or not recorded, so it is the glove's clock. `host_time_s` are arrival stamps,
/// with transport latency and jitter.
struct GloveStream {
  GloveInfo info;
  std::vector<std::uint64_t> sequence;                    ///< [frames]
  std::vector<double> host_time_s;                        ///< [frames]
  std::vector<std::uint16_t> counts;                      ///< [frames, rows, cols]
  std::optional<InertialStream> inertial = std::nullopt;  ///< none: the glove has no such unit

  std::size_t frames() const { return sequence.size(); }
};

struct CameraInfo {
  int width = 0, height = 0;    ///< of colour and of depth
  double rate_hz = 20.0;        ///< nominal
  double depth_unit_m = 0.001;  ///< one count of a depth image; count 0 means no measurement
  /// Factory fx, fy, cx, cy of the depth camera in pixels, as its driver reports them; 0: unknown.
  std::array<double, 4> depth_intrinsics{};
  std::array<double, 3> gravity{0.0, 9.81,
                                0.0};  ///< m/s^2 in the colour camera's frame (its own sensor)
};

/// One colour image and one depth image, each as its own camera saw it (not registered).
struct RgbdFrame {
  std::vector<std::uint8_t> color;   ///< [height, width, 3], RGB
  std::vector<std::uint16_t> depth;  ///< [height, width], CameraInfo::depth_unit_m
};

/// Stamps of the camera's frames: by its own clock (with drift) and on arrival (with jitter).
struct CameraTimes {
  std::vector<std::uint64_t> sequence;
  std::vector<double> device_time_s, host_time_s;

  std::size_t frames() const { return sequence.size(); }
};

/// Pixels of the colour image.
struct PixelBox {
  int x = 0, y = 0, width = 0, height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
};

/// A stretch with one grasp, from `start_s` to `end_s` of the host's clock. The boxes are where a
/// user marked hand and object in the clip's first camera frame; empty: not marked.
struct Clip {
  double start_s = 0.0, end_s = 0.0;
  std::string object;
  bool dropped = false;  ///< the object fell; such clips are left out of training and evaluation
  PixelBox hand_box, object_box;
};

/// A chessboard by its inner corners.
struct BoardInfo {
  int columns = 9, rows = 6;
  double square_m = 0.025;
};

/// Everything of a recording but its images. Times are seconds of the host's clock since
/// `epoch_unix_s`.
struct Recording {
  std::string activity;  ///< "wave", "throw", ...
  double epoch_unix_s = 0.0;
  std::vector<Clip> clips;
  std::vector<GloveStream> gloves;  ///< two at most; none where only the camera was recorded
  CameraInfo camera;
  CameraTimes camera_times;
  BoardInfo board;
  Provenance provenance;
};

/// What really happened; only simulated recordings have it, and only evaluation may read it.
/// Arrays are row-major [samples, n]; positions and velocities in the colour camera's frame.
struct Truth {
  struct Body {
    std::vector<double> position_m;        ///< [samples, 3]; of the object: its centre of mass
    std::vector<double> velocity_m_per_s;  ///< [samples, 3]
    std::vector<double> orientation_wxyz;  ///< [samples, 4], unit quaternions
  };
  struct Event {
    double time_s;
    std::string kind;  ///< "release", "catch", "impact", "drop"
  };

  std::vector<double> time_s;      ///< [samples], the host's clock, uniform within a clip
  std::vector<std::int32_t> clip;  ///< [samples]
  Body hand, object;
  std::vector<double> contact_force_n;  ///< [samples, 3], of the hand on the object
  std::vector<Event> events;
  nlohmann::json calibration;  ///< true intrinsics, extrinsics and depth error
  nlohmann::json clocks;       ///< true offset, drift and latency of each stream
};

}  // namespace touchtrace
