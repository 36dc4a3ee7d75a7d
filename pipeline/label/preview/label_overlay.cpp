#include "pipeline/label/preview/label_overlay.h"

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "calib/camera/projection_jacobian.h"
#include "pipeline/recording/frame_pairs.h"

namespace touchtrace::label {
namespace {

using Eigen::Map, Eigen::Matrix2d, Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;

constexpr double trail_s = 1.0;
constexpr int caption_px = 58, row_px = 18, fraction_bits = 4;  // OpenCV draws at 1/16 px
constexpr double text_scale = 0.42;
const cv::Scalar hand_color(120, 230, 70), object_color(255, 170, 60), text_color(225, 225, 225),
    cross_color(255, 255, 255), outline_color(20, 20, 20);  // BGR

Vector3d position_of(const std::vector<double>& values, std::size_t index) {
  return Map<const Vector3d>(&values[3 * index]);
}

Matrix3d position_covariance(const LabelledBody& body, std::size_t label) {
  return Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(&body.covariance[36 * label])
      .topLeftCorner<3, 3>();
}

/// Smoothed position at a time near the label's.
Vector3d position_at(const LabelledBody& body, std::size_t label, double after_s) {
  return position_of(body.position_m, label) + after_s * position_of(body.velocity_m_per_s, label);
}

std::string body_text(const char* name, const LabelledBody& body, std::size_t label) {
  const double sigma_m = std::sqrt(position_covariance(body, label).trace() / 3.0);
  std::string text = name;
  if (sigma_m < 1.0)
    text += fmt::format(", sigma {:.0f} mm", 1000.0 * sigma_m);
  else if (std::isfinite(sigma_m))
    text += ", sigma > 1 m";
  for (const auto& [flag, words] : {std::pair{quality_lost, "lost"},
                                    {quality_follows_hand, "follows hand"},
                                    {quality_gap, "outside measured time"}})
    if (body.quality[label] & flag) text += fmt::format(", {}", words);
  return text;
}

}  // namespace

/// Enlarged or reduced camera frame, in which points of the camera frame are drawn.
class LabelOverlay::Canvas {
 public:
  Canvas(const RgbdFrame& frame, const Camera& camera, int size_px)
      : camera_(camera),
        scale_(static_cast<double>(size_px) / std::max(camera.width, camera.height)) {
    const cv::Mat rgb(camera.height, camera.width, CV_8UC3,
                      const_cast<std::uint8_t*>(frame.color.data()));
    const cv::Size size(scaled(camera.width), scaled(camera.height));
    image_.create(size.height + caption_px, size.width, CV_8UC3);
    image_.setTo(outline_color);
    picture_ = image_.rowRange(0, size.height);
    cv::Mat bgr;
    cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
    cv::resize(bgr, picture_, size, 0, 0, scale_ < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  }

  const cv::Mat& image() const { return image_; }

  void draw_box(const PixelBox& box, const cv::Scalar& color) {
    const cv::Rect2d scaled_box(scale_ * box.x, scale_ * box.y, scale_ * box.width,
                                scale_ * box.height);
    cv::rectangle(picture_, scaled_box & cv::Rect2d({}, picture_.size()), color, 1);
  }
  void draw_dot(const Vector3d& point_m, const cv::Scalar& color) {
    const auto at = pixel(point_m);
    if (!at) return;
    for (const auto& [fill, radius_px] : {std::pair{outline_color, 5}, {color, 4}})
      cv::circle(picture_, *at, radius_px << fraction_bits, fill, cv::FILLED, cv::LINE_AA,
                 fraction_bits);
  }
  /// Lines between points that are in the image.
  void draw_path(const std::vector<Vector3d>& points_m, const cv::Scalar& color) {
    for (const auto& [line_color, width] : {std::pair{outline_color, 3}, {color, 1}})
      for (std::size_t i = 1; i < points_m.size(); ++i) {
        const auto from = pixel(points_m[i - 1]), to = pixel(points_m[i]);
        if (from && to)
          cv::line(picture_, *from, *to, line_color, width, cv::LINE_AA, fraction_bits);
      }
  }
  void draw_cross(const Vector3d& point_m) {
    const auto at = pixel(point_m);
    if (!at) return;
    for (const auto& [line_color, width] : {std::pair{outline_color, 3}, {cross_color, 1}})
      for (const cv::Point& arm : {cv::Point(6 << fraction_bits, 0), {0, 6 << fraction_bits}})
        cv::line(picture_, *at - arm, *at + arm, line_color, width, cv::LINE_AA, fraction_bits);
  }
  /// Ellipse of one standard deviation.
  void draw_covariance(const Vector3d& point_m, const Matrix3d& covariance_m2,
                       const cv::Scalar& color) {
    const auto at = pixel(point_m);
    if (!at || !covariance_m2.allFinite()) return;
    const auto jacobian = projection_jacobian(camera_, point_m).by_point;
    const Eigen::SelfAdjointEigenSolver<Matrix2d> axes(jacobian * covariance_m2 *
                                                       jacobian.transpose());
    const Vector2d half_px =
        scale_ * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().cwiseMin(camera_.width);
    const Vector2d major = axes.eigenvectors().col(1);
    const cv::Size size(fixed_point(half_px.y()), fixed_point(half_px.x()));
    const double angle_deg = std::atan2(major.y(), major.x()) * 180.0 / CV_PI;
    for (const auto& [line_color, width] : {std::pair{outline_color, 3}, {color, 1}})
      cv::ellipse(picture_, *at, size, angle_deg, 0, 360, line_color, width, cv::LINE_AA,
                  fraction_bits);
  }
  /// `row`: of the caption.
  void draw_text(const std::string& text, int row, const cv::Scalar& color) {
    cv::putText(image_, text, {6, picture_.rows + 15 + row_px * row}, cv::FONT_HERSHEY_SIMPLEX,
                text_scale, color, 1, cv::LINE_AA);
  }

 private:
  int scaled(int pixels) const {
    return std::max(1, static_cast<int>(std::lround(scale_ * pixels)));
  }
  static int fixed_point(double pixels) {
    return static_cast<int>(std::lround(pixels * (1 << fraction_bits)));
  }
  /// Place in the picture; nullopt if it is not in the camera's image.
  std::optional<cv::Point> pixel(const Vector3d& point_m) const {
    const Vector2d at = camera_.project(point_m);
    if (!(at.x() > -0.5 && at.x() < camera_.width && at.y() > -0.5 && at.y() < camera_.height))
      return std::nullopt;
    const Vector2d place = scale_ * (at + Vector2d(0.5, 0.5)) - Vector2d(0.5, 0.5);
    return cv::Point(fixed_point(place.x()), fixed_point(place.y()));
  }

  const Camera& camera_;
  double scale_;
  cv::Mat image_, picture_;  ///< with and without caption
};

LabelOverlay::LabelOverlay(const Recording& recording, const RgbdCalibration& calibration,
                           const Labels& labels)
    : recording_(recording), labels_(labels), camera_(calibration.color) {
  auto timeline = align(recording);
  timeline.set_latency(labels.summary.value("latency_s", timeline.latency_s),
                       timeline.latency_sigma_s);
  color_time_s_ = timeline.camera_time_s;
  for (double& time_s : timeline.camera_time_s) time_s += calibration.depth_delay_s;
  frames_ = frame_labels(recording, timeline, labels);
}

double LabelOverlay::frame_rate_hz() const {
  return rate_of(color_time_s_, recording_.camera.rate_hz);
}

bool LabelOverlay::is_flagged(std::size_t frame) const {
  const auto label = frames_[frame].label;
  return label && (labels_.hand.quality[*label] | labels_.object.quality[*label]) != quality_good;
}

std::vector<Vector3d> LabelOverlay::trail(const LabelledBody& body, std::size_t label,
                                          double time_s) const {
  std::vector<Vector3d> points_m{position_at(body, label, time_s - labels_.time_s[label])};
  for (std::size_t i = label + 1; i-- > 0;) {
    if (labels_.clip[i] != labels_.clip[label] || labels_.time_s[i] < time_s - trail_s) break;
    if (labels_.time_s[i] < time_s) points_m.push_back(position_of(body.position_m, i));
  }
  return points_m;
}

void LabelOverlay::draw_body(const FrameLabel& frame, double time_s, const LabelledBody& body,
                             const std::vector<double>& raw_m, const cv::Scalar& color,
                             Canvas& canvas) const {
  if (frame.label) canvas.draw_path(trail(body, *frame.label, time_s), color);
  if (frame.raw) canvas.draw_dot(position_of(raw_m, *frame.raw), color);
  if (!frame.label) return;
  const Vector3d position_m =
      position_at(body, *frame.label, time_s - labels_.time_s[*frame.label]);
  canvas.draw_covariance(position_m, position_covariance(body, *frame.label), color);
  canvas.draw_cross(position_m);
}

void LabelOverlay::draw_caption(const FrameLabel& frame, double time_s, Canvas& canvas) const {
  std::string text = fmt::format("{:.2f} s", time_s);
  if (frame.clip)
    text += fmt::format("   clip {}: {}", *frame.clip, recording_.clips[*frame.clip].object);
  canvas.draw_text(text, 0, text_color);
  if (!frame.label) return;
  canvas.draw_text(body_text("hand", labels_.hand, *frame.label), 1, hand_color);
  canvas.draw_text(body_text("object", labels_.object, *frame.label), 2, object_color);
}

cv::Mat LabelOverlay::draw(std::size_t index, const RgbdFrame& images, int size_px) const {
  const FrameLabel& frame = frames_[index];
  const double time_s = color_time_s_[index];
  Canvas canvas(images, camera_, size_px);
  if (frame.has_boxes) {
    canvas.draw_box(recording_.clips[*frame.clip].hand_box, hand_color);
    canvas.draw_box(recording_.clips[*frame.clip].object_box, object_color);
  }
  draw_body(frame, time_s, labels_.hand, labels_.raw.hand_m, hand_color, canvas);
  draw_body(frame, time_s, labels_.object, labels_.raw.object_m, object_color, canvas);
  draw_caption(frame, time_s, canvas);
  return canvas.image();
}

}  // namespace touchtrace::label
