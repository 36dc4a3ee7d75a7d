#include "pipeline/acquire/import/depth_values.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchtrace {
namespace {

constexpr std::size_t num_sampled = 9, max_values_per_image = 200'000;
constexpr double min_code_share = 0.1, max_other_share = 0.01, code_percentile = 0.95;

/// Whether a pixel has depth. The largest number of 16 bits marks missing depth.
bool has_depth(double value, int type) {
  return value > 0.0 && std::isfinite(value) &&
         (type != CV_16UC1 || value < std::numeric_limits<std::uint16_t>::max());
}

void append_values(const cv::Mat& image, std::vector<double>& values) {
  cv::Mat numbers;
  image.convertTo(numbers, CV_64F);
  const std::size_t step = 1 + numbers.total() / max_values_per_image;
  for (std::size_t i = 0; i < numbers.total(); i += step)
    if (const double value = numbers.ptr<double>()[i]; has_depth(value, image.type()))
      values.push_back(value);
}

}  // namespace

std::optional<std::vector<double>> sample_depth_values(const SourceStream& depth) {
  std::optional<std::vector<double>> values;
  const std::size_t step = std::max<std::size_t>(1, depth.images.size() / num_sampled);
  for (std::size_t i = step / 2; i < depth.images.size(); i += step) try {
      const cv::Mat image = depth.read(i);
      if (!values) values.emplace();
      append_values(image, *values);
    } catch (const std::exception&) {
      continue;  // named when it is imported
    }
  return values;
}

std::optional<DepthCode> find_depth_code(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  const auto all = static_cast<double>(values.size());
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(code_percentile * all);
  std::ranges::nth_element(values, at);
  const double value = *at;
  const auto share = [&](auto&& is_counted) {
    return static_cast<double>(std::ranges::count_if(values, is_counted)) / all;
  };
  const DepthCode code{value, share([&](double v) { return v == value; })};
  const double others = share([&](double v) { return v > 0.5 * value && v != value; });
  const bool is_code = code.share >= min_code_share && code.share < 1.0 && others < max_other_share;
  return is_code ? std::optional(code) : std::nullopt;
}

}  // namespace touchtrace
