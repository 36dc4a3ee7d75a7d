#include "pipeline/acquire/import/registration_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "engine/base/parabola.h"
#include "pipeline/recording/frame_pairs.h"

namespace touchtrace {
namespace {

constexpr std::size_t num_samples = 13, min_samples = 8;
constexpr int compared_width = 320;        // larger images are reduced to about this width
constexpr double max_shift = 0.125;        // of the width and height
constexpr double max_color_change = 60.0;  // sum over the channels; more counts as much
constexpr double min_depth_change = 0.04;  // of the depth
constexpr int min_moved_pixels = 50, hole_pixels = 5;
constexpr int num_places = 16, max_lag = 6;  // lags in images
constexpr double min_peak_ratio = 1.15;      // clips of real cameras have 1.4 to 2.2
constexpr double min_correlation = 0.2, min_gain = 1.05, max_registered_shift = 0.015;

struct Pair {
  cv::Mat color, depth;  ///< reduced; CV_32FC3 and CV_32F
};

cv::Mat read_reduced(const SourceStream& stream, std::size_t index, int interpolation) {
  cv::Mat image;
  stream.read(index).convertTo(image, CV_32F);
  const double scale = std::min(1.0, static_cast<double>(compared_width) / image.cols);
  cv::resize(image, image, {}, scale, scale, interpolation);
  return image;
}

cv::Mat read_color(const SourceStream& stream, std::size_t index) {
  return read_reduced(stream, index, cv::INTER_AREA);
}

cv::Mat read_depth(const SourceStream& stream, std::size_t index) {
  return read_reduced(stream, index, cv::INTER_NEAREST);
}

Pair read_pair(const SourceStream& color, const SourceStream& depth, std::size_t index) {
  return {read_color(color, index),
          read_depth(depth, nearest_image(depth, color.images[index].host_time_s))};
}

/// Pairs spread over the streams; skips damaged images.
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

double interval_s(const SourceStream& stream) {
  return 1.0 / rate_of(host_times_s(stream), std::numeric_limits<double>::infinity());
}

/// Correlation of motion in colour and depth at the same pixels by delay of depth.
class DelaySearch {
 public:
  DelaySearch(const SourceStream& color, const SourceStream& depth)
      : color_(color), depth_(depth), step_s_(std::max(interval_s(color), interval_s(depth))) {}

  double step_s() const { return step_s_; }

  /// Adds the motion from the colour image nearest to a time to that nearest to the next step.
  void add(double time_s) {
    const std::size_t from = nearest_image(color_, time_s),
                      to = nearest_image(color_, time_s + step_s_);
    cv::Mat color = color_motion(read_color(color_, from), read_color(color_, to));
    color -= cv::mean(color);
    cv::Mat before;
    for (int lag = -max_lag; lag <= max_lag + 1; ++lag) {
      const std::size_t index = nearest_image(depth_, time_s + lag * step_s_);
      const cv::Mat image = read_depth(depth_, index);
      if (lag > -max_lag) add_lag(lag - 1, color, depth_motion(before, image));
      if (lag == 0) {
        stamp_offset_s_ += depth_.images[index].host_time_s - color_.images[from].host_time_s;
        ++num_places_;
      }
      before = image;
    }
  }

  /// Lag whose correlation exceeds those of all others but its neighbours by `min_peak_ratio`,
  /// refined by a parabola.
  std::optional<DepthDelay> delay() const {
    const auto best = std::ranges::max_element(sums_, {}, &Sum::correlation);
    const auto lag = best - sums_.begin();
    if (lag == 0 || lag + 1 == std::ssize(sums_) || !(best->correlation() > min_correlation))
      return std::nullopt;
    for (std::ptrdiff_t other = 0; other < std::ssize(sums_); ++other)
      if (std::abs(other - lag) > 1 &&
          best->correlation() <
              min_peak_ratio * sums_[static_cast<std::size_t>(other)].correlation())
        return std::nullopt;
    const double vertex = parabola_vertex(std::prev(best)->correlation(), best->correlation(),
                                          std::next(best)->correlation());
    const double seconds =
        (static_cast<double>(lag - max_lag) + vertex) * step_s_ + stamp_offset_s_ / num_places_;
    return DepthDelay{seconds, seconds / step_s_};
  }

 private:
  struct Sum {
    double products = 0.0, color_squares = 0.0, depth_squares = 0.0;

    double correlation() const {
      return products > 0.0 ? products / std::sqrt(color_squares * depth_squares) : 0.0;
    }
  };

  void add_lag(int lag, const cv::Mat& color, cv::Mat depth) {
    if (cv::countNonZero(depth) < min_moved_pixels || depth.size() != color.size()) return;
    depth -= cv::mean(depth);
    Sum& sum = sums_[static_cast<std::size_t>(lag + max_lag)];
    sum.products += color.dot(depth);
    sum.color_squares += color.dot(color), sum.depth_squares += depth.dot(depth);
  }

  const SourceStream &color_, &depth_;
  double step_s_, stamp_offset_s_ = 0.0;
  int num_places_ = 0;
  std::array<Sum, 2 * max_lag + 1> sums_;
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

std::optional<DepthDelay> measure_depth_delay(const SourceStream& color,
                                              const SourceStream& depth) {
  if (std::min(color.images.size(), depth.images.size()) < 4 * max_lag) return std::nullopt;
  DelaySearch search(color, depth);
  const double margin_s = (max_lag + 2) * search.step_s();
  const double first_s = color.images.front().host_time_s + margin_s,
               last_s = color.images.back().host_time_s - margin_s;
  for (int place = 0; place < num_places; ++place) try {
      search.add(first_s + (last_s - first_s) * place / (num_places - 1));
    } catch (const std::exception&) {
      continue;  // named when it is imported
    }
  return search.delay();
}

}  // namespace touchtrace
