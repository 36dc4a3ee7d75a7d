#include "pipeline/acquire/import/depth_scale.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/progress.h"

namespace touchtrace {
namespace {

constexpr double float_unit_m = 0.00025;
constexpr std::size_t num_sampled = 9;

struct Range {
  double min, max;
  bool contains(double value) const { return value >= min && value <= max; }
};

/// Median depth of a room. Depth in millimetres that is read with 5000 counts per metre is below.
constexpr Range usual_m{0.3, 20.0}, possible_m{0.02, 100.0};

/// Median count of up to nine images, of pixels that have one; 0: none has.
double median_count(const DepthScale& scale, const SourceStream& depth) {
  std::vector<std::uint16_t> counts;
  const std::size_t step = std::max<std::size_t>(1, depth.images.size() / num_sampled);
  for (std::size_t i = step / 2; i < depth.images.size(); i += step) try {
      const auto image = scale.counts(depth.read(i));
      std::ranges::copy_if(image, std::back_inserter(counts), [](auto count) { return count > 0; });
    } catch (const std::exception&) {
      continue;  // named when it is imported
    }
  if (counts.empty()) return 0.0;
  const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::ranges::nth_element(counts, middle);
  return *middle;
}

std::string proposed_scale(double count) {
  for (const char* scale : {"1000", "5000", "10000"})
    if (usual_m.contains(count / std::stod(scale)))
      return fmt::format("{} (median {:.2f} m)", scale, count / std::stod(scale));
  return "N";
}

}  // namespace

std::vector<std::uint16_t> DepthScale::counts(const cv::Mat& depth) const {
  CV_Assert(depth.channels() == 1);
  cv::Mat scaled;
  depth.convertTo(scaled, CV_64F, counts_per_value);
  std::vector<std::uint16_t> result(scaled.total());
  std::transform(scaled.begin<double>(), scaled.end<double>(), result.begin(), [](double count) {
    const bool is_valid = count > 0.0 && count < std::numeric_limits<std::uint16_t>::max();
    return is_valid ? static_cast<std::uint16_t>(std::lround(count)) : std::uint16_t{0};
  });
  return result;
}

DepthScale depth_scale(const ImportSource& source, int type, double values_per_m) {
  if (type == CV_32FC1)
    return {float_unit_m, 1.0 / (float_unit_m * (values_per_m > 0.0 ? values_per_m : 1.0))};
  return {1.0 / (values_per_m > 0.0 ? values_per_m : source.counts_per_m), 1.0};
}

void require_plausible(const DepthScale& scale, const SourceStream& depth, bool is_given) {
  const double count = median_count(scale, depth), median_m = count * scale.unit_m;
  if (count == 0.0) return Progress::report("warning: the depth images have no measurement");
  if ((is_given ? possible_m : usual_m).contains(median_m)) return;
  throw data_error(
      fmt::format("at {:g} counts per metre the median depth would be {:.3g} m, which is "
                  "implausible",
                  1.0 / scale.unit_m, median_m),
      fmt::format("--depth-scale gives the counts per metre: try --depth-scale {}; if the depth is "
                  "right, --depth-scale {:g}",
                  proposed_scale(count), 1.0 / scale.unit_m));
}

}  // namespace touchtrace
