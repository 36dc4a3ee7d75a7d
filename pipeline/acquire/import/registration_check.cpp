#include "pipeline/acquire/import/registration_check.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace touchtrace {
namespace {

constexpr std::size_t num_samples = 13, min_samples = 8;
constexpr int compared_width = 320;        // larger images are reduced to about this width
constexpr double max_shift = 0.125;        // of the width and height
constexpr double max_color_change = 60.0;  // sum over the channels; more counts as much
constexpr double min_depth_change = 0.04;  // of the depth
constexpr int min_moved_pixels = 50, hole_pixels = 5;
constexpr double min_correlation = 0.2, min_gain = 1.05, max_registered_shift = 0.015;

struct Pair {
  cv::Mat color, depth;  ///< reduced; CV_32FC3 and CV_32F
};

std::size_t nearest_image(const SourceStream& stream, double time_s) {
  const auto after = std::ranges::lower_bound(stream.images, time_s, {}, &SourceImage::host_time_s);
  if (after == stream.images.begin()) return 0;
  const auto index = static_cast<std::size_t>(after - stream.images.begin());
  if (after == stream.images.end()) return index - 1;
  return after->host_time_s - time_s < time_s - std::prev(after)->host_time_s ? index : index - 1;
}

Pair read_pair(const SourceStream& color, const SourceStream& depth, std::size_t index) {
  const cv::Mat image = color.read(index);
  const cv::Mat counts = depth.read(nearest_image(depth, color.images[index].host_time_s));
  const double scale = std::min(1.0, static_cast<double>(compared_width) / image.cols);
  Pair pair;
  image.convertTo(pair.color, CV_32F);
  counts.convertTo(pair.depth, CV_32F);
  cv::resize(pair.color, pair.color, {}, scale, scale, cv::INTER_AREA);
  cv::resize(pair.depth, pair.depth, pair.color.size(), 0.0, 0.0, cv::INTER_NEAREST);
  return pair;
}

/// Pairs spread over the streams; damaged images are left out.
std::vector<Pair> sample_pairs(const SourceStream& color, const SourceStream& depth) {
  std::vector<Pair> pairs;
  const std::size_t count = std::min(num_samples, color.images.size());
  for (std::size_t i = 0; i < count; ++i) try {
      auto pair = read_pair(color, depth, i * color.images.size() / count);
      if (pairs.empty() || pair.color.size() == pairs.front().color.size())
        pairs.push_back(std::move(pair));
    } catch (const std::exception&) {
      continue;  // named when it is imported
    }
  return pairs;
}

cv::Mat color_motion(const cv::Mat& a, const cv::Mat& b) {
  std::vector<cv::Mat> channels;
  cv::split(cv::abs(a - b), channels);
  return cv::min(channels[0] + channels[1] + channels[2], max_color_change);
}

/// 1 where the depth changes, or where it is measured in one image only: behind a body there may be
/// no measurement. Single holes, which flicker, do not count.
cv::Mat depth_motion(const cv::Mat& a, const cv::Mat& b) {
  const cv::Mat is_in_a = a > 0.0, is_in_b = b > 0.0;
  const cv::Mat changed = is_in_a & is_in_b & (cv::abs(a - b) > min_depth_change * cv::max(a, b));
  cv::Mat appeared = is_in_a != is_in_b, motion;
  cv::morphologyEx(appeared, appeared, cv::MORPH_OPEN,
                   cv::Mat::ones(hole_pixels, hole_pixels, CV_8U));
  cv::Mat(changed | appeared).convertTo(motion, CV_32F, 1.0 / 255.0);
  return motion;
}

/// Sums of the products of both images of motion at all shifts, and of their squares.
struct Correlation {
  cv::Mat products;
  double color_squares = 0.0, depth_squares = 0.0;

  void add(cv::Mat color, cv::Mat depth) {
    if (cv::countNonZero(depth) < min_moved_pixels) return;
    color -= cv::mean(color), depth -= cv::mean(depth);
    color_squares += color.dot(color), depth_squares += depth.dot(depth);
    cv::Mat spectrum;
    cv::dft(color, color), cv::dft(depth, depth);
    cv::mulSpectrums(depth, color, spectrum, 0, true);
    cv::dft(spectrum, spectrum, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
    if (products.empty()) products = cv::Mat::zeros(spectrum.size(), CV_32F);
    products += spectrum;
  }

  double at(int x, int y) const {
    const int u = (x + products.cols) % products.cols, v = (y + products.rows) % products.rows;
    return products.at<float>(v, u) / std::sqrt(color_squares * depth_squares);
  }
};

}  // namespace

bool MotionShift::is_consistent_with_registration(int width) const {
  return cv::norm(depth_from_color_px) < max_registered_shift * width ||
         correlation < min_gain * unshifted_correlation;
}

std::optional<MotionShift> measure_motion_shift(const SourceStream& color,
                                                const SourceStream& depth) {
  const auto pairs = sample_pairs(color, depth);
  if (pairs.size() < min_samples) return std::nullopt;
  Correlation correlation;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i) {
    const Pair &a = pairs[i], &b = pairs[(i + pairs.size() / 3 + 1) % pairs.size()];
    correlation.add(color_motion(a.color, b.color), depth_motion(a.depth, b.depth));
  }
  if (correlation.products.empty()) return std::nullopt;
  MotionShift best{{}, correlation.at(0, 0), correlation.at(0, 0)};
  const double reduction = static_cast<double>(color.read(0).cols) / correlation.products.cols;
  const int max_x = static_cast<int>(max_shift * correlation.products.cols),
            max_y = static_cast<int>(max_shift * correlation.products.rows);
  for (int y = -max_y; y <= max_y; ++y)
    for (int x = -max_x; x <= max_x; ++x)
      if (const double value = correlation.at(x, y); value > best.correlation)
        best.correlation = value, best.depth_from_color_px = {reduction * x, reduction * y};
  if (best.correlation < min_correlation) return std::nullopt;
  return best;
}

}  // namespace touchtrace
