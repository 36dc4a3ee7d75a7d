#include "pipeline/label/track/box_tracker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/tracking.hpp>

#include "engine/base/named.h"

namespace touchtrace::label {
namespace {

constexpr int min_crop_px = 96, min_box_px = 8;

/// Depth masks the background and gives the scale, so a small template, few scales and no colour
/// names cost labels no measurable accuracy.
std::shared_ptr<cv::Tracker> csrt() {
  cv::TrackerCSRT::Params params;
  params.template_size = 48;
  params.number_of_scales = 3;
  params.use_color_names = false;
  params.scale_step = 1.05f;
  params.admm_iterations = 2;
  params.use_segmentation = false;
  return cv::TrackerCSRT::create(params);
}

cv::Mat crop(const MaskedImage& image, int left, int top, int size) {
  const cv::Mat whole(image.height, image.width, CV_8UC3,
                      const_cast<std::uint8_t*>(image.rgb.data()));
  cv::Mat result(size, size, CV_8UC3, cv::Scalar::all(0));
  const cv::Rect requested(left, top, size, size),
      inside = requested & cv::Rect(0, 0, image.width, image.height);
  if (!inside.empty()) whole(inside).copyTo(result(inside - requested.tl()));
  return result;
}

}  // namespace

MaskedImage masked_image(const RgbdFrame& frame, const Surface& surface, int width, int height) {
  MaskedImage image{width, height, std::vector<std::uint8_t>(frame.color.size(), 0)};
  for (const auto& point : surface)
    for (int v = std::max(0, point.v - 1); v <= std::min(height - 1, point.v + 1); ++v) {
      const int left = std::max(0, point.u - 1), right = std::min(width - 1, point.u + 1);
      const auto from = 3 * (static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(left));
      std::copy_n(&frame.color[from], 3 * (right - left + 1), &image.rgb[from]);
    }
  return image;
}

const std::vector<TrackerKind>& tracker_kinds() {
  static const std::vector<TrackerKind> kinds{{"csrt", csrt}, {"component", nullptr}};
  return kinds;
}

const TrackerKind& find_tracker(const std::string& name) {
  return find_named(tracker_kinds(), "tracker", name);
}

struct BoxTracker::State {
  std::shared_ptr<cv::Tracker> tracker;
  int crop_size = 0;
  double left = 0.0, top = 0.0;  ///< the target's centre in the crop [px]
};

BoxTracker::BoxTracker(const TrackerKind& kind) : kind_(&kind) {}
BoxTracker::~BoxTracker() = default;
BoxTracker::BoxTracker(BoxTracker&&) noexcept = default;
BoxTracker& BoxTracker::operator=(BoxTracker&&) noexcept = default;

void BoxTracker::stop() { state_.reset(); }

void BoxTracker::start(const MaskedImage& image, const PixelBox& box) {
  if (!kind_->create || box.empty()) return;
  ++starts_;
  const cv::Size size(std::max(box.width, min_box_px), std::max(box.height, min_box_px));
  state_ = std::make_unique<State>();
  state_->crop_size = std::max(min_crop_px, 3 * std::max(size.width, size.height));
  const int x = box.x + box.width / 2, y = box.y + box.height / 2, half = state_->crop_size / 2;
  state_->left = state_->top = half;
  state_->tracker = kind_->create();
  state_->tracker->init(crop(image, x - half, y - half, state_->crop_size),
                        cv::Rect({half - size.width / 2, half - size.height / 2}, size));
}

std::optional<PixelBox> BoxTracker::update(const MaskedImage& image, double predicted_x,
                                           double predicted_y) {
  if (!state_) return std::nullopt;
  const int left = static_cast<int>(std::lround(predicted_x - state_->left));
  const int top = static_cast<int>(std::lround(predicted_y - state_->top));
  cv::Rect found;
  if (!state_->tracker->update(crop(image, left, top, state_->crop_size), found))
    return std::nullopt;
  state_->left = found.x + 0.5 * found.width;
  state_->top = found.y + 0.5 * found.height;
  return PixelBox{found.x + left, found.y + top, found.width, found.height};
}

}  // namespace touchtrace::label
