#pragma once

#include <cmath>
#include <limits>

#include "pipeline/label/label.h"
#include "pipeline/recording/recording.h"
#include "tests/verify/calib/synthetic_track.h"

namespace touchtrace::staged {

inline constexpr int width = 320, height = 240;
inline constexpr double ball_radius_m = 0.035, camera_rate_hz = 20.0, glove_rate_hz = 15.0,
                        seconds = 6.0, hidden_s = 0.5;
inline const Eigen::Vector3d ball_at(0.0, 0.0, 1.1), hand_from_ball(0.0, 0.07, 0.02);

inline Camera camera() {
  Camera result;
  result.width = width, result.height = height;
  result.fx = result.fy = 300.0;
  result.cx = 159.5, result.cy = 119.5;
  return result;
}

using Color = std::array<int, 3>;
inline constexpr Color red{200, 40, 20}, blue{20, 30, 160}, skin{90, 60, 60};

/// Nearest thing on a pixel's ray; at first the wall.
struct Pixel {
  double depth_m = 2.5;
  Color color{120, 120, 110};

  void show(double other_depth_m, const Color& other) {
    if (other_depth_m < depth_m) depth_m = other_depth_m, color = other;
  }
};

/// Draws each pixel by `shade(ray, pixel)`.
template <class Shade>
RgbdFrame render_pixels(Shade&& shade) {
  RgbdFrame frame;
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      Pixel pixel;
      shade(camera().unproject({u, v}), pixel);
      frame.depth.push_back(static_cast<std::uint16_t>(std::lround(1000.0 * pixel.depth_m)));
      frame.color.insert(frame.color.end(), pixel.color.begin(), pixel.color.end());
    }
  return frame;
}

/// Depth of a ball along a ray; infinite if the ray misses it.
inline double ball_depth_m(const Eigen::Vector3d& ray, const Eigen::Vector3d& ball_m) {
  const double b = ray.dot(ball_m), q = ray.squaredNorm(),
               discriminant = b * b - q * (ball_m.squaredNorm() - ball_radius_m * ball_radius_m);
  return discriminant > 0.0 ? (b - std::sqrt(discriminant)) / q
                            : std::numeric_limits<double>::infinity();
}

inline bool is_on_disc(const Eigen::Vector3d& ray, const Eigen::Vector3d& disc_m, double radius_m) {
  return (ray * disc_m.z() - disc_m).norm() < radius_m;
}

/// Rendered scene for labelling: a red ball, a blue disc as hand, a grey torso and a wall, seen by
/// a noise-free depth camera registered to the colour camera.
class Stage {
 public:
  enum class Ball { red, hand_colored, torso_colored, hidden_at_first };

  explicit Stage(bool thrown, Ball kind = Ball::red)
      : motion_(thrown ? synthetic_throw(seconds + 1.0, 3) : synthetic_wave(seconds + 1.0, 3)),
        kind_(kind) {}

  Eigen::Vector3d ball(double time_s) const { return ball_at + motion_.position_at(time_s); }
  /// Below the ball; in flight on a straight line from its release to its landing.
  Eigen::Vector3d hand(double time_s) const {
    for (const auto& [release_s, landing_s, release_sigma_s, landing_sigma_s] : motion_.flights)
      if (time_s > release_s && time_s < landing_s) {
        const double part = (time_s - release_s) / (landing_s - release_s);
        return hand_from_ball + (1.0 - part) * ball(release_s) + part * ball(landing_s);
      }
    return hand_from_ball + ball(time_s);
  }
  const SyntheticMotion& motion() const { return motion_; }
  /// Gives the torso a lower half of the glove's colour, larger than the glove.
  void set_blue_trousers() { trousers_ = blue; }
  /// Lights the torso, which is never the object, in another colour than in the box frame.
  void set_relit_torso() { relit_torso_ = {60, 110, 60}; }

  RgbdFrame render(double time_s, bool person) const {
    const Eigen::Vector3d ball_m = ball(time_s), hand_m = hand(time_s);
    return render_pixels([&](const Eigen::Vector3d& ray, Pixel& pixel) {
      if (!person) return;
      if (std::abs(ray.x()) < 0.15)
        pixel.show(1.5, ray.y() > 0.15 ? trousers_ : torso_color(time_s));
      if (is_on_disc(ray, hand_m, 0.05)) pixel.show(hand_m.z(), blue);
      pixel.show(ball_depth_m(ray, ball_m), ball_color(time_s));
    });
  }

 private:
  Color torso_color(double time_s) const { return time_s < hidden_s ? skin : relit_torso_; }
  /// A ball that is wholly in the glove has the glove's colour.
  Color ball_color(double time_s) const {
    if (kind_ == Ball::torso_colored) return torso_color(time_s);
    const bool is_blue =
        kind_ == Ball::hand_colored || (kind_ == Ball::hidden_at_first && time_s < hidden_s);
    return is_blue ? blue : red;
  }

  SyntheticMotion motion_;
  Ball kind_;
  Color trousers_ = skin, relit_torso_ = skin;
};

inline PixelBox box_around(const Eigen::Vector3d& centre, double radius_m) {
  const Eigen::Vector2d pixel = camera().project(centre);
  const int half = static_cast<int>(std::lround(radius_m * camera().fx / centre.z()));
  return {static_cast<int>(pixel.x()) - half, static_cast<int>(pixel.y()) - half, 2 * half,
          2 * half};
}

/// Recording of one clip without a glove.
inline Recording camera_recording(const PixelBox& hand_box, const PixelBox& object_box) {
  Recording recording;
  recording.activity = "test";
  recording.camera.width = width, recording.camera.height = height;
  recording.camera.rate_hz = camera_rate_hz;
  recording.clips = {{0.0, seconds, "ball", false, hand_box, object_box}};
  for (int i = 0; i < static_cast<int>(seconds * camera_rate_hz); ++i) {
    recording.camera_times.sequence.push_back(static_cast<std::uint64_t>(i));
    recording.camera_times.device_time_s.push_back(i / camera_rate_hz);
    recording.camera_times.host_time_s.push_back(i / camera_rate_hz);
  }
  return recording;
}

inline Recording recording_of(const Stage& stage) {
  Recording recording =
      camera_recording(box_around(stage.hand(0.0), 0.055), box_around(stage.ball(0.0), 0.036));
  GloveStream glove;
  for (int i = 0; i < static_cast<int>((seconds - 0.1) * glove_rate_hz); ++i) {
    if (i == 40) continue;  // lost in transmission
    glove.sequence.push_back(static_cast<std::uint64_t>(i + 100));
    glove.host_time_s.push_back(i / glove_rate_hz);
  }
  recording.gloves = {glove};
  return recording;
}

template <class Scene>
label::FrameSource frame_source(const Scene& stage) {
  return {
      [&](std::size_t i) { return stage.render(static_cast<double>(i) / camera_rate_hz, true); },
      [&](std::size_t) { return stage.render(0.0, false); }, 3};
}

inline label::LabelOptions component_options() {
  label::LabelOptions options;
  options.tracker = "component";
  return options;
}

inline Truth truth_of(const Stage& stage) {
  Truth truth;
  for (int i = 0; i < static_cast<int>(seconds * 500.0); ++i) {
    const double t = i / 500.0;
    truth.time_s.push_back(t);
    truth.clip.push_back(0);
    const auto add = [](std::vector<double>& to, const Eigen::Vector3d& v) {
      to.insert(to.end(), v.data(), v.data() + 3);
    };
    add(truth.object.position_m, stage.ball(t));
    add(truth.object.velocity_m_per_s, stage.motion().velocity_at(t));
    add(truth.hand.position_m, stage.hand(t));
    add(truth.hand.velocity_m_per_s, (stage.hand(t + 1e-3) - stage.hand(t)) / 1e-3);
  }
  return truth;
}

inline RgbdCalibration calibration() {
  RgbdCalibration result;
  result.color = camera();
  result.depth = camera();
  return result;
}

}  // namespace touchtrace::staged
