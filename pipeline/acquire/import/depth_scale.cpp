#include "pipeline/acquire/import/depth_scale.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/progress.h"
#include "engine/base/statistics.h"
#include "pipeline/acquire/import/depth_values.h"
#include "pipeline/acquire/tum_folder.h"

namespace touchtrace {
namespace {

constexpr double float_unit_m = 0.00025;
constexpr double max_count = std::numeric_limits<std::uint16_t>::max();
constexpr double min_share_inside = 0.25;  // of values that counts can hold

struct Range {
  double min, max;
  bool contains(double value) const { return value >= min && value <= max; }
};

/// Median depth of images for hand and object, and of any camera.
constexpr Range usual_m{0.1, 20.0};
constexpr Range possible_m{0.02, 100.0};
constexpr double far_m = 6.0;  // few scenes of a hand have a larger median

/// Words for a scale in messages.
struct ScaleWords {
  std::string unit;    ///< "counts"
  std::string stated;  ///< "at 1000 counts per metre"
};

ScaleWords words_of(const DepthScale& scale) {
  const double per_m = 1.0 / scale.metres_per_value();
  const std::string unit = scale.counts_per_value == 1.0 ? "counts" : "values";
  if (unit == "values" && std::lround(per_m) == 1) return {unit, "in metres"};
  return {unit, fmt::format("at {:g} {} per metre", per_m, unit)};
}

/// "--depth-scale gives the counts per metre: 1000 (median 0.72 m) or 5000 (median 0.14 m)": scales
/// that make the median plausible. Floating-point depth is in centimetres or millimetres.
std::string scale_hint(double median_value, const std::string& unit) {
  std::string list;
  for (const char* scale : {"100", "1000", "5000", "10000"})
    if (usual_m.contains(median_value / std::stod(scale)) &&
        (unit == "counts" || std::stod(scale) <= 1000.0))
      list += fmt::format("{}{} (median {:.2f} m)", list.empty() ? ": " : " or ", scale,
                          median_value / std::stod(scale));
  return fmt::format("--depth-scale gives the {} per metre{}", unit, list);
}

/// Depth images of the TUM benchmark are millimetres times 5. Others in its format often are
/// millimetres.
bool may_be_millimetres(const std::vector<double>& values) {
  const auto multiples =
      std::ranges::count_if(values, [](double value) { return std::fmod(value, 5.0) == 0.0; });
  return static_cast<double>(multiples) < 0.9 * static_cast<double>(values.size());
}

/// Leaves out a value that marks missing depth, which is implausibly far for a depth, and larger
/// ones.
void skip(const DepthCode& code, DepthScale& scale, std::vector<double>& values) {
  Progress::warn(fmt::format(
      "{:.0f} % of the depth pixels with a value have the value {:g}, which would be {:.3g} m. "
      "It is taken for a code of missing depth: pixels of {:g} or more are skipped",
      100.0 * code.share, code.value, code.value * scale.metres_per_value(), code.value));
  scale.invalid_from = code.value;
  std::erase_if(values, [&](double value) { return value >= code.value; });
}

/// Share of the values that counts can hold.
double share_inside(const DepthScale& scale, const std::vector<double>& values) {
  const double end = max_count / scale.counts_per_value;
  const auto inside = std::ranges::count_if(values, [&](double value) { return value < end; });
  return static_cast<double>(inside) / static_cast<double>(values.size());
}

/// Throws data_error or warns if the values are implausible at the scale.
void check_values(const DepthScale& scale, const std::vector<double>& values,
                  const std::optional<DepthCode>& code, bool is_given) {
  const ScaleWords words = words_of(scale);
  const double median_m = median(values) * scale.metres_per_value();
  std::vector<double> others = values;
  if (code) std::erase(others, code->value);
  const std::string hint = scale_hint(median(std::move(others)), words.unit);
  if (!(is_given ? possible_m : usual_m).contains(median_m))
    throw data_error(fmt::format("{} the median depth would be {:.4g} m, which is implausible",
                                 words.stated, median_m),
                     hint);
  if (is_given) return;
  if (median_m > far_m)
    Progress::warn(fmt::format("{} the median depth is {:.3g} m{}; {}", words.stated, median_m,
                               code ? fmt::format(" ({:.0f} % of the pixels have the value {:g})",
                                                  100.0 * code->share, code->value)
                                    : "",
                               hint));
  if (std::lround(1.0 / scale.unit_m) == std::lround(tum_counts_per_m) &&
      may_be_millimetres(values))
    throw data_error(
        "the depth may be in millimetres: counts of the TUM format are multiples of "
        "5, these are not",
        hint);
}

}  // namespace

std::vector<std::uint16_t> DepthScale::counts(const cv::Mat& depth) const {
  CV_Assert(depth.channels() == 1);
  cv::Mat scaled;
  depth.convertTo(scaled, CV_64F, counts_per_value);
  std::vector<std::uint16_t> result(scaled.total());
  const double end = std::min(max_count, invalid_from * counts_per_value);
  std::transform(scaled.begin<double>(), scaled.end<double>(), result.begin(), [&](double count) {
    const bool is_valid = count > 0.0 && count < end;
    return is_valid ? static_cast<std::uint16_t>(std::lround(count)) : std::uint16_t{0};
  });
  return result;
}

DepthScale depth_scale(const ImportSource& source, int type, double values_per_m) {
  if (type == CV_32FC1)
    return {float_unit_m, 1.0 / (float_unit_m * (values_per_m > 0.0 ? values_per_m : 1.0))};
  return {1.0 / (values_per_m > 0.0 ? values_per_m : source.counts_per_m), 1.0};
}

DepthScale plausible_scale(DepthScale scale, const SourceStream& depth, bool is_given) {
  auto values = sample_depth_values(depth);
  if (!values) return scale;
  auto code = find_depth_code(*values);
  if (code && code->value * scale.metres_per_value() > usual_m.max) {
    skip(*code, scale, *values);
    code.reset();
  }
  if (values->empty())
    throw data_error("the depth images have no pixel with depth",
                     "give depth images that are not empty");
  const double share = share_inside(scale, *values), end = max_count / scale.counts_per_value;
  if (share >= min_share_inside) std::erase_if(*values, [&](double value) { return value >= end; });
  check_values(scale, *values, code, is_given);
  if (share < min_share_inside)
    Progress::warn(fmt::format(
        "{:.0f} % of the depth pixels are beyond {:.3g} m, the largest depth of this recording",
        100.0 * (1.0 - share), max_count * scale.unit_m));
  return scale;
}

}  // namespace touchtrace
